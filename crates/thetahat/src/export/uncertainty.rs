//! The uncertainty of the estimates of a run.

use thetahat_estimation::statistics::CovarianceFactor;
use thetahat_ground::linear_algebra::Matrix;
use thetahat_report::results::{ParameterResult, RunResult};

/// The uncertainty of estimates.
#[derive(Debug, Clone)]
pub(super) struct Uncertainty {
    pub(super) covariance: Matrix,
    /// Whether the results hold correlations.
    pub(super) is_correlated: bool,
    /// Its factor and the whitening matrix; `None` if the covariance is singular.
    factor: Option<(CovarianceFactor, Matrix)>,
}

impl Uncertainty {
    /// The uncertainty of the estimates of a run; `None` if it has no deviations. Results from before covariances were written have deviations
    /// alone.
    pub(super) fn of(run: &RunResult, estimates: &[ParameterResult]) -> Option<Self> {
        let (n, count) = (estimates.len(), run.parameters.len());
        let all = Matrix::from_lower_half(count, &run.covariance);
        let is_correlated = all.is_some();
        let covariance = if let Some(all) = all {
            let place = |p: &ParameterResult| run.parameters.iter().position(|of_run| of_run.name == p.name);
            let places = estimates.iter().map(place).collect::<Option<Vec<_>>>()?;
            Matrix::from_fn(n, n, |i, j| all.at(places[i], places[j]))
        } else {
            let deviations = estimates.iter().map(ParameterResult::deviation).collect::<Option<Vec<f64>>>()?;
            Matrix::from_fn(n, n, |i, j| if i == j { deviations[i] * deviations[i] } else { 0.0 })
        };
        let factor = CovarianceFactor::of(&covariance).and_then(|factor| {
            let whitening = factor.whitening()?;
            Some((factor, whitening))
        });
        Some(Self { covariance, is_correlated, factor })
    }

    /// The estimates with an error of this covariance, of independent standard normal numbers; `None` if it is singular.
    pub(super) fn drawn(&self, estimates: &[ParameterResult], normal: &[f64]) -> Option<Vec<f64>> {
        let (factor, _) = self.factor.as_ref()?;
        Some(estimates.iter().zip(factor.coloured(normal)).map(|(p, error)| p.estimate + error).collect())
    }

    /// `R` with `R^T R` the inverse of the covariance.
    pub(super) fn whitening(&self) -> Option<&Matrix> {
        self.factor.as_ref().map(|(_, whitening)| whitening)
    }
}
