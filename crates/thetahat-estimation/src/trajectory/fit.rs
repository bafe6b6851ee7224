//! Time laws and end points by least squares: variable projection with Levenberg-Marquardt steps.
//!
//! For given time laws the positions are linear in the points P_0 .. P_K, and those are eliminated (Golub and Pereyra, 1973, in
//! Kaufman's approximation). Four unknowns remain for each move, its start and the logarithms of T1, T2, T3. One move and many
//! moves are the same problem.
//!
//! | letter | word | shape |
//! | --- | --- | --- |
//! | `h_k` | `s_k - s_(k+1)`, with `s_0 = 1` and `s_(K+1) = 0`: the part of point P_k, from the start of move k to the end of move k + 1 | samples |
//! | `basis` | columns h_0 (where P_0 is free), h_1 .. h_K over time | samples x (1 + K) |
//! | `points` | P_0 (where it is free), P_1 .. P_K | (1 + K) x joints |
//! | `residual` | position less `basis * points` | samples x joints |
//! | `D_kj` | displacement of joint j in move k, `P_kj - P_(k-1)j` | 1 |
//!
//! A column differs from zero during one or two moves. So the normal equations are banded, and time and memory grow with the samples, not
//! with samples times moves. They lose no accuracy that counts: the parts of the points are well conditioned, and a step is corrected by the
//! next one, whose residual is exact.

use std::ops::Range;

use super::{
    TimeLaw,
    envelope::Envelope,
    linear_step::{Block, LinearStep, UNKNOWNS, Unknown, normal_equations},
    local_column::LocalColumn,
};
use thetahat_ground::{linear_algebra::Matrix, series::Series};

const MOST_STEPS: usize = 60;
/// The fit ends when a step reduces the cost by less than this fraction.
const LEAST_GAIN: f64 = 1e-7;
const FIRST_DAMPING: f64 = 1e-6;
const LEAST_DAMPING: f64 = 1e-9;
const LARGEST_DAMPING: f64 = 1e6;
/// Largest change of the logarithm of a time in one step.
const LARGEST_CHANGE: f64 = 0.5;

/// The samples to fit.
pub(super) struct Samples {
    time: Vec<f64>,
    position: Matrix,
    known_start: Option<Vec<f64>>,
}

impl Samples {
    /// Every `stride`-th sample in `range`.
    pub fn new(position: &Series, range: Range<usize>, stride: usize, rate: f64) -> Self {
        let kept: Vec<usize> = range.step_by(stride).collect();
        Self {
            time: kept.iter().map(|&k| k as f64 / rate).collect(),
            position: Matrix::from_fn(kept.len(), position.channels(), |i, j| position.sample(kept[i])[j]),
            known_start: None,
        }
    }

