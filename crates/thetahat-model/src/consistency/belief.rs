//! What recordings add to a belief.

use super::{
    error::ConsistencyError,
    fit::{LeastSquares, Prior, binding, program, reduced_conditions},
    interior_point::{ScaledSystem, curvature},
    set::ConsistentSet,
};
use crate::base_parameters::{BaseParameter, BaseParameters};
use thetahat_ground::linear_algebra::Matrix;

/// What is known of base parameters before and after the recordings, to second order about the belief.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseKnowledge {
    /// Variance of each by the belief alone.
    pub believed_variance: Vec<f64>,
    /// Covariance with the recordings.
    pub covariance: Matrix,
}

impl BaseKnowledge {
    /// The percent of each parameter that the recordings decided, `100 (1 - variance / believed variance)`.
    #[must_use]
    pub fn decided_percent(&self) -> Vec<f64> {
        let of = |(i, believed): (usize, &f64)| 100.0 * (1.0 - self.covariance.at(i, i) / believed).clamp(0.0, 1.0);
        self.believed_variance.iter().enumerate().map(of).collect()
    }
}

/// What `data`, of unit variance, adds to [`Prior::Belief`] of this weight.
///
/// # Errors
/// [`ConsistencyError`] for sizes that do not fit, and for a set without interior.
pub fn knowledge_of_base(
    set: &ConsistentSet,
    data: &LeastSquares,
    weight: f64,
    base: &BaseParameters,
) -> Result<BaseKnowledge, ConsistencyError> {
    let count = set.parameter_table().len();
    data.check(count)?;
    let elimination = set.elimination()?;
    let prior = Prior::Belief { weight };
    let conditions = binding(set, prior, reduced_conditions(set, &elimination)?);
    let nothing = LeastSquares::in_standard(Matrix::zeros(1, count), vec![0.0]);
    let directions = elimination.matrix(&combinations(base.parameters(), count));
    let covariance = |data: &LeastSquares| {
        let program = program(set, data, prior, &elimination, &conditions);
        let matrix = curvature(&program, elimination.unknowns_of(&set.believed()));
        let system = matrix.and_then(|m| ScaledSystem::new(&m)).ok_or(ConsistencyError::NotSolved)?;
        covariance_along(&system, &directions).ok_or(ConsistencyError::NotSolved)
    };
    let believed = covariance(&nothing)?;
    let believed_variance = (0..base.len()).map(|i| believed.at(i, i)).collect();
    Ok(BaseKnowledge { believed_variance, covariance: covariance(data)? })
}

/// Each base parameter as a row of standard parameters.
fn combinations(base: &[BaseParameter], count: usize) -> Matrix {
    let mut rows = Matrix::zeros(base.len(), count);
    for (row, parameter) in base.iter().enumerate() {
        for &(i, c) in parameter.regrouped.iter().chain(&[(parameter.kept, 1.0)]) {
            *rows.at_mut(row, i) += c;
        }
    }
    rows
}

/// `2 K H^-1 K^T`: half of Newton's matrix H is the information, for the objective is twice a negative logarithm of a
/// probability.
fn covariance_along(system: &ScaledSystem, directions: &Matrix) -> Option<Matrix> {
    let transposed = directions.transpose();
    let solved = (0..directions.rows()).map(|i| system.solve(transposed.column(i))).collect::<Option<Vec<_>>>()?;
    let along = |i: usize, j: usize| {
        let pairs = transposed.column(i).iter().zip(&solved[j]);
        2.0 * pairs.map(|(a, b)| a * b).sum::<f64>()
    };
    Some(Matrix::from_fn(directions.rows(), directions.rows(), |i, j| 0.5 * (along(i, j) + along(j, i))))
}
