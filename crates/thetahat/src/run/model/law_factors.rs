//! The rows of one law of friction as triangular factors.

use std::collections::BTreeMap;

use super::{
    between::Between,
    columns::ModelColumns,
    factors::{ModelFactors, RepeatedRows},
    folds::ModelFolds,
    parts::FOLDS,
};
use thetahat_estimation::regression::{BlockKey, Regression, RowLayout};
use thetahat_ground::linear_algebra::{Matrix, dot, norm};

/// What all laws are fitted in: the recordings, each with the root of its weight.
#[derive(Debug, Clone)]
pub(crate) struct ModelData {
    pub(crate) columns: ModelColumns,
    pub(crate) recordings: Vec<(f64, ModelFactors)>,
}

impl ModelData {
    pub(super) fn folds(&self) -> ModelFolds {
        ModelFolds::new(&self.recordings.iter().map(|(_, factors)| factors).collect::<Vec<_>>())
    }

    /// The rows of each transition.
    pub(super) fn laws(&self) -> Vec<LawFactors> {
        let transitions = self.columns.transitions();
        let only = |own: usize| -> Vec<f64> { (0..transitions).map(|t| if t == own { 1.0 } else { 0.0 }).collect() };
        let joints = self.columns.joints();
        (0..transitions).map(|transition| self.law(&vec![only(transition); joints])).collect()
    }

    /// The rows of the sum of all transitions with these weights for each joint.
    pub(super) fn law(&self, weights: &[Vec<f64>]) -> LawFactors {
        LawFactors::new(self, weights, self.folds())
    }
}

impl ModelData {
    /// The rows where the sign of friction is settled for all transitions up to the one in between, stretch by stretch, with the errors of
    /// each joint divided by its deviation.
    pub(super) fn settled(&self, between: &Between, deviations: &[f64]) -> Regression {
        let shares = between.weights();
        let smaller = between.smaller();
        let (joints, parameters) = (self.columns.joints(), self.columns.parameters());
        let mut parts: Vec<Matrix> = Vec::new();
        let (mut layout, mut weights) = (RowLayout::empty(joints, self.recordings.len()), Vec::new());
        let (mut represented, mut first) = (vec![0.0; joints], 0);
        for (recording, (weight, factors)) in self.recordings.iter().enumerate() {
            let of_law = factors.settled.iter().filter(|rows| rows.transitions > smaller[rows.joint]);
            let stretches = of_law.clone().map(|rows| rows.stretch + 1).max().unwrap_or(0);
            for (stretch, joint) in (0..stretches).flat_map(|s| (0..joints).map(move |j| (s, j))) {
                let own = of_law.clone().filter(|rows| rows.stretch == stretch && rows.joint == joint);
                for rows in own {
                    let factor = self.columns.of_law(joint, &shares[joint], &rows.factor);
                    layout.push(BlockKey { joint, recording, stretch: first + stretch }, factor.rows());
                    weights.extend(vec![weight / deviations[joint]; factor.rows()]);
                    represented[joint] += rows.rows as f64;
                    parts.push(self.columns.spread(joint, &factor));
                }
            }
            first += stretches;
        }
        let all = Matrix::stack(&parts.iter().chain([&Matrix::zeros(0, parameters + 1)]).collect::<Vec<_>>());
        let x = all.select_columns(&(0..parameters).collect::<Vec<_>>());
        Regression::of_factors(x, all.column(parameters).to_vec(), layout, represented).with_weights(Some(weights))
    }
}

/// The rows of a law.
pub(super) struct LawFactors {
    pub(super) blocks: Vec<LawBlock>,
    correlated: Vec<Correlated>,
    joints: usize,
    pub(super) parameters: usize,
}

/// Rows of one joint in one part.
pub(super) struct LawBlock {
    pub(super) joint: usize,
    /// The part that is left out in turn; [`FOLDS`] for rows that belong to none.
    pub(super) part: usize,
    pub(super) is_near_rest: bool,
    /// The root of the weight of their recording.
    pub(super) weight: f64,
    /// How many they are.
    pub(super) rows: usize,
    /// Their factor of `[X y]`, with all base columns.
    pub(super) factor: Matrix,
}

/// The joint, the part, whether the joint is near rest, and the bits of the weight.
type BlockPlace = (usize, usize, bool, u64);

