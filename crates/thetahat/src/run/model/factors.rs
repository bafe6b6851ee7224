//! The rows of a recording from which the model is chosen, as triangular factors: small whatever its length.

use std::collections::{BTreeMap, VecDeque};

use super::{
    columns::ModelColumns,
    parts::{FOLDS, Parts, RowParts, STRETCHES},
};
use thetahat_estimation::identification::NearRest;
use thetahat_ground::linear_algebra::Matrix;

/// Velocity below which a joint is near rest where no rule says so, rad/s or m/s.
const NEAR_REST: f64 = 0.04;

/// What the model needs of the rows of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelFactors {
    /// Rows of each joint.
    pub rows: usize,
    /// The mean position of each joint.
    pub mean_position: Vec<f64>,
    /// The sum of each joint's squared velocities in each part of each division.
    pub squared_velocities: Vec<Vec<f64>>,
    /// The rows, by joint, by part, and by whether the joint is near rest.
    pub cells: Vec<ModelCell>,
    /// The sum of each joint's rows.
    pub sums: Vec<Vec<f64>>,
    /// Rows that a moving sum spans: with Bartlett's weights errors are correlated over so many.
    pub span: usize,
    /// The factor of the moving sums of each joint's rows and of ones: zeros lie before the first and after the last row.
    pub moving_sums: Vec<Matrix>,
}

/// Rows of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelCell {
    /// The joint, from zero.
    pub joint: usize,
    /// The parts to which they belong.
    pub parts: Parts,
    /// Whether the joint is near rest.
    pub is_near_rest: bool,
    /// How many they are.
    pub rows: usize,
    /// Their factor of `[X y]`: as many rows as they are, but no more than columns.
    pub factor: Matrix,
}

impl ModelFactors {
    /// Forgets to which parts rows belong, where whole recordings are left out in turn.
    pub(crate) fn join_parts(&mut self) {
        let mut joined: BTreeMap<(usize, bool), ModelCell> = BTreeMap::new();
        for cell in self.cells.drain(..) {
            let key = (cell.joint, cell.is_near_rest);
            let joined_cell = match joined.remove(&key) {
                None => ModelCell { parts: [None; STRETCHES.len()], ..cell },
                Some(before) => before.joined(&cell),
            };
            joined.insert(key, joined_cell);
        }
        self.cells = joined.into_values().collect();
    }
}

impl ModelCell {
    fn joined(self, other: &Self) -> Self {
        let factor = Matrix::stack(&[&self.factor, &other.factor]).triangular_factor();
        Self { rows: self.rows + other.rows, factor, ..self }
    }
}

/// Rows over which errors count as correlated, of so many: the lags of W. Newey and K. West, "Automatic lag selection in covariance
/// matrix estimation", Review of Economic Studies 61, 1994, and the row itself.
pub(crate) fn span(rows: usize) -> usize {
    let lags = (4.0 * (rows as f64 / 100.0).powf(2.0 / 9.0)) as usize + 4;
    lags.min(rows.saturating_sub(1)) + 1
}

/// The velocity below which each joint is near rest.
pub(crate) fn near_rest_limits(rule: Option<&NearRest>, joints: usize) -> Vec<f64> {
    rule.map_or_else(|| vec![NEAR_REST; joints], |rule| rule.velocity.clone())
}

/// The joint, the parts and whether the joint is near rest.
type CellKey = (usize, Parts, bool);

/// Takes the rows of a recording as they come.
pub(crate) struct ModelCollector {
    columns: ModelColumns,
    parts: RowParts,
    near_rest: Vec<f64>,
    /// Rows whose velocities were taken.
    with_velocity: usize,
    /// Whether each joint is near rest in the rows whose velocities were taken and which were not.
    at_rest: VecDeque<Vec<bool>>,
    squared_velocities: Vec<Vec<f64>>,
    rows: usize,
    cells: BTreeMap<CellKey, ModelCell>,
    sums: Vec<Vec<f64>>,
    span: usize,
    moving_sums: Vec<MovingSums>,
}

impl ModelCollector {
    /// For so many rows with these parts.
    pub(crate) fn new(columns: ModelColumns, (parts, rows): (RowParts, usize), near_rest: Vec<f64>) -> Self {
        let joints = columns.joints();
        let span = span(rows);
        Self {
            parts,
            near_rest,
            with_velocity: 0,
            at_rest: VecDeque::new(),
            squared_velocities: vec![vec![0.0; STRETCHES.len() * FOLDS]; joints],
            rows: 0,
            cells: BTreeMap::new(),
            sums: (0..joints).map(|j| vec![0.0; columns.count(j)]).collect(),
            span,
            moving_sums: (0..joints).map(|j| MovingSums::new(columns.count(j), span)).collect(),
            columns,
        }
    }

