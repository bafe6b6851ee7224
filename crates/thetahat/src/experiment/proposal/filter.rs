//! The filter of a proposal, chosen from its recordings.

use std::path::Path;

use super::text::{Proposal, ProposedSignal};
use crate::experiment::{description::Experiment, error::ExperimentError};

impl Proposal {
    /// The proposal with the filter that is best on a twin of its recordings, or the usual one with the reason why none was
    /// chosen. `robot_text` is the description of the robot, `data` the folder of the recordings.
    ///
    /// # Errors
    /// [`ExperimentError`] where the proposal itself is not an experiment, as of a robot that cannot be used.
    pub fn with_chosen_filter(self, robot_text: String, data: &Path, threads: usize) -> Result<Self, ExperimentError> {
        if self.control.as_ref().is_some_and(|control| control.to_fill_in().is_some()) {
            // Without gains it is no experiment yet.
            let signal = ProposedSignal::not_chosen(self.rate_hz(), "the gains of the controller are to be filled in");
            return Ok(Self { signal: signal.with_window(self.signal.window_s), ..self });
        }
        let experiment = Experiment::from_texts(Path::new("the proposed experiment"), self.text(), robot_text)?;
        let rate_hz = self.rate_hz();
        let signal = if self.control.is_some() {
            ProposedSignal::not_chosen(
                rate_hz,
                "it has no torques; of what is fitted, the positions, the filter takes nothing",
            )
        } else if !self.to_fill_in().is_empty() {
            ProposedSignal::not_chosen(rate_hz, "a gain is to be filled in; then `thetahat check` compares filters")
        } else {
            match experiment.choose_filter(data, None, threads) {
                Ok(choice) => ProposedSignal::chosen(&choice),
                Err(error) => ProposedSignal::not_chosen(rate_hz, &error.to_string()),
            }
        };
        Ok(Self { signal: signal.with_window(self.signal.window_s), ..self })
    }

    fn rate_hz(&self) -> f64 {
        self.recordings.first().map_or(0.0, |r| r.clock.rate_hz)
    }
}