/// What says how errors of one joint in one recording are correlated in time.
struct Correlated {
    joint: usize,
    rows: usize,
    span: usize,
    sums: Vec<f64>,
    moving_sums: Matrix,
    repeated: Option<Repeated>,
}

/// What says whether errors come back with a motion that repeats.
struct Repeated {
    period: f64,
    pairs: f64,
    /// The factor of the sums of the rows of each phase.
    sums: Matrix,
    /// The factor of all rows.
    all: Matrix,
}

/// Deviations by chance of the part of the errors that comes back, from which they count as repeated.
const SHOWN: f64 = 4.5;

/// All rows, next to each other.
pub(super) struct Stacked {
    pub(super) x: Matrix,
    pub(super) y: Vec<f64>,
    pub(super) joint_of_row: Vec<usize>,
    /// How many rows of each joint these stand for.
    pub(super) rows: Vec<f64>,
}

impl LawFactors {
    fn new(data: &ModelData, weights: &[Vec<f64>], folds: ModelFolds) -> Self {
        let joints = data.columns.joints();
        let mut joined: BTreeMap<BlockPlace, (usize, Vec<Matrix>)> = BTreeMap::new();
        let mut correlated = Vec::new();
        for (k, (weight, factors)) in data.recordings.iter().enumerate() {
            for cell in &factors.cells {
                let part = folds.part_of(k, &cell.parts).unwrap_or(FOLDS);
                let key = (cell.joint, part, cell.is_near_rest, weight.to_bits());
                let (rows, all) = joined.entry(key).or_default();
                *rows += cell.rows;
                all.push(data.columns.of_law(cell.joint, &weights[cell.joint], &cell.factor));
            }
            let of_law = |joint: usize, all: &Matrix| data.columns.of_law(joint, &weights[joint], all);
            correlated.extend((0..joints).map(|joint| Correlated::new(factors, joint, of_law)));
        }
        let block = |((joint, part, is_near_rest, weight), (rows, all)): (BlockPlace, (usize, Vec<Matrix>))| {
            let factor = Matrix::stack(&all.iter().collect::<Vec<_>>()).triangular_factor();
            let factor = data.columns.spread(joint, &factor);
            LawBlock { joint, part, is_near_rest, weight: f64::from_bits(weight), rows, factor }
        };
        let blocks = joined.into_iter().map(block).collect();
        Self { blocks, correlated, joints, parameters: data.columns.parameters() }
    }

    pub(super) fn joints(&self) -> usize {
        self.joints
    }

    /// The root mean square of each joint's errors, or of its torques for parameters that are all zero.
    pub(super) fn rms(&self, theta: &[f64]) -> Vec<f64> {
        let of_joint = |joint: usize| {
            let own = self.blocks.iter().filter(|block| block.joint == joint);
            let rows: usize = own.clone().map(|block| block.rows).sum();
            let squares: f64 = own.map(|block| block.square(theta)).sum();
            (squares / rows.max(1) as f64).sqrt()
        };
        (0..self.joints).map(of_joint).collect()
    }

    /// The deviation of the mean of each joint's errors times the root of their number: widened by their autocorrelation with
    /// Bartlett's weights (Newey and West, 1987), which does not cross from one recording to the next, and by errors that come back
    /// with a motion that repeats, where the recordings say of it.
    pub(super) fn long_run_deviations(&self, columns: &ModelColumns, theta: &[f64]) -> Vec<f64> {
        let combinations: Vec<Vec<f64>> = (0..self.joints)
            .map(|joint| columns.acting(joint).iter().map(|&c| -theta[c]).chain([1.0]).collect())
            .collect();
        let repeated = self.repeated_widening(&combinations);
        let deviation = |(joint, rms): (usize, f64)| {
            self.long_run_deviation(joint, rms, &combinations[joint]) * repeated[joint].sqrt()
        };
        self.rms(theta).into_iter().enumerate().map(deviation).collect()
    }

    fn long_run_deviation(&self, joint: usize, rms: f64, combination: &[f64]) -> f64 {
        let own = self.correlated.iter().filter(|c| c.joint == joint);
        let rows: f64 = own.clone().map(|c| c.rows as f64).sum();
        let mean = own.clone().map(|c| dot(&c.sums, combination)).sum::<f64>() / rows.max(1.0);
        let variance = rows * (rms * rms - mean * mean);
        if variance <= 0.0 {
            return rms;
        }
        let centred: Vec<f64> = combination.iter().copied().chain([-mean]).collect();
        let long_run = |c: &Correlated| norm(&c.moving_sums.times(&centred)).powi(2) / c.span as f64;
        rms * (own.map(long_run).sum::<f64>() / variance).max(1.0).sqrt()
    }

