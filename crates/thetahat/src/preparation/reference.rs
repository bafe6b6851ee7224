use super::{error::PreparationError, filtered::FilteredRecording, recording::Recording, setup::Setup};
use crate::{
    results::ReferenceResult,
    simulation::{Reference, SampledReference},
    trajectory::reconstruct,
};

/// The reference that a recording's simulations follow, and where it comes from.
#[derive(Debug, Clone)]
pub(crate) struct RecordedReference {
    pub(crate) reference: Reference,
    /// `recorded`, `planned` or `reconstructed`.
    pub(crate) origin: &'static str,
}

impl Setup<'_> {
    /// The recorded or planned reference; without one, it is reconstructed from the motion.
    pub(crate) fn reference(&self, recording: &Recording) -> Result<RecordedReference, PreparationError> {
        let rate = recording.sample_rate_hz;
        if let Some(recorded) = &recording.reference {
            let reference = Reference::Sampled(SampledReference::new(recorded.clone(), rate));
            return Ok(RecordedReference { reference, origin: "recorded" });
        }
        if let Some(planned) = &recording.planned {
            return Ok(RecordedReference { reference: Reference::Moves(planned.clone()), origin: "planned" });
        }
        let motion = self.band_pass(&recording.position, rate)?;
        let found = reconstruct(&recording.position, &motion.dq, rate)?;
        Ok(RecordedReference { reference: Reference::Moves(found.moves), origin: "reconstructed" })
    }
}

impl RecordedReference {
    /// What is told of the reference of a recording.
    pub(crate) fn describe(&self, filtered: &FilteredRecording) -> ReferenceResult {
        let moves = match &self.reference {
            Reference::Moves(moves) => Some(moves.moves().len()),
            Reference::Sampled(_) => None,
        };
        ReferenceResult { origin: self.origin.to_owned(), moves, rms_deviation: self.rms_deviation(filtered) }
    }

    /// Rms deviation, per joint, of the recorded positions from the reference in the window, rad or m.
    pub(crate) fn rms_deviation(&self, filtered: &FilteredRecording) -> Vec<f64> {
        let recording = &filtered.recording;
        let joints = recording.position.channels();
        let [mut q, mut dq, mut ddq] = [(); 3].map(|()| vec![0.0; joints]);
        let mut squares = vec![0.0; joints];
        for k in filtered.window.clone() {
            self.reference.evaluate(k as f64 / recording.sample_rate_hz, &mut q, &mut dq, &mut ddq);
            let measured = recording.position.sample(k);
            squares.iter_mut().zip(measured.iter().zip(&q)).for_each(|(s, (m, r))| *s += (m - r).powi(2));
        }
        squares.iter().map(|s| (s / filtered.window.len() as f64).sqrt()).collect()
    }
}
