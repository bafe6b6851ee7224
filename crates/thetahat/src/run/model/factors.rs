//! The rows of a recording from which the model is chosen, as triangular factors: small whatever its length.

use std::collections::{BTreeMap, VecDeque};

use super::{
    columns::ModelColumns,
    parts::{FOLDS, Parts, RowParts, STRETCHES},
};
use thetahat_estimation::identification::NearRest;
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::{dynamics::FrictionTransition, robot::JointKind};

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
    /// The rows where the sign of friction is settled, by joint and stretch of time; empty where the rows themselves are there.
    pub settled: Vec<SettledRows>,
    /// Sums over the periods of a motion that repeats; absent if it does not, or if the rows themselves are there.
    pub repeated: Option<RepeatedRows>,
}

/// Sums of the rows that have one phase, of a motion that repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct RepeatedRows {
    /// The period in rows, which need not be whole.
    pub period: f64,
    /// Pairs of rows that have one phase.
    pub pairs: f64,
    /// The factor of the sums of each joint's rows of `[X y]`.
    pub factors: Vec<Matrix>,
}

impl RepeatedRows {
    /// Phases of a period.
    pub(crate) fn phases(period: f64) -> usize {
        period.ceil() as usize
    }

    fn phase(period: f64, row: usize) -> usize {
        (row as f64).rem_euclid(period).round() as usize % Self::phases(period)
    }
}

/// Rows of one joint in one stretch of time where the sign of its friction is settled, and so it is in the rows before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct SettledRows {
    /// The joint, from zero.
    pub joint: usize,
    /// The stretch of time, from zero.
    pub stretch: usize,
    /// For how many of the transitions it is settled: for the smallest.
    pub transitions: usize,
    /// How many they are.
    pub rows: usize,
    /// Their factor of `[X y]`.
    pub factor: Matrix,
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
                Some(before) => before.joined(&cell.factor, cell.rows),
            };
            joined.insert(key, joined_cell);
        }
        self.cells = joined.into_values().collect();
    }

    /// Joins neighbouring stretches of time until there are no more than so many.
    pub(crate) fn coarsen(&mut self, most: usize) {
        while self.settled.iter().any(|rows| rows.stretch >= most.max(1)) {
            let mut joined: BTreeMap<SettledKey, SettledRows> = BTreeMap::new();
            for rows in self.settled.drain(..) {
                let key = (rows.joint, rows.stretch / 2, rows.transitions);
                let rows = SettledRows { stretch: rows.stretch / 2, ..rows };
                let rows = match joined.remove(&key) {
                    None => rows,
                    Some(before) => before.joined(&rows.factor, rows.rows),
                };
                joined.insert(key, rows);
            }
            self.settled = joined.into_values().collect();
        }
    }
}

impl SettledRows {
    fn joined(self, rows: &Matrix, count: usize) -> Self {
        let factor = Matrix::stack(&[&self.factor, rows]).triangular_factor();
        Self { rows: self.rows + count, factor, ..self }
    }
}

impl ModelCell {
    fn joined(self, rows: &Matrix, count: usize) -> Self {
        let factor = Matrix::stack(&[&self.factor, rows]).triangular_factor();
        Self { rows: self.rows + count, factor, ..self }
    }
}

/// Rows over which errors count as correlated, of so many: the lags of W. Newey and K. West, "Automatic lag selection in covariance
/// matrix estimation", Review of Economic Studies 61, 1994, and the row itself.
pub(crate) fn span(rows: usize) -> usize {
    let lags = (4.0 * (rows as f64 / 100.0).powf(2.0 / 9.0)) as usize + 4;
    lags.min(rows.saturating_sub(1)) + 1
}

/// Velocities over the transition of the friction at which its sign is settled: `tanh(4) = 0.9993`.
pub(crate) const SETTLED: f64 = 4.0;

/// The velocity below which each joint is near rest.
pub(crate) fn near_rest_limits(rule: Option<&NearRest>, joints: usize) -> Vec<f64> {
    rule.map_or_else(|| vec![NEAR_REST; joints], |rule| rule.velocity.clone())
}

/// What is slow.
#[derive(Debug, Clone)]
pub(crate) struct Slow {
    /// The velocity below which each joint is near rest.
    pub(crate) near_rest: Vec<f64>,
    /// Velocities at which friction changes its sign.
    pub(crate) transitions: Vec<FrictionTransition>,
    /// Whether each joint turns or slides.
    pub(crate) kinds: Vec<JointKind>,
}

/// The motion of a joint at a row.
#[derive(Debug, Clone, Copy)]
struct Motion {
    is_near_rest: bool,
    /// For how many transitions the sign of friction is settled.
    settled: usize,
}

