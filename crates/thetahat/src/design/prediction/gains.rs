//! Predicted intervals of the drive gains, from a recording with a known payload and one without it.

use std::path::Path;

use crate::design::{
    error::DesignError,
    prediction::expected::{ExpectedRecording, RECORDINGS},
};
use crate::preparation::{PreparationError, Recording};
use thetahat_estimation::simulation::random_numbers;
use thetahat_ground::pool::in_parallel;
use thetahat_report::results::{DriveGainResult, PredictedGain};

impl ExpectedRecording<'_> {
    /// Half width of the interval of each drive's gain, the mean over twelve pairs of noisy recordings: this one, which carries a payload,
    /// and one without it.
    pub(in crate::design) fn gains(
        &self,
        unloaded: &Self,
        path: &Path,
        seed: u64,
        threads: usize,
    ) -> Result<Vec<PredictedGain>, DesignError> {
        let pairs = in_parallel(RECORDINGS, threads, |number| self.gains_of_pair(unloaded, seed, number as u64));
        let pairs = pairs.into_iter().collect::<Result<Vec<_>, _>>();
        let pairs = pairs.map_err(|source| DesignError::Preparation { path: path.to_owned(), source })?;
        let gain = |(joint, coordinate): (usize, &thetahat_model::robot::Joint)| PredictedGain {
            joint: coordinate.name.clone(),
            half_width_percent: pairs
                .iter()
                .map(|pair| half_width_percent(&pair[joint]))
                .sum::<Option<f64>>()
                .map(mean),
        };
        Ok(self.robot.coordinates().enumerate().map(gain).collect())
    }

    fn gains_of_pair(&self, unloaded: &Self, seed: u64, number: u64) -> Result<Vec<DriveGainResult>, PreparationError> {
        let mut rng = random_numbers(seed, number);
        let loaded = self.recording(&mut rng);
        let without = Recording { payload: None, ..unloaded.recording(&mut rng) };
        let identification = self.identification(vec![without, loaded])?;
        let problems = identification.problems(&mut |_| {})?;
        identification.drive_gains(&problems[0].problem)
    }
}

fn mean(sum: f64) -> f64 {
    sum / RECORDINGS as f64
}

/// Half width of the interval of a gain in percent of the gain; `None` if the gain is not identifiable.
fn half_width_percent(gain: &DriveGainResult) -> Option<f64> {
    let ([low, high], factor) = (gain.interval_95?, gain.factor?);
    Some(50.0 * (high - low) / factor)
}