    /// The samples with a known start point P_0, which is not fitted; the positions count from there.
    pub fn with_known_start(mut self, start: Vec<f64>) -> Self {
        for (j, p) in start.iter().enumerate() {
            self.position.column_mut(j).iter_mut().for_each(|q| *q -= p);
        }
        self.known_start = Some(start);
        self
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// The samples after `from_s` and before `to_s`.
    fn between(&self, from_s: f64, to_s: f64) -> Range<usize> {
        let from = self.time.partition_point(|t| *t <= from_s);
        from..self.time.partition_point(|t| *t < to_s).max(from)
    }

    /// No time of a law may fall below two samples: the data do not distinguish shorter ones.
    fn shortest(&self) -> f64 {
        2.0 * (self.time[1] - self.time[0])
    }
}

/// Time laws with their best end points.
pub(super) struct Fit {
    /// One law for each move.
    pub laws: Vec<TimeLaw>,
    /// The start point P_0, known or fitted.
    pub start: Vec<f64>,
    basis: Vec<LocalColumn>,
    points: Matrix,
    residual: Matrix,
    cost: f64,
}

/// Improves `laws` until a step reduces the cost only negligibly.
pub(super) fn fit(samples: &Samples, weights: &[f64], laws: Vec<TimeLaw>) -> Fit {
    let mut best = Fit::new(samples, weights, laws);
    let mut damping = FIRST_DAMPING;
    for _ in 0..MOST_STEPS {
        let problem = best.linearise(samples, weights);
        let Some(next) = improve(samples, weights, &best, &problem, &mut damping) else { break };
        let gain = best.cost - next.cost;
        let done = gain < LEAST_GAIN * best.cost;
        best = next;
        if done {
            break;
        }
    }
    best.laws.iter_mut().for_each(|law| *law = law.ordered());
    best
}

/// The first step, by rising damping, that lowers the cost.
fn improve(samples: &Samples, weights: &[f64], from: &Fit, problem: &LinearStep, damping: &mut f64) -> Option<Fit> {
    while *damping < LARGEST_DAMPING {
        let laws = moved(&from.laws, &problem.solve(*damping), samples.shortest());
        let next = Fit::new(samples, weights, laws);
        if next.cost < from.cost {
            *damping = (*damping / 10.0).max(LEAST_DAMPING);
            return Some(next);
        }
        *damping *= 10.0;
    }
    None
}

fn moved(laws: &[TimeLaw], step: &[f64], shortest: f64) -> Vec<TimeLaw> {
    let width = |t: f64, change: f64| (t * change.clamp(-LARGEST_CHANGE, LARGEST_CHANGE).exp()).max(shortest);
    let law = |(law, d): (&TimeLaw, &[f64])| TimeLaw {
        start_s: law.start_s + d[0],
        t1_s: width(law.t1_s, d[1]),
        t2_s: width(law.t2_s, d[2]),
        t3_s: width(law.t3_s, d[3]),
    };
    laws.iter().zip(step.chunks_exact(UNKNOWNS)).map(law).collect()
}

impl Fit {
    fn new(samples: &Samples, weights: &[f64], laws: Vec<TimeLaw>) -> Self {
        let basis = basis(samples, &laws);
        let points = best_points(&basis, &samples.position);
        let residual = residual(samples, &basis, &points);
        let first_row = || (0..points.columns()).map(|j| points.at(0, j)).collect();
        let start = samples.known_start.clone().unwrap_or_else(first_row);
        let cost = weights.iter().enumerate().map(|(j, w)| w * w * sum_of_squares(residual.column(j))).sum();
        Self { laws, start, basis, points, residual, cost }
    }

    /// The end points P_1 .. P_K.
    pub fn end_points(&self) -> Vec<Vec<f64>> {
        let origin = |j: usize| if self.starts_free() { 0.0 } else { self.start[j] };
        let point = |k: usize| (0..self.start.len()).map(|j| origin(j) + self.point(k, j)).collect();
        (1..=self.laws.len()).map(point).collect()
    }

    /// Whether P_0 is fitted.
    fn starts_free(&self) -> bool {
        self.basis.len() > self.laws.len()
    }

    /// P_kj, as the positions count: from the start point where it is known.
    fn point(&self, k: usize, j: usize) -> f64 {
        match k {
            0 if !self.starts_free() => 0.0,
            _ => self.points.at(k - usize::from(!self.starts_free()), j),
        }
    }

    /// The least squares of a step in the laws and points together: in the points alone there is nothing to gain.
    fn linearise(&self, samples: &Samples, weights: &[f64]) -> LinearStep {
        let sensitivities: Vec<[LocalColumn; UNKNOWNS]> =
            self.laws.iter().map(|law| sensitivity(samples, law)).collect();
        let mut points = self.basis.iter().map(|column| Block::of_point(column, weights));
        let mut blocks: Vec<Block> = if self.starts_free() { points.by_ref().take(1).collect() } else { Vec::new() };
        for ((k, columns), point) in sensitivities.iter().enumerate().zip(points) {
            blocks.push(self.block_of_law(k, columns, weights));
            blocks.push(point);
        }
        normal_equations(&blocks)
    }

