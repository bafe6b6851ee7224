//! Instrumental variables from a simulated motion.

use super::estimator::{DesignMatrix, Estimator, Needs, Response};
use crate::{
    identification::fit::{Divisor, EstimationError, Fit, Solved, full_rank, require_full_rank},
    regression::{InstrumentalVariables, Regression},
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr};

pub(super) static IDIM_IV: Estimator = Estimator {
    name: "idim-iv",
    equation: "(10)",
    needs: Needs::Instruments,
    design: DesignMatrix::Measured,
    response: Response::Torque,
    weighting: None,
    estimate: |regression, z, divisor| idim_iv(regression, z.ok_or(EstimationError::NoInstruments)?, divisor),
    influence: |regression, z| influence(regression, z.ok_or(EstimationError::NoInstruments)?),
};

/// IDIM-IV (9): `theta = (Z^T X)^-1 Z^T y`, with covariance `s^2 (Z^T X)^-1 Z^T Z (X^T Z)^-1`.
///
/// With `Z = Q R`, `theta = (Q^T X)^-1 Q^T y` and the covariance is `s^2 (Q^T X)^-1 (Q^T X)^-T`. It assumes instruments
/// that are independent of the noise and rows of equal variance. Weights whiten X, y and Z alike.
///
/// # Errors
/// [`EstimationError`] where Z or the product has dependent columns.
pub fn idim_iv(regression: &Regression, z: &Matrix, divisor: Divisor) -> Result<Fit, EstimationError> {
    let iv = instrumental_variables(regression, z)?;
    let theta = iv.solve(&regression.whiten(&regression.y));
    let inverse = iv.inverse();
    let columns = theta.len();
    let entry = |i: usize, j: usize| (0..columns).map(|k| inverse.at(i, k) * inverse.at(j, k)).sum();
    let unit_covariance = Matrix::from_fn(columns, columns, entry);
    let condition_number = iv.projected.condition_number();
    Fit::new(regression, &regression.x, divisor, Solved { theta, unit_covariance, condition_number })
}

/// `W Q (X_w^T Q)^-1` with `Z_w = Q R` and the weights W.
pub(super) fn influence(regression: &Regression, z: &Matrix) -> Result<Matrix, EstimationError> {
    let influence = instrumental_variables(regression, z)?.influence();
    Ok(regression.whiten_matrix(&influence).into_owned())
}

fn instrumental_variables(regression: &Regression, z: &Matrix) -> Result<InstrumentalVariables, EstimationError> {
    let basis = full_rank(&regression.whiten_matrix(z))?.thin_q();
    let x = regression.whiten_matrix(&regression.x);
    let iv = InstrumentalVariables::new(basis, &x, PivotedQr::with_equal_columns);
    let factors = require_full_rank(iv.factors, iv.projected.columns())?;
    Ok(InstrumentalVariables { factors, ..iv })
}
