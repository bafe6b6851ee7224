//! Parts of an experiment that are reduced by themselves: one of its recordings, or a stretch of its time.

use std::path::Path;

use super::{error::ReductionError, source::Source};
use crate::{
    experiment::{Experiment, RecordingDescription},
    preparation::{MotionOfRecording, PreparationError, window_of},
};

impl Experiment {
    /// The start and end, s, of what [`Experiment::reduce`] may read of each recording: its stated window, or the whole recording without
    /// the edges of the filter; of a twin none, since it is not simulated here.
    ///
    /// Of a text the line ends are counted, of other files the header says the length.
    ///
    /// # Errors
    /// [`ReductionError`] for recordings that cannot be read.
    pub fn recording_spans_s(&self, data: &Path) -> Result<Vec<[f64; 2]>, ReductionError> {
        let span = |(i, description): (usize, &RecordingDescription)| {
            let source = Source::open(self, description, (i + 1, data), false)?;
            let signal = self.settings.signal.in_window([description.window_start_s, description.window_end_s]);
            let rate = source.sample_rate_hz;
            // Whether it moves at its ends is seen when it is reduced.
            let (moving, samples) = (0..source.samples, source.samples);
            let motion = MotionOfRecording { moving, accelerates_at: [false; 2], samples };
            let window = window_of(motion, rate, &signal).map_err(|e| self.refuse(e))?;
            Ok([window.start as f64 / rate, window.end as f64 / rate])
        };
        self.file.recording.iter().enumerate().map(span).collect()
    }

    /// The same experiment with recording `number` alone, from zero, and of that, where it is given, the time from and to, s. It keeps
    /// its text, so that reductions of its parts merge to one that is solved as the whole.
    ///
    /// A stretch of time is filtered as a part of the whole recording, and decimated as a recording of its own; the velocity below which its
    /// joints are near rest is its own.
    ///
    /// # Errors
    /// [`ReductionError`] where there is no such recording, and for a stretch of a twin, whose length is known only when it is simulated.
    pub fn part(&self, number: usize, window_s: Option<[f64; 2]>) -> Result<Self, ReductionError> {
        if self.file.recording.is_empty() && number == 0 {
            PreparationError::require(window_s.is_none(), "stretch of time", "one of a recording", "one of a twin")
                .map_err(|e| self.refuse(e))?;
            return Ok(self.clone());
        }
        let Some(described) = self.file.recording.get(number) else {
            let expected = format!("at least {}", number + 1);
            let count = self.file.recording.len();
            return Err(self.refuse(PreparationError::value("number of recordings", &expected, count)).into());
        };
        let mut recording = described.clone();
        let name = recording.name.take().unwrap_or_else(|| (number + 1).to_string());
        recording.name = Some(window_s.map_or(name.clone(), |[start, end]| format!("{name}, {start} to {end} s")));
        if let Some([start, end]) = window_s {
            (recording.window_start_s, recording.window_end_s) = (Some(start), Some(end));
        }
        let mut part = self.clone();
        part.file.recording = vec![recording];
        Ok(part)
    }
}
