use crate::{
    preparation::{FilteredRecording, PreparationError, RecordedReference, Recording, Setup},
    results::RecordingResult,
};

/// A recording ready for every case: filtered, with its reference where a method or report needs one.
pub(crate) struct Prepared {
    pub(crate) filtered: FilteredRecording,
    pub(crate) reference: Option<RecordedReference>,
}

impl Prepared {
    /// Filters a recording, and finds its reference where simulations follow it.
    pub(crate) fn new(setup: Setup<'_>, recording: Recording, simulates: bool) -> Result<Self, PreparationError> {
        let filtered = setup.filter(recording)?;
        let reference = simulates.then(|| setup.reference(&filtered.recording)).transpose()?;
        Ok(Self { filtered, reference })
    }

    pub(super) fn describe(&self) -> RecordingResult {
        let recording = &self.filtered.recording;
        RecordingResult {
            name: recording.name.clone(),
            weight: recording.weight,
            samples_used: self.filtered.used_samples().count(),
            sample_rate_hz: recording.sample_rate_hz,
            window_s: self.filtered.window_s(),
            resampling: recording.resampling,
            torque_ends_hz: self.filtered.torque_ends_hz(),
            reference: self.reference.as_ref().map(|r| r.describe(&self.filtered)),
        }
    }
}

/// Their filtered recordings.
pub(super) fn filtered(prepared: &[Prepared]) -> Vec<&FilteredRecording> {
    prepared.iter().map(|p| &p.filtered).collect()
}