impl Slow {
    fn motion(&self, joint: usize, velocity: f64) -> Motion {
        let (speed, limit) = (velocity.abs(), self.near_rest[joint]);
        let kind = self.kinds[joint];
        let is_settled = |transition: &&FrictionTransition| speed >= limit.max(SETTLED * transition.of(kind));
        Motion { is_near_rest: speed < limit, settled: self.transitions.iter().filter(is_settled).count() }
    }
}

/// The joint, the parts and whether the joint is near rest.
type CellKey = (usize, Parts, bool);
/// The joint, the stretch of time, and for how many transitions the sign of friction is settled.
type SettledKey = (usize, usize, usize);

/// Takes the rows of a recording as they come.
pub(crate) struct ModelCollector {
    columns: ModelColumns,
    parts: RowParts,
    slow: Slow,
    /// The motion of each joint, of the last row that was finished, where there is one, and of those that were not.
    motions: VecDeque<Vec<Motion>>,
    with_motion: usize,
    squared_velocities: Vec<Vec<f64>>,
    /// The rows of each joint that wait for the motion after them.
    waiting: Vec<Matrix>,
    finished: usize,
    cells: BTreeMap<CellKey, ModelCell>,
    sums: Vec<Vec<f64>>,
    span: usize,
    moving_sums: Vec<MovingSums>,
    /// Rows of a stretch of time; absent if the rows themselves are kept.
    stretch: Option<usize>,
    settled: BTreeMap<SettledKey, SettledRows>,
    repeated: Option<Phases>,
}

/// What is kept of rows that are not kept themselves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InPlaceOfRows {
    /// Rows of a stretch of time.
    pub(crate) stretch: usize,
    /// Rows of a period, of a motion that repeats.
    pub(crate) period: Option<f64>,
}

/// The sums of the rows of each phase.
struct Phases {
    period: f64,
    counts: Vec<f64>,
    sums: Vec<Matrix>,
}

impl Phases {
    fn new(period: f64, columns: &ModelColumns) -> Self {
        let phases = RepeatedRows::phases(period);
        let sums = (0..columns.joints()).map(|joint| Matrix::zeros(phases, columns.count(joint))).collect();
        Self { period, counts: vec![0.0; phases], sums }
    }

    fn count(&mut self, rows: std::ops::Range<usize>) {
        rows.for_each(|row| self.counts[RepeatedRows::phase(self.period, row)] += 1.0);
    }

    fn take(&mut self, joint: usize, first: usize, rows: &Matrix) {
        for c in 0..rows.columns() {
            let sums = self.sums[joint].column_mut(c);
            for (k, value) in rows.column(c).iter().enumerate() {
                sums[RepeatedRows::phase(self.period, first + k)] += value;
            }
        }
    }

    fn finish(self) -> RepeatedRows {
        let pairs = self.counts.iter().map(|n| n * (n - 1.0)).sum();
        let factors = self.sums.iter().map(Matrix::triangular_factor).collect();
        RepeatedRows { period: self.period, pairs, factors }
    }
}

impl ModelCollector {
    /// For so many rows with these parts.
    pub(crate) fn new(
        columns: ModelColumns,
        (parts, rows): (RowParts, usize),
        slow: Slow,
        in_place: Option<InPlaceOfRows>,
    ) -> Self {
        let joints = columns.joints();
        let span = span(rows);
        Self {
            parts,
            slow,
            motions: VecDeque::new(),
            with_motion: 0,
            squared_velocities: vec![vec![0.0; STRETCHES.len() * FOLDS]; joints],
            waiting: (0..joints).map(|j| Matrix::zeros(0, columns.count(j))).collect(),
            finished: 0,
            cells: BTreeMap::new(),
            sums: (0..joints).map(|j| vec![0.0; columns.count(j)]).collect(),
            span,
            moving_sums: (0..joints).map(|j| MovingSums::new(columns.count(j), span)).collect(),
            stretch: in_place.map(|kept| kept.stretch),
            settled: BTreeMap::new(),
            repeated: in_place.and_then(|kept| kept.period).map(|period| Phases::new(period, &columns)),
            columns,
        }
    }

    /// Takes the velocities of the joints at the next row, before the row itself.
    pub(crate) fn take_velocities(&mut self, velocities: &[f64]) {
        for (joint, velocity) in velocities.iter().enumerate() {
            for division in 0..STRETCHES.len() {
                let part = self.parts.part(division, self.with_motion);
                self.squared_velocities[joint][division * FOLDS + part] += velocity * velocity;
            }
        }
        self.with_motion += 1;
        self.motions.push_back(velocities.iter().enumerate().map(|(j, v)| self.slow.motion(j, *v)).collect());
    }