    /// The unknowns of law `k`, from zero: the derivative of joint j is the displacement D_kj times that of `s_k`.
    fn block_of_law<'a>(&self, k: usize, columns: &'a [LocalColumn; UNKNOWNS], weights: &[f64]) -> Block<'a> {
        let displacement = |j: usize| self.point(k + 1, j) - self.point(k, j);
        let factors: Vec<f64> = weights.iter().enumerate().map(|(j, w)| w * displacement(j)).collect();
        let gradient = |column: &LocalColumn| {
            let joints = factors.iter().zip(weights).enumerate();
            joints.map(|(j, (factor, w))| factor * w * column.times(self.residual.column(j))).sum()
        };
        let unknown = |p: usize| Unknown { column: p, factors: factors.clone(), gradient: gradient(&columns[p]) };
        Block { columns, unknowns: (0..UNKNOWNS).map(unknown).collect(), is_law: true }
    }
}

/// The parts h_k of the points in the positions.
fn basis(samples: &Samples, laws: &[TimeLaw]) -> Vec<LocalColumn> {
    let part = |k: usize| {
        let (before, after) = (k.checked_sub(1).map(|k| &laws[k]), laws.get(k));
        let from_s = before.map_or(f64::NEG_INFINITY, |law| after.map_or(law.start_s, |a| law.start_s.min(a.start_s)));
        let to_s = after.map_or(f64::INFINITY, |law| before.map_or(law.end_s(), |b| law.end_s().max(b.end_s())));
        let rise = |t: f64| before.map_or(1.0, |law| progress(law, t));
        let fall = |t: f64| after.map_or(0.0, |law| progress(law, t));
        LocalColumn::new(samples.between(from_s, to_s), |i| rise(samples.time[i]) - fall(samples.time[i]))
    };
    (usize::from(samples.known_start.is_some())..=laws.len()).map(part).collect()
}

/// `s` of a law at time `t`.
fn progress(law: &TimeLaw, t: f64) -> f64 {
    if t <= law.start_s { 0.0 } else { law.evaluate(t).0 }
}

/// The points with the least squares of the residual.
fn best_points(basis: &[LocalColumn], position: &Matrix) -> Matrix {
    let mut normal = Envelope::zeros(basis.len());
    let mut latest_end = 0;
    let ends: Vec<usize> = basis
        .iter()
        .map(|column| {
            latest_end = column.stretch().end.max(latest_end);
            latest_end
        })
        .collect();
    for (i, column) in basis.iter().enumerate() {
        let common = (0..=i).rev().take_while(|&j| j == i || ends[j] > column.stretch().start);
        common.for_each(|j| normal.add(i, j, column.dot(&basis[j])));
    }
    let factor = normal.factor();
    let joints = (0..position.columns()).map(|j| basis.iter().map(|c| c.times(position.column(j))).collect());
    Matrix::from_columns(basis.len(), joints.flat_map(|b| factor.solve(b)).collect())
}

fn residual(samples: &Samples, basis: &[LocalColumn], points: &Matrix) -> Matrix {
    let mut residual = samples.position.clone();
    for j in 0..residual.columns() {
        basis.iter().enumerate().for_each(|(k, column)| column.add_to(-points.at(k, j), residual.column_mut(j)));
    }
    residual
}

/// The derivatives of `s` with respect to the four unknowns of a law.
fn sensitivity(samples: &Samples, law: &TimeLaw) -> [LocalColumn; UNKNOWNS] {
    let stretch = samples.between(law.start_s, law.end_s());
    let rows: Vec<[f64; UNKNOWNS]> = samples.time[stretch.clone()].iter().map(|t| law.sensitivity(*t)).collect();
    std::array::from_fn(|p| LocalColumn::new(stretch.clone(), |i| rows[i - stretch.start][p]))
}

