use super::{
    error::ConsistencyError,
    fit::{ConsistentFit, LeastSquares, Prior, fit},
    set::ConsistentSet,
};
use crate::base_parameters::BaseParameters;
use thetahat_ground::linear_algebra::{Matrix, dot};

/// Distance of simulation parameters from the boundary of the set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InteriorOptions {
    /// Each pseudo-inertia matrix and motor inertia is at least this fraction of the a-priori one.
    pub interior: f64,
    /// Weight of the log-det divergence from the a-priori parameters, relative to `|R theta_hat|^2`.
    pub pull: f64,
}

impl Default for InteriorOptions {
    fn default() -> Self {
        Self { interior: 0.3, pull: 1e-7 }
    }
}

/// The parameters to simulate with for instruments: the nearest to an estimate in the interior of the set.
///
/// They minimise `|R (K theta - theta_hat)|^2 + pull |R theta_hat|^2 sum_l D(P_l | P_l0)` over
/// `P_l >= interior P_l0`, R the triangular factor of the regression in base parameters. `before` is the result of the previous
/// iteration, from which the search starts.
///
/// The mass matrix of the result is positive definite in every configuration. Instruments need not be simulated with the
/// estimate itself: any simulator independent of the noise is valid, and a close one is efficient.
///
/// # Errors
/// As [`fit`], and for an `interior` that is not between 0 and 1.
pub fn nearest_to_simulate(
    set: &ConsistentSet,
    base: &BaseParameters,
    r: &Matrix,
    estimate: &[f64],
    options: &InteriorOptions,
    before: Option<&ConsistentFit>,
) -> Result<ConsistentFit, ConsistencyError> {
    let set = set.clone().with_interior(options.interior)?;
    let data = LeastSquares::nearest(r, estimate, base, set.parameter_table().len())?;
    let weight = options.pull * dot(data.right_side(), data.right_side());
    fit(&set, &data, Prior::LogDet { weight }, before.map(|fit| fit.standard.as_slice()))
}