    /// How many times the variance of an error that is uncorrelated in time is exceeded along a motion that repeats, of each joint:
    /// `1 + (n / P - 1) r` with n rows, a period of P, and the correlation r of errors in different periods.
    fn repeated_widening(&self, combinations: &[Vec<f64>]) -> Vec<f64> {
        let mut widening = vec![1.0_f64; self.joints];
        // Those of one recording follow one another.
        for recording in self.correlated.chunks(self.joints) {
            let parts: Option<Vec<(f64, f64)>> =
                recording.iter().map(|c| c.repeated.as_ref()?.part(c.rows, &combinations[c.joint])).collect();
            let Some(parts) = parts else { continue };
            let mean = parts.iter().map(|(part, _)| part).sum::<f64>() / parts.len() as f64;
            let by_chance = parts.iter().map(|(_, pairs)| (2.0 / pairs).sqrt()).fold(0.0, f64::max);
            if mean < SHOWN * by_chance / (parts.len() as f64).sqrt() {
                continue;
            }
            for (c, (part, _)) in recording.iter().zip(parts) {
                let periods = c.repeated.as_ref().map_or(1.0, |repeated| c.rows as f64 / repeated.period);
                widening[c.joint] = widening[c.joint].max(1.0 + (periods - 1.0) * part.clamp(0.0, 1.0));
            }
        }
        widening
    }

    pub(super) fn stacked(&self) -> Stacked {
        let parts: Vec<&Matrix> = self.blocks.iter().map(|block| &block.factor).collect();
        let all = Matrix::stack(&parts);
        let mut rows = vec![0.0; self.joints];
        self.blocks.iter().for_each(|block| rows[block.joint] += block.rows as f64);
        Stacked {
            x: all.select_columns(&(0..self.parameters).collect::<Vec<_>>()),
            y: all.column(self.parameters).to_vec(),
            joint_of_row: self.blocks.iter().flat_map(|b| std::iter::repeat_n(b.joint, b.factor.rows())).collect(),
            rows,
        }
    }
}

impl LawBlock {
    /// The sum of the squares of its errors.
    pub(super) fn square(&self, theta: &[f64]) -> f64 {
        let combination: Vec<f64> = theta.iter().map(|t| -t).chain([1.0]).collect();
        norm(&self.factor.times(&combination)).powi(2)
    }

    /// The sum of the squares of its torques.
    pub(super) fn torque_square(&self) -> f64 {
        norm(self.factor.column(self.factor.columns() - 1)).powi(2)
    }
}

impl Repeated {
    /// The correlation of errors that have one phase in different periods, of so many rows, and the pairs from which it is known; none
    /// without errors or pairs.
    fn part(&self, rows: usize, combination: &[f64]) -> Option<(f64, f64)> {
        let [of_sums, of_all] = [&self.sums, &self.all].map(|factor| norm(&factor.times(combination)).powi(2));
        let part = (of_sums - of_all) / self.pairs / (of_all / rows as f64);
        (self.pairs > 0.0 && part.is_finite()).then_some((part, self.pairs))
    }
}

impl Correlated {
    fn new(factors: &ModelFactors, joint: usize, of_law: impl Fn(usize, &Matrix) -> Matrix) -> Self {
        let repeated = |found: &RepeatedRows| {
            let own = factors.cells.iter().filter(|cell| cell.joint == joint).map(|cell| &cell.factor);
            let all = of_law(joint, &Matrix::stack(&own.collect::<Vec<_>>())).triangular_factor();
            Repeated { period: found.period, pairs: found.pairs, sums: of_law(joint, &found.factors[joint]), all }
        };
        let sums = Matrix::from_columns(1, factors.sums[joint].clone());
        Self {
            joint,
            rows: factors.rows,
            span: factors.span,
            sums: of_law(joint, &sums).into_values(),
            moving_sums: of_law(joint, &factors.moving_sums[joint]),
            repeated: factors.repeated.as_ref().map(repeated),
        }
    }
}
