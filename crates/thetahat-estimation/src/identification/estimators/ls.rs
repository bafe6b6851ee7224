//! Least squares on the measured motion, with the weights of the regression (WLS).

use super::estimator::{DesignMatrix, Estimator, Needs, Response};
use crate::{
    identification::fit::{Divisor, EstimationError, Fit, Solved, full_rank},
    regression::Regression,
};
use thetahat_ground::linear_algebra::Matrix;

pub(super) static IDIM_LS: Estimator = Estimator {
    name: "idim-ls",
    equation: "(8)",
    needs: Needs::Measurement,
    design: DesignMatrix::Measured,
    response: Response::Torque,
    weighting: None,
    estimate: |regression, _, divisor| idim_ls(regression, divisor),
    influence: |regression, _| influence(regression, &regression.x),
};

/// IDIM-LS (8): `theta = X^+ y`, with covariance `s^2 (X^T X)^-1` and `s^2` from the residual.
///
/// The covariance assumes an exact X and independent rows of equal variance. Where the regression has weights, X, y and
/// the residual in `s^2` are whitened (WLS).
///
/// # Errors
/// [`EstimationError`] where the columns are dependent.
pub fn idim_ls(regression: &Regression, divisor: Divisor) -> Result<Fit, EstimationError> {
    least_squares(regression, &regression.x, divisor)
}

/// Least squares of y on a matrix with the rows of the regression.
pub(super) fn least_squares(regression: &Regression, a: &Matrix, divisor: Divisor) -> Result<Fit, EstimationError> {
    let qr = full_rank(&regression.whiten_matrix(a))?;
    let theta = qr.solve(&regression.whiten(&regression.y));
    let (unit_covariance, condition_number) = (qr.inverse_gram(), qr.thin_r().condition_number());
    Fit::new(regression, a, divisor, Solved { theta, unit_covariance, condition_number })
}

/// `W A_w (A_w^T A_w)^-1` with the weights W.
pub(super) fn influence(regression: &Regression, a: &Matrix) -> Result<Matrix, EstimationError> {
    let whitened = regression.whiten_matrix(a);
    let influence = whitened.times_matrix(&full_rank(&whitened)?.inverse_gram());
    Ok(regression.whiten_matrix(&influence).into_owned())
}
