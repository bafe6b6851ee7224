//! The information of recordings, as prior information for the design of the next one.

use super::{ReductionError, compressed::Compressed, value::Reduction};
use thetahat_ground::linear_algebra::Matrix;

impl Reduction {
    /// `sum_j n / sd_j^2 X_j^T X_j`: the information of the rows on the base parameters, where a sample of joint j has white
    /// noise of the standard deviation `noise[j]` and the decimation leaves one row for each n samples.
    ///
    /// # Errors
    /// [`ReductionError`] where the experiment in the reduction cannot be used.
    pub fn information(&self, noise: &[f64]) -> Result<Matrix, ReductionError> {
        let experiment = self.experiment()?;
        let samples = experiment.settings.signal.decimation as f64;
        let regression = Compressed::whole(self).regression;
        let mut weights = vec![0.0; regression.y.len()];
        for block in regression.layout.blocks() {
            weights[block.rows.clone()].fill(samples.sqrt() / noise[block.joint]);
        }
        let weighted = regression.x.scale_rows(&weights);
        Ok(weighted.transposed_times(&weighted))
    }
}
