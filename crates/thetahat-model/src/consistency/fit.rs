use super::{
    elimination::Elimination,
    error::ConsistencyError,
    interior::inside,
    interior_point::{Minimum, ScaledSystem, Stop, minimise},
    program::{Block, Program},
    set::{Condition, ConditionBlock, ConsistentSet},
    symmetric::Symmetric,
};
use crate::{base_parameters::BaseParameters, robot::Bound};
use thetahat_ground::linear_algebra::{Matrix, dot};

/// `|A theta - b|^2 + rest` over standard parameters theta.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquares {
    matrix: Matrix,
    right_side: Vec<f64>,
    rest: f64,
}

/// The prior information, as a term of the objective.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prior {
    /// No prior: the least residual. Parameters that the data determine weakly or not at all can be far from any robot's;
    /// [`Prior::LogDet`] with a small weight keeps them near the a-priori ones.
    None,
    /// `weight |theta - theta_0|^2` over the inertial parameters of all links, each in its SI unit.
    Euclidean {
        /// Weight, in squares of the residual.
        weight: f64,
    },
    /// `weight sum_l D(P_l | P_l0)`, the log-det divergence `D(P | P_0) = tr(P_0^-1 P) - log det(P_0^-1 P) - 4`, and the same
    /// divergence of the motor inertias that have an a-priori value.
    LogDet {
        /// Weight, in squares of the residual.
        weight: f64,
    },
    /// `weight sum_l part_l D(P_l | P_l0) + min(weight, 1) (sum_i D(s_i | size_i) + sum_j (s_j / size_j)^2)`: the log-det
    /// divergence of the bodies, that of the numbers that cannot be negative, and the squares of the others, by the set's
    /// [`Beliefs`](super::Beliefs). With a residual of unit variance, a body is believed to `sqrt(2 / weight)` of its size.
    Belief {
        /// Weight, in squares of the residual; positive.
        weight: f64,
    },
}

/// A physically consistent estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct ConsistentFit {
    /// All standard parameters, strictly inside the set, except for known values, which hold exactly.
    pub standard: Vec<f64>,
    /// `|A theta - b|^2 + rest`.
    pub squared_residual: f64,
    /// The squared residual with the prior's term.
    pub objective: f64,
    /// Upper bound of the distance of the objective from the least one.
    pub gap: f64,
    /// Whether the gap is as small as requested.
    pub converged: bool,
    /// Iterations, without those that find an interior point.
    pub iterations: usize,
    /// Trace of the derivative of `A theta` with respect to b: the number of parameters that the data determine, given the
    /// conditions and the prior. Without both it is the rank of A.
    pub effective_parameters: f64,
    /// The multipliers of the conditions, whose matrices are singular where the multiplier is not zero.
    pub multipliers: Vec<(Condition, Symmetric)>,
}

/// Duality gap, relative to the objective, at which a fit ends.
const RELATIVE_GAP: f64 = 1e-10;
/// Duality gap relative to `|b|^2`, for data that are consistent, whose objective is zero.
const ABSOLUTE_GAP: f64 = 1e-20;
/// Fraction of the barrier's pull towards a-priori values that a fit keeps: enough to bound parameters that the data leave
/// free.
const PULL: f64 = 1e-4;
/// Fraction of the way from a start to the a-priori parameters that keeps the start off the boundary.
const TO_CENTRE: f64 = 0.1;
/// Violation of a condition without unknowns, relative to its usual size, below which it is rounding.
const ROUNDING: f64 = 1e-9;

impl LeastSquares {
    /// Over standard parameters: `matrix` has a column for each of them.
    #[must_use]
    pub fn in_standard(matrix: Matrix, right_side: Vec<f64>) -> Self {
        Self { matrix, right_side, rest: 0.0 }
    }

    /// `|R theta_b - z|^2` with `theta_b = K theta`.
    ///
    /// # Errors
    /// [`ConsistencyError::WrongSize`] unless R has a column for each base parameter.
    pub fn in_base(r: &Matrix, z: Vec<f64>, base: &BaseParameters, count: usize) -> Result<Self, ConsistencyError> {
        if r.columns() != base.len() {
            let (expected, found) = (base.len(), r.columns());
            return Err(ConsistencyError::WrongSize { what: "the columns of the regression", expected, found });
        }
        let mut matrix = Matrix::zeros(r.rows(), count);
        for (j, parameter) in base.parameters().iter().enumerate() {
            for &(i, c) in parameter.regrouped.iter().chain(&[(parameter.kept, 1.0)]) {
                matrix.column_mut(i).iter_mut().zip(r.column(j)).for_each(|(m, r)| *m += c * r);
            }
        }
        Ok(Self::in_standard(matrix, z))
    }

