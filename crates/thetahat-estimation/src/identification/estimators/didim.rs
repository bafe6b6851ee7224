//! Least squares on the simulated motion.

use super::{
    estimator::{DesignMatrix, Estimator, Needs, Response},
    ls::{influence, least_squares},
};
use crate::{
    identification::fit::{Divisor, EstimationError, Fit},
    regression::Regression,
};
use thetahat_ground::linear_algebra::Matrix;

pub(super) static DIDIM: Estimator = Estimator {
    name: "didim",
    equation: "(19)",
    needs: Needs::Instruments,
    design: DesignMatrix::Simulated,
    response: Response::Torque,
    weighting: None,
    estimate: |regression, z, divisor| didim(regression, z.ok_or(EstimationError::NoInstruments)?, divisor),
    influence: |regression, z| influence(regression, z.ok_or(EstimationError::NoInstruments)?),
};

/// One step of DIDIM (19): `theta = Z^+ y`, with covariance `s^2 (Z^T Z)^-1`.
///
/// The covariance assumes an exact simulator: it does not include the bias of a wrong one.
///
/// # Errors
/// [`EstimationError`] where Z has dependent columns.
pub fn didim(regression: &Regression, z: &Matrix, divisor: Divisor) -> Result<Fit, EstimationError> {
    least_squares(regression, z, divisor)
}