fn sum_of_squares(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_ground::linear_algebra::PivotedQr;

    /// Of a step against one by orthogonal factors, relative to its largest entry: the square of the problem's condition times rounding.
    const STEP: f64 = 1e-7;

    /// Three moves of two joints, the second beginning before the first has ended.
    fn laws() -> Vec<TimeLaw> {
        let law = |start_s, t1_s| TimeLaw { start_s, t1_s, t2_s: 0.12, t3_s: 0.03 };
        vec![law(0.1, 0.3), law(0.53, 0.4), law(1.3, 0.2)]
    }

    fn samples(known_start: bool) -> Samples {
        let rate = 500.0;
        let shift = |law: &TimeLaw| TimeLaw { start_s: law.start_s + 0.004, t1_s: 1.02 * law.t1_s, ..*law };
        let truth: Vec<TimeLaw> = laws().iter().map(shift).collect();
        let [ends, back] = [[1.0, -0.4, 0.5], [-0.6, 0.9, 0.1]];
        let at = |k: usize, ends: [f64; 3]| -> f64 {
            truth.iter().zip(ends).map(|(law, d)| d * law.evaluate(k as f64 / rate).0).sum()
        };
        let q = (0..900).flat_map(|k| [at(k, ends), 0.2 * f64::from(u8::from(!known_start)) + at(k, back)]).collect();
        let samples = Samples::new(&Series::shaped(2, q), 0..900, 1, rate);
        if known_start { samples.with_known_start(vec![0.0; 2]) } else { samples }
    }

    /// The whole derivative by laws and points as a dense matrix, solved by an orthogonal factor.
    fn dense_step(samples: &Samples, weights: &[f64], from: &Fit) -> Vec<f64> {
        let (n, joints) = (samples.len(), weights.len());
        let mut columns = Vec::new();
        for (k, law) in from.laws.iter().enumerate() {
            for p in 0..UNKNOWNS {
                let entry =
                    |j: usize, t: f64| weights[j] * (from.point(k + 1, j) - from.point(k, j)) * law.sensitivity(t)[p];
                columns.extend((0..joints).flat_map(|j| samples.time.iter().map(move |t| entry(j, *t))));
            }
        }
        for (column, joint) in from.basis.iter().flat_map(|c| (0..joints).map(move |j| (c, j))) {
            let mut dense = vec![0.0; joints * n];
            column.add_to(weights[joint], &mut dense[joint * n..(joint + 1) * n]);
            columns.extend(dense);
        }
        let residual: Vec<f64> =
            (0..joints).flat_map(|j| from.residual.column(j).iter().map(move |r| weights[j] * r)).collect();
        let solution = PivotedQr::new(&Matrix::from_columns(joints * n, columns)).solve(&residual);
        solution[..UNKNOWNS * from.laws.len()].to_vec()
    }

    #[test]
    fn a_step_is_that_of_the_dense_problem() {
        for known_start in [false, true] {
            let (samples, weights) = (samples(known_start), [1.0, 3.0]);
            let from = Fit::new(&samples, &weights, laws());
            let (found, expected) =
                (from.linearise(&samples, &weights).solve(0.0), dense_step(&samples, &weights, &from));
            let largest = expected.iter().fold(0.0, |l: f64, v| l.max(v.abs()));
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < STEP * largest, "{found} {expected}");
            }
        }
    }

    #[test]
    fn points_leave_nothing_that_other_points_explain() {
        for known_start in [false, true] {
            let samples = samples(known_start);
            let found = Fit::new(&samples, &[1.0; 2], laws());
            for (column, j) in found.basis.iter().flat_map(|c| [(c, 0), (c, 1)]) {
                assert!(column.times(found.residual.column(j)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn laws_and_points_are_found() {
        for known_start in [false, true] {
            let found = fit(&samples(known_start), &[1.0; 2], laws());
            for (law, first) in found.laws.iter().zip(laws()) {
                assert!(
                    (law.start_s - first.start_s - 0.004).abs() < 1e-9 && (law.t1_s / first.t1_s - 1.02).abs() < 1e-8
                );
            }
            assert!((found.end_points()[2][0] - 1.1).abs() < 1e-9);
        }
    }
}