    /// `|R (theta_b - theta_hat)|^2`: the distance from an estimate in the metric of its regression.
    ///
    /// # Errors
    /// As [`LeastSquares::in_base`], also for the estimate.
    pub fn nearest(
        r: &Matrix,
        estimate: &[f64],
        base: &BaseParameters,
        count: usize,
    ) -> Result<Self, ConsistencyError> {
        if estimate.len() != r.columns() {
            let (expected, found) = (r.columns(), estimate.len());
            return Err(ConsistencyError::WrongSize { what: "the estimate", expected, found });
        }
        Self::in_base(r, r.times(estimate), base, count)
    }

    /// The problem with an additional sum of squares that no parameter changes, such as the residual of a triangular
    /// factorisation.
    #[must_use]
    pub fn with_residual_squares(self, rest: f64) -> Self {
        Self { rest, ..self }
    }

    /// `A theta - b`.
    #[must_use]
    pub fn residual(&self, standard: &[f64]) -> Vec<f64> {
        self.matrix.times(standard).iter().zip(&self.right_side).map(|(a, b)| a - b).collect()
    }

    pub(super) fn right_side(&self) -> &[f64] {
        &self.right_side
    }

    pub(super) fn matrix(&self) -> &Matrix {
        &self.matrix
    }

    pub(super) fn check(&self, parameters: usize) -> Result<(), ConsistencyError> {
        let (rows, columns) = (self.matrix.rows(), self.matrix.columns());
        if columns != parameters {
            let what = "the columns of the regression";
            return Err(ConsistencyError::WrongSize { what, expected: parameters, found: columns });
        }
        if self.right_side.len() != rows {
            let found = self.right_side.len();
            return Err(ConsistencyError::WrongSize { what: "the right side", expected: rows, found });
        }
        let finite = (0..columns).all(|j| self.matrix.column(j).iter().all(|v| v.is_finite()));
        let finite = finite && self.right_side.iter().chain([&self.rest]).all(|v| v.is_finite());
        if finite { Ok(()) } else { Err(ConsistencyError::NotFinite) }
    }
}

/// The standard parameters of the set with the least objective.
///
/// `start` are parameters to start from, such as the result of a similar fit; they need not be in the set.
///
/// # Errors
/// [`ConsistencyError`] for sizes that do not fit, and for a set without interior.
pub fn fit(
    set: &ConsistentSet,
    data: &LeastSquares,
    prior: Prior,
    start: Option<&[f64]>,
) -> Result<ConsistentFit, ConsistencyError> {
    fit_within(set, data, prior, start, RELATIVE_GAP)
}

/// [`fit`] that ends at a duality gap, relative to the objective: 1e-7 is enough to compare predictions.
///
/// # Errors
/// As [`fit`].
pub fn fit_within(
    set: &ConsistentSet,
    data: &LeastSquares,
    prior: Prior,
    start: Option<&[f64]>,
    relative_gap: f64,
) -> Result<ConsistentFit, ConsistencyError> {
    data.check(set.parameter_table().len())?;
    let elimination = set.elimination()?;
    let conditions = reduced_conditions(set, &elimination)?;
    let usual = starting_point(set);
    let near = start.filter(|s| s.len() == usual.len()).unwrap_or(&usual);
    let start: Vec<f64> = near.iter().zip(&usual).map(|(s, u)| s + TO_CENTRE * (u - s)).collect();
    let start = inside(&conditions, elimination.unknowns_of(&start))?;
    let squares = dot(data.right_side(), data.right_side());
    let absolute_gap = (ABSOLUTE_GAP * squares).max(f64::MIN_POSITIVE);
    let stop = Stop { relative_gap, absolute_gap, objective: f64::NEG_INFINITY };
    let conditions = binding(set, prior, conditions);
    let program = program(set, data, prior, &elimination, &conditions);
    let minimum = minimise(&program, start, &stop).ok_or(ConsistencyError::NotSolved)?;
    Ok(result(data, &elimination, conditions, minimum))
}

/// The conditions that do not follow from the prior.
pub(super) fn binding(set: &ConsistentSet, prior: Prior, conditions: Vec<ConditionBlock>) -> Vec<ConditionBlock> {
    match prior {
        Prior::None | Prior::Euclidean { .. } | Prior::LogDet { .. } => conditions,
        Prior::Belief { .. } => conditions.into_iter().filter(|c| !set.follows_from_belief(&c.condition)).collect(),
    }
}

/// Checks that some parameters satisfy all conditions of a set strictly.
///
/// # Errors
/// [`ConsistencyError`], which names known values that contradict each other or leave no interior.
pub fn require_interior(set: &ConsistentSet) -> Result<(), ConsistencyError> {
    let elimination = set.elimination()?;
    let conditions = reduced_conditions(set, &elimination)?;
    inside(&conditions, elimination.unknowns_of(&starting_point(set))).map(|_| ())
}

