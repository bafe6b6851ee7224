//! Robots drawn from what the identification leaves open.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{
    error::ExportError,
    identified::IdentifiedModel,
    pd_loop::PdLoop,
    render::{Export, Target, export_with_loop},
};
use thetahat_ground::pool::in_order;

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
    /// [`ExportError::NoDeviations`] where the results do not say how sure the estimates are, and
    /// [`ExportError::SingularCovariance`].
    pub fn sample(&self, number: u32, seed: u64) -> Result<Sample, ExportError> {
        let posterior = &self.posterior;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number.into());
        let normal: Vec<f64> = (0..posterior.base.len()).map(|_| StandardNormal.sample(&mut rng)).collect();
        let drawn = posterior.drawn(&normal)?;
        Ok(Sample { number, seed, standard: posterior.nearest(&drawn)?, drawn })
    }

    /// The base parameters that a sample has: those drawn, where they are consistent.
    #[must_use]
    pub fn base_parameters_of(&self, sample: &Sample) -> Vec<f64> {
        self.posterior.base.from_standard(&sample.standard)
    }

    /// The files of samples 1 to `count`, made on `threads` threads and handed over in the order of their numbers.
    ///
    /// # Errors
    /// As [`IdentifiedModel::sample`] and [`export_robot`](super::export_robot), and what `take` returns.
    pub fn export_samples<E: From<ExportError>>(
        &self,
        count: u32,
        seed: u64,
        target: Target<'_>,
        threads: usize,
        mut take: impl FnMut(u32, Export) -> Result<(), E>,
    ) -> Result<(), E> {
        let made = |number| self.export_sample(&self.sample(number, seed)?, target);
        // Samples have numbers of 32 bits.
        let number = |k: usize| k as u32 + 1;
        in_order(count as usize, threads, |k| made(number(k)), |k, export| take(number(k), export?))
    }

    /// The file of a sample.
    ///
    /// # Errors
    /// As [`export_robot`](super::export_robot).
    pub fn export_sample<'t>(&self, sample: &Sample, target: impl Into<Target<'t>>) -> Result<Export, ExportError> {
        let drawn = [
            format!("sample {} of the estimates, seed {}", sample.number, sample.seed),
            "base parameters drawn from the normal distribution about the estimates with their covariance; standard parameters: \
             the physically consistent ones with these, or nearest to these in the metric of the covariance"
                .to_owned(),
        ];
        let about = [vec![self.identified.origin()], drawn.into(), self.provenance_in_words()].concat();
        let Self { identified, .. } = self;
        let pd = PdLoop::of(identified);
        let urdf = identified.urdf_text();
        export_with_loop(&identified.robot, urdf, &sample.standard, target.into(), &about, pd.as_ref())
    }
}
