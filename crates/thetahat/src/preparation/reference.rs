use super::{
    error::PreparationError,
    filtered::{FilteredRecording, STILL},
    recording::Recording,
    setup::Setup,
};
use crate::{
    results::ReferenceResult,
    series::Series,
    simulation::{Reference, SampledReference},
    trajectory::reconstruct,
};

/// The reference that a recording's simulations follow, and where it comes from.
#[derive(Debug, Clone)]
pub(crate) struct RecordedReference {
    pub(crate) reference: Reference,
    /// `recorded`, `planned`, `reconstructed` or `filtered`.
    pub(crate) origin: &'static str,
}

/// Origin of a reference that is the recorded motion behind the position filter.
pub(crate) const FILTERED: &str = "filtered";
/// Rms deviation of a joint's motion from reconstructed moves, relative to that from its mean, beyond which the motion is not
/// made of moves.
const BAD_FIT: f64 = 0.05;

impl Setup<'_> {
    /// The recorded or planned reference; without one, it is reconstructed from the motion as moves. A motion that is not made
    /// of moves is its own reference, behind the position filter.
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
        let found = reconstruct(&recording.position, &motion.dq, rate).ok();
        Ok(match found.filter(|found| fits(&found.rms_deviation, &motion.q)) {
            Some(found) => RecordedReference { reference: Reference::Moves(found.moves), origin: "reconstructed" },
            None => {
                let reference = Reference::Sampled(SampledReference::new(motion.q, rate));
                RecordedReference { reference, origin: FILTERED }
            }
        })
    }
}

/// Whether each joint's deviation from moves is small beside its motion.
fn fits(rms_deviation: &[f64], q: &Series) -> bool {
    rms_deviation.iter().enumerate().all(|(j, deviation)| {
        let channel = q.channel(j);
        let mean = channel.iter().sum::<f64>() / channel.len() as f64;
        let squares = channel.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        *deviation <= (BAD_FIT * (squares / channel.len() as f64).sqrt()).max(STILL)
    })
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
