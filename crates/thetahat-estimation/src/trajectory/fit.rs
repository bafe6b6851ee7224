//! Time laws and end points by least squares: variable projection with Levenberg-Marquardt steps.
//!
//! For given time laws the positions are linear in P_0 and the displacements D_k, and those are eliminated (Golub and
//! Pereyra, 1973, in Kaufman's approximation). Four unknowns remain for each move, its start and the logarithms of
//! T1, T2, T3. One move and many moves are the same problem.
//!
//! | letter | word | shape |
//! | --- | --- | --- |
//! | `basis` | columns 1 (where P_0 is free), s_1 .. s_K over time | samples x (1 + K) |
//! | `coefficients` | P_0 (where it is free), D_1 .. D_K | (1 + K) x joints |
//! | `residual` | position less `basis * coefficients` | samples x joints |
//! | `g` | derivatives of s_k by its four unknowns, less what the basis can express | samples x 4 K |
//!
//! The derivative of joint j by the unknowns of move k is `D_kj g_k`: all joints share `g`. With `g = Q (Q^T g)` the
//! least squares shrink from joints times samples to joints times 4 K rows; `Q^T g` and `Q^T residual` stand in one
//! triangular factor, and Q is not needed.

use std::ops::Range;

use super::TimeLaw;
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
};

/// Unknowns of a time law.
const UNKNOWNS: usize = 4;
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
    basis: Matrix,
    coefficients: Matrix,
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
fn improve(samples: &Samples, weights: &[f64], from: &Fit, problem: &Linear, damping: &mut f64) -> Option<Fit> {
    while *damping < LARGEST_DAMPING {
        let laws = moved(&from.laws, &problem.step(*damping), samples.shortest());
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
        let coefficients = PivotedQr::new(&basis).solve_matrix(&samples.position);
        let first_row = || (0..coefficients.columns()).map(|j| coefficients.at(0, j)).collect();
        let start = samples.known_start.clone().unwrap_or_else(first_row);
        let residual = less(&samples.position, &basis.times_matrix(&coefficients));
        let cost = weights.iter().enumerate().map(|(j, w)| w * w * sum_of_squares(residual.column(j))).sum();
        Self { laws, start, basis, coefficients, cost }
    }

    /// The end points P_1 .. P_K.
    pub fn end_points(&self) -> Vec<Vec<f64>> {
        let mut point = self.start.clone();
        (0..self.laws.len())
            .map(|k| {
                point.iter_mut().enumerate().for_each(|(j, p)| *p += self.displacement(k, j));
                point.clone()
            })
            .collect()
    }

    /// D_kj, with k from zero: the last K rows of the coefficients.
    fn displacement(&self, k: usize, j: usize) -> f64 {
        self.coefficients.at(self.coefficients.rows() - self.laws.len() + k, j)
    }

    /// `g` as a triangle, and the residual in its coordinates: the rows after those of the basis in the triangular factor of `[basis
    /// sensitivities positions]`.
    fn linearise(&self, samples: &Samples, weights: &[f64]) -> Linear {
        let sensitivity = sensitivity(&samples.time, &self.laws);
        let unknowns = sensitivity.columns();
        let r = Matrix::side_by_side(&[&self.basis, &sensitivity, &samples.position]).triangular_factor();
        let first = self.basis.columns();
        let left = r.row_range(first..r.rows().min(first + unknowns));
        let columns = |from: usize, count: usize| left.select_columns(&(from..from + count).collect::<Vec<_>>());
        self.stack(&columns(first, unknowns), &columns(first + unknowns, samples.position.columns()), weights)
    }

    /// The equations of all joints, stacked, from their common `g`.
    fn stack(&self, g: &Matrix, residual: &Matrix, weights: &[f64]) -> Linear {
        let (rows, joints) = (g.rows(), residual.columns());
        let entry = |i: usize, c: usize| {
            let j = i / rows;
            weights[j] * self.displacement(c / UNKNOWNS, j) * g.at(i % rows, c)
        };
        Linear {
            jacobian: Matrix::from_fn(joints * rows, g.columns(), entry),
            residual: (0..joints).flat_map(|j| residual.column(j).iter().map(move |r| weights[j] * r)).collect(),
        }
    }
}

/// The linear least squares of one step.
struct Linear {
    jacobian: Matrix,
    residual: Vec<f64>,
}

impl Linear {
    /// The step, damped by `damping` times the squared norm of each column.
    fn step(&self, damping: f64) -> Vec<f64> {
        let (rows, columns) = (self.jacobian.rows(), self.jacobian.columns());
        let diagonal: Vec<f64> =
            (0..columns).map(|c| (damping * sum_of_squares(self.jacobian.column(c))).sqrt()).collect();
        let entry = |i: usize, c: usize| match i {
            i if i < rows => self.jacobian.at(i, c),
            i if i - rows == c => diagonal[c],
            _ => 0.0,
        };
        let target: Vec<f64> = self.residual.iter().copied().chain(std::iter::repeat_n(0.0, columns)).collect();
        PivotedQr::new(&Matrix::from_fn(rows + columns, columns, entry)).solve(&target)
    }
}

fn basis(samples: &Samples, laws: &[TimeLaw]) -> Matrix {
    let constants = usize::from(samples.known_start.is_none());
    let mut basis = Matrix::zeros(samples.len(), constants + laws.len());
    (0..constants).for_each(|c| basis.column_mut(c).fill(1.0));
    for (k, law) in laws.iter().enumerate() {
        basis.column_mut(constants + k).iter_mut().zip(&samples.time).for_each(|(s, t)| *s = law.evaluate(*t).0);
    }
    basis
}

fn sensitivity(time: &[f64], laws: &[TimeLaw]) -> Matrix {
    let mut sensitivity = Matrix::zeros(time.len(), UNKNOWNS * laws.len());
    for (k, law) in laws.iter().enumerate() {
        for (i, t) in time.iter().enumerate() {
            let row = law.sensitivity(*t);
            row.into_iter().enumerate().for_each(|(p, d)| *sensitivity.at_mut(i, UNKNOWNS * k + p) = d);
        }
    }
    sensitivity
}

fn less(a: &Matrix, b: &Matrix) -> Matrix {
    Matrix::from_fn(a.rows(), a.columns(), |i, j| a.at(i, j) - b.at(i, j))
}

fn sum_of_squares(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum()
}
