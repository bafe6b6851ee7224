//! How the exported parameters vary with the estimates.

use super::{error::ExportError, posterior::Posterior};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr};
use thetahat_model::consistency::dependence_on_base;

/// The covariance of the exported parameters.
#[derive(Debug, Clone)]
pub(super) struct ExportedCovariance {
    pub(super) base: Matrix,
    pub(super) standard: Matrix,
}

impl Posterior {
    /// Base parameters from the normal distribution about the estimates, of independent standard normal numbers.
    pub(super) fn drawn(&self, normal: &[f64]) -> Result<Vec<f64>, ExportError> {
        self.known_uncertainty()?.drawn(&self.estimates, normal).ok_or_else(|| self.singular())
    }

    /// The covariance of the base parameters with what is known of them, and to first order that of the standard parameters.
    pub(super) fn covariance_at(&self, standard: &[f64]) -> Result<ExportedCovariance, ExportError> {
        let uncertainty = self.known_uncertainty()?;
        let by = dependence_on_base(&self.set, &self.base, standard).map_err(|e| self.refuse(e))?;
        if by.base.columns() == self.base.len() {
            return Ok(ExportedCovariance {
                base: uncertainty.covariance.clone(),
                standard: image(&by.standard, &uncertainty.covariance),
            });
        }
        let whitening = uncertainty.whitening().ok_or_else(|| self.singular())?;
        let of_free = match by.base.columns() {
            0 => Matrix::zeros(0, 0),
            _ => PivotedQr::with_equal_columns(&whitening.times_matrix(&by.base)).inverse_gram(),
        };
        Ok(ExportedCovariance { base: image(&by.base, &of_free), standard: image(&by.standard, &of_free) })
    }
}

/// `G C G^T`.
fn image(g: &Matrix, covariance: &Matrix) -> Matrix {
    g.times_matrix(covariance).times_transposed(g)
}