fn result(
    data: &LeastSquares,
    elimination: &Elimination,
    conditions: Vec<ConditionBlock>,
    minimum: Minimum,
) -> ConsistentFit {
    let standard = elimination.standard(&minimum.x);
    let residual = data.residual(&standard);
    ConsistentFit {
        squared_residual: dot(&residual, &residual) + data.rest,
        objective: minimum.objective + data.rest,
        gap: minimum.gap,
        converged: minimum.converged,
        iterations: minimum.iterations,
        effective_parameters: effective_parameters(&elimination.matrix(&data.matrix), minimum.system.as_ref()),
        multipliers: conditions.into_iter().map(|c| c.condition).zip(minimum.duals).collect(),
        standard,
    }
}

/// `tr(2 A^T A M^-1)` with Newton's matrix M at the minimum.
fn effective_parameters(a: &Matrix, system: Option<&ScaledSystem>) -> f64 {
    let gram = a.transposed_times(a);
    let solved = |j: usize| system.and_then(|s| s.solve(gram.column(j))).map_or(0.0, |x| 2.0 * x[j]);
    (0..gram.columns()).map(solved).sum()
}

/// The a-priori parameters, with usual values where motor inertias and friction have none.
pub(super) fn starting_point(set: &ConsistentSet) -> Vec<f64> {
    let positive = |i: usize| set.parameter_table().get(i).quantity.bound() == Bound::NotNegative;
    let value = |(i, (a, scale)): (usize, (&f64, &f64))| if positive(i) && *a <= 0.0 { *scale } else { *a };
    set.a_priori().iter().zip(set.scale()).enumerate().map(value).collect()
}

/// The conditions in the unknowns; those without unknowns are checked and left out.
pub(super) fn reduced_conditions(
    set: &ConsistentSet,
    elimination: &Elimination,
) -> Result<Vec<ConditionBlock>, ConsistencyError> {
    let mut out = Vec::new();
    for ConditionBlock { condition, block, reference } in set.conditions() {
        let block = elimination.block(&block);
        if !block.terms.is_empty() {
            out.push(ConditionBlock { condition, block, reference });
            continue;
        }
        let margin = reference.cholesky().map_or(f64::NAN, |factor| factor.smallest_ratio(&block.constant));
        if margin.is_nan() || margin < -ROUNDING {
            return Err(ConsistencyError::NoInterior { margin, conflicting: vec![condition.to_string()] });
        }
    }
    Ok(out)
}

pub(super) fn program(
    set: &ConsistentSet,
    data: &LeastSquares,
    prior: Prior,
    elimination: &Elimination,
    conditions: &[ConditionBlock],
) -> Program {
    let weakened = |block: Block| Block { barrier: block.barrier.with_pull(PULL), ..block };
    let mut blocks: Vec<Block> = conditions.iter().map(|c| weakened(c.block.clone())).collect();
    let (mut matrix, mut right_side) = (data.matrix.clone(), data.right_side.clone());
    match prior {
        Prior::None => {}
        Prior::Euclidean { weight } => {
            let (rows, values) = euclidean_rows(set, weight.max(0.0).sqrt());
            matrix = Matrix::stack(&[&matrix, &rows]);
            right_side.extend(values);
        }
        Prior::LogDet { weight } => {
            let links = (0..set.links()).filter_map(|k| set.divergence(k, weight));
            let all = links.chain(set.motor_divergences(weight)).filter(|_| weight > 0.0);
            let blocks_of_prior = all.map(|block| elimination.block(&block)).filter(|block| !block.terms.is_empty());
            blocks.extend(blocks_of_prior);
        }
        Prior::Belief { weight } => {
            let all = set.belief_divergences(weight).into_iter().map(|block| elimination.block(&block));
            blocks.extend(all.filter(|block| !block.terms.is_empty()));
            let squares = set.belief_squares(weight);
            let entry = |row: usize, column: usize| if squares[row].0 == column { squares[row].1 } else { 0.0 };
            matrix = Matrix::stack(&[&matrix, &Matrix::from_fn(squares.len(), matrix.columns(), entry)]);
            right_side.extend(vec![0.0; squares.len()]);
        }
    }
    let constant = elimination.constant_part(&matrix);
    let right_side = right_side.iter().zip(constant).map(|(b, c)| b - c).collect();
    let linear = vec![0.0; elimination.unknowns()];
    Program { matrix: elimination.matrix(&matrix), right_side, linear, constant: 0.0, blocks }
}

fn euclidean_rows(set: &ConsistentSet, factor: f64) -> (Matrix, Vec<f64>) {
    let table = set.parameter_table();
    let inertial: Vec<usize> = (0..table.len()).filter(|&i| table.get(i).quantity.is_inertial()).collect();
    let entry = |row: usize, column: usize| if inertial[row] == column { factor } else { 0.0 };
    let values = inertial.iter().map(|&i| factor * set.a_priori()[i]).collect();
    (Matrix::from_fn(inertial.len(), table.len(), entry), values)
}
