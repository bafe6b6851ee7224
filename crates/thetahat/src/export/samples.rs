//! Robots drawn from what the identification leaves open.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{
    error::ExportError,
    format::Format,
    identified::IdentifiedModel,
    render::{Export, export_robot},
};
use crate::linear_algebra::Matrix;

/// A robot that may be the identified one.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Its number, from one.
    pub number: u32,
    /// The seed of all samples.
    pub seed: u64,
    /// The base parameters that were drawn.
    pub drawn: Vec<f64>,
    /// Its standard parameters, physically consistent.
    pub standard: Vec<f64>,
}

impl IdentifiedModel {
    /// A physically consistent robot drawn from the estimates' distribution.
    ///
    /// The base parameters are drawn from the normal distribution about the estimates with their covariance. The standard
    /// parameters are the consistent ones with these base parameters that are nearest to the a-priori ones (log-det); where no
    /// consistent ones have them, those nearest to them in the metric of the covariance. A sample depends on its number and the
    /// seed alone.
    ///
    /// # Errors
    /// [`ExportError::NoDeviations`] where the results do not say how sure the estimates are.
    pub fn sample(&self, number: u32, seed: u64) -> Result<Sample, ExportError> {
        let posterior = &self.posterior;
        let factor = posterior.covariance.as_ref().and_then(factor_of);
        let factor = factor.ok_or(ExportError::NoDeviations { method: self.method })?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number.into());
        let normal: Vec<f64> = (0..factor.columns()).map(|_| StandardNormal.sample(&mut rng)).collect();
        let drawn: Vec<f64> = posterior.estimate.iter().zip(factor.times(&normal)).map(|(m, e)| m + e).collect();
        Ok(Sample { number, seed, standard: posterior.nearest(&drawn)?, drawn })
    }

    /// The base parameters that a sample has: those drawn, where they are consistent.
    #[must_use]
    pub fn base_parameters_of(&self, sample: &Sample) -> Vec<f64> {
        self.posterior.base.from_standard(&sample.standard)
    }

    /// The file of a sample.
    ///
    /// # Errors
    /// As [`export_robot`].
    pub fn export_sample(&self, sample: &Sample, format: Format) -> Result<Export, ExportError> {
        let about = [
            format!("sample {} of the estimates by {}, seed {}", sample.number, self.method, sample.seed),
            "base parameters drawn from the normal distribution about the estimates with their covariance; standard parameters: \
             the physically consistent ones with these, or nearest to these in the metric of the covariance"
                .to_owned(),
        ];
        export_robot(&self.robot, self.urdf_text(), &sample.standard, format, &about)
    }
}

/// L with `L L^T = C`.
fn factor_of(covariance: &Matrix) -> Option<Matrix> {
    let n = covariance.rows();
    let deviation: Vec<f64> = (0..n).map(|i| covariance.at(i, i).sqrt()).collect();
    if !deviation.iter().all(|d| d.is_finite() && *d > 0.0) {
        return None;
    }
    let correlation = Matrix::from_fn(n, n, |i, j| covariance.at(i, j) / (deviation[i] * deviation[j]));
    Some(correlation.cholesky()?.lower().scale_rows(&deviation))
}