    /// Takes the next rows, of each joint `[X y]`.
    pub(crate) fn take(&mut self, rows: &[Matrix]) {
        for (waiting, rows) in self.waiting.iter_mut().zip(rows) {
            *waiting = Matrix::stack(&[waiting, rows]);
        }
        // Of the last row, the motion after it may still come.
        let known = (self.with_motion - self.finished).saturating_sub(1);
        self.finish_rows(known.min(self.waiting.first().map_or(0, Matrix::rows)));
    }

    fn finish_rows(&mut self, count: usize) {
        let before = usize::from(self.finished > 0);
        let motions: Vec<Vec<Motion>> = self.motions.iter().take(before + count + 1).cloned().collect();
        let parts: Vec<Parts> = (0..count).map(|k| self.parts.of_row(self.finished + k)).collect();
        for joint in 0..self.columns.joints() {
            let waiting = &self.waiting[joint];
            let (rows, rest) = (waiting.row_range(0..count), waiting.row_range(count..waiting.rows()));
            self.waiting[joint] = rest;
            let of_cell = |k: usize| (joint, parts[k], motions[before + k][joint].is_near_rest);
            let cells = grouped(count, of_cell);
            let is_used = used(&rows);
            for (key, own) in cells {
                let own: Vec<bool> = own.into_iter().zip(&is_used).map(|(own, used)| own && *used).collect();
                self.add_to_cell(key, &rows.select_rows(&own));
            }
            if let Some(stretch) = self.stretch {
                let settled = |k: usize| {
                    let at = before + k;
                    let around = at.saturating_sub(1)..(at + 2).min(motions.len());
                    motions[around].iter().map(|m| m[joint].settled).min().unwrap_or(0)
                };
                let of_stretch = |k: usize| (joint, (self.finished + k) / stretch, settled(k));
                let stretches = grouped(count, of_stretch);
                stretches.into_iter().for_each(|(key, own)| self.add_to_stretch(key, &rows.select_rows(&own)));
            }
            for (c, sum) in self.sums[joint].iter_mut().enumerate() {
                *sum += rows.column(c).iter().sum::<f64>();
            }
            self.moving_sums[joint].take(&rows);
            self.repeated.iter_mut().for_each(|phases| phases.take(joint, self.finished, &rows));
        }
        self.repeated.iter_mut().for_each(|phases| phases.count(self.finished..self.finished + count));
        self.motions.drain(..(before + count).saturating_sub(1));
        self.finished += count;
    }

    fn add_to_cell(&mut self, key: CellKey, rows: &Matrix) {
        let (joint, parts, is_near_rest) = key;
        let factor = Matrix::zeros(0, self.columns.count(joint));
        let cell = self.cells.remove(&key).unwrap_or(ModelCell { joint, parts, is_near_rest, rows: 0, factor });
        self.cells.insert(key, cell.joined(rows, rows.rows()));
    }

    fn add_to_stretch(&mut self, key: SettledKey, rows: &Matrix) {
        let (joint, stretch, transitions) = key;
        if transitions == 0 {
            return;
        }
        let factor = Matrix::zeros(0, self.columns.count(joint));
        let empty = SettledRows { joint, stretch, transitions, rows: 0, factor };
        let found = self.settled.remove(&key).unwrap_or(empty);
        self.settled.insert(key, found.joined(rows, rows.rows()));
    }

    pub(crate) fn finish(mut self, mean_position: Vec<f64>) -> ModelFactors {
        self.finish_rows(self.waiting.first().map_or(0, Matrix::rows));
        ModelFactors {
            rows: self.finished,
            mean_position,
            squared_velocities: self.squared_velocities,
            cells: self.cells.into_values().collect(),
            sums: self.sums,
            span: self.span,
            moving_sums: self.moving_sums.into_iter().map(MovingSums::finish).collect(),
            settled: self.settled.into_values().collect(),
            repeated: self.repeated.map(Phases::finish),
        }
    }
}

/// Whether each row has an entry other than zero: one that is left out has none.
fn used(rows: &Matrix) -> Vec<bool> {
    let mut used = vec![false; rows.rows()];
    for c in 0..rows.columns() {
        used.iter_mut().zip(rows.column(c)).for_each(|(used, value)| *used |= *value != 0.0);
    }
    used
}

/// Which of so many rows have each key.
fn grouped<K: Ord>(count: usize, key: impl Fn(usize) -> K) -> BTreeMap<K, Vec<bool>> {
    let mut groups: BTreeMap<K, Vec<bool>> = BTreeMap::new();
    for k in 0..count {
        groups.entry(key(k)).or_insert_with(|| vec![false; count])[k] = true;
    }
    groups
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
    /// Of rows with so many columns in addition to the ones.
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