    /// Takes the velocities of the joints at the next row, before the row itself.
    pub(crate) fn take_velocities(&mut self, velocities: &[f64]) {
        for (joint, velocity) in velocities.iter().enumerate() {
            for division in 0..STRETCHES.len() {
                let part = self.parts.part(division, self.with_velocity);
                self.squared_velocities[joint][division * FOLDS + part] += velocity * velocity;
            }
        }
        self.with_velocity += 1;
        let at_rest = velocities.iter().zip(&self.near_rest).map(|(velocity, limit)| velocity.abs() < *limit);
        self.at_rest.push_back(at_rest.collect());
    }

    /// Takes the next rows, of each joint `[X y]`.
    pub(crate) fn take(&mut self, rows: &[Matrix]) {
        let count = rows.first().map_or(0, Matrix::rows);
        let parts: Vec<Parts> = (0..count).map(|k| self.parts.of_row(self.rows + k)).collect();
        let at_rest: Vec<Vec<bool>> = self.at_rest.drain(..count).collect();
        for (joint, rows) in rows.iter().enumerate() {
            let mut by_cell: BTreeMap<CellKey, Vec<bool>> = BTreeMap::new();
            for k in 0..count {
                let own = by_cell.entry((joint, parts[k], at_rest[k][joint])).or_insert_with(|| vec![false; count]);
                own[k] = true;
            }
            by_cell.into_iter().for_each(|(key, own)| self.add(key, &rows.select_rows(&own)));
            for (c, sum) in self.sums[joint].iter_mut().enumerate() {
                *sum += rows.column(c).iter().sum::<f64>();
            }
            self.moving_sums[joint].take(rows);
        }
        self.rows += count;
    }

    fn add(&mut self, key: CellKey, rows: &Matrix) {
        let (joint, parts, is_near_rest) = key;
        let empty = Matrix::zeros(0, self.columns.count(joint));
        let cell = self.cells.entry(key).or_insert(ModelCell { joint, parts, is_near_rest, rows: 0, factor: empty });
        cell.rows += rows.rows();
        cell.factor = Matrix::stack(&[&cell.factor, rows]).triangular_factor();
    }

    pub(crate) fn finish(self, mean_position: Vec<f64>) -> ModelFactors {
        ModelFactors {
            rows: self.rows,
            mean_position,
            squared_velocities: self.squared_velocities,
            cells: self.cells.into_values().collect(),
            sums: self.sums,
            span: self.span,
            moving_sums: self.moving_sums.into_iter().map(MovingSums::finish).collect(),
        }
    }
}

/// The factor of sums over a moving span of rows with a column of ones.
struct MovingSums {
    span: usize,
    columns: usize,
    /// The last rows of those that were taken, one fewer than the span; zeros before the first.
    last: Matrix,
    factor: Matrix,
}

impl MovingSums {
    /// Of rows with so many columns besides the ones.
    fn new(columns: usize, span: usize) -> Self {
        let columns = columns + 1;
        Self { span, columns, last: Matrix::zeros(span - 1, columns), factor: Matrix::zeros(0, columns) }
    }

    fn take(&mut self, rows: &Matrix) {
        let ones = Matrix::from_fn(rows.rows(), 1, |_, _| 1.0);
        self.take_with_ones(&Matrix::side_by_side(&[rows, &ones]));
    }

    fn take_with_ones(&mut self, rows: &Matrix) {
        let known = Matrix::stack(&[&self.last, rows]);
        let mut sums = Matrix::zeros(rows.rows(), self.columns);
        for c in 0..self.columns {
            let known = known.column(c);
            let mut sum: f64 = known[..self.span - 1].iter().sum();
            for (k, moving) in sums.column_mut(c).iter_mut().enumerate() {
                sum += known[k + self.span - 1];
                *moving = sum;
                sum -= known[k];
            }
        }
        self.factor = Matrix::stack(&[&self.factor, &sums]).triangular_factor();
        self.last = known.row_range(known.rows() + 1 - self.span..known.rows());
    }

    fn finish(mut self) -> Matrix {
        self.take_with_ones(&Matrix::zeros(self.span - 1, self.columns));
        self.factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_ground::linear_algebra::{dot, norm};

    /// Sums over a span of n rows have the squares of n times the autocovariances with Bartlett's weights.
    #[test]
    fn moving_sums_have_bartletts_weights() {
        const SPAN: usize = 4;
        let e: Vec<f64> = (0..30).map(|k| (1.7 * f64::from(k)).sin() + 0.3).collect();
        let mut sums = MovingSums::new(1, SPAN);
        [0..7, 7..9, 9..30].into_iter().for_each(|range| {
            let rows = e[range].to_vec();
            sums.take(&Matrix::from_columns(rows.len(), rows));
        });
        let factor = sums.finish();
        let lagged = |k: usize| (1.0 - k as f64 / SPAN as f64) * dot(&e[k..], &e[..e.len() - k]);
        let expected = lagged(0) + 2.0 * (1..SPAN).map(lagged).sum::<f64>();
        let found = norm(&factor.times(&[1.0, 0.0])).powi(2) / SPAN as f64;
        assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
    }

    #[test]
    fn a_recording_of_two_rows_spans_both() {
        assert_eq!([1, 2, 100, 12_000].map(span), [1, 2, 9, 16]);
    }
}
