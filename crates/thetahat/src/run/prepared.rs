use super::validation::cross_validation::Folds;
use crate::preparation::{
    FilteredRecording, FoundPeriod, PreparationError, Problem, RecordedReference, Recording, Setup,
};
use thetahat_estimation::{signal::Decimator, simulation::Reference};
use thetahat_report::results::{NearRestResult, PeriodicResult, RecordingResult, ReferenceResult};

/// A recording ready for every case: filtered, with its reference where a method or report needs one.
pub(crate) struct PreparedRecording {
    pub(crate) filtered: FilteredRecording,
    pub(crate) reference: Option<RecordedReference>,
}

impl PreparedRecording {
    /// Filters a recording, and finds its reference where simulations follow it.
    pub(crate) fn new(setup: Setup<'_>, recording: Recording, simulates: bool) -> Result<Self, PreparationError> {
        let filtered = setup.filter(recording)?;
        let reference = simulates.then(|| setup.reference(&filtered.recording)).transpose()?;
        Ok(Self { filtered, reference })
    }

    /// The same recording, whose simulations follow its motion whatever reference is recorded.
    pub(super) fn along_its_motion(&self, setup: Setup<'_>) -> Result<Self, PreparationError> {
        let filtered = self.filtered.clone();
        let reference = Some(setup.reference_of_motion(&filtered.recording)?);
        Ok(Self { filtered, reference })
    }

    /// What is left out in turn of this recording alone, where its rows are those of a decimator.
    pub(crate) fn folds(&self, decimator: &Decimator) -> Folds {
        let times: Vec<f64> = times_of(&self.filtered, decimator, 0.0).collect();
        Folds::of_one_recording(self.reference.as_ref().map(|r| &r.reference), &times)
    }

    /// The frequency of a reference that repeats.
    pub(crate) fn frequency_hz(&self) -> Option<f64> {
        frequency_hz(&self.reference.as_ref()?.reference)
    }

    pub(super) fn describe(&self, problem: &Problem) -> RecordingResult {
        let recording = &self.filtered.recording;
        RecordingResult {
            name: recording.name.clone(),
            weight: recording.weight,
            samples_used: self.filtered.used_samples().count(),
            sample_rate_hz: recording.sample_rate_hz,
            window_s: self.filtered.window_s(),
            resampling: recording.resampling,
            notes: recording.notes.clone(),
            torque_bandwidth_hz: self.filtered.torque_ends_hz(),
            torque_hold_s: recording.torque_hold_s,
            near_rest: near_rest(&self.filtered, problem),
            reference: self.reference.as_ref().map(|r| reference_result(r, &self.filtered)),
        }
    }
}

/// The frequency of a reference that repeats.
pub(crate) fn frequency_hz(reference: &Reference) -> Option<f64> {
    match reference {
        Reference::Periodic(periodic) => Some(periodic.series().base_frequency_hz()),
        Reference::Moves(_) | Reference::Sampled(_) => None,
    }
}

/// The reference of a recording, and how far the motion is from it.
fn reference_result(found: &RecordedReference, filtered: &FilteredRecording) -> ReferenceResult {
    let moves = match &found.reference {
        Reference::Moves(moves) => Some(moves.moves().len()),
        Reference::Sampled(_) | Reference::Periodic(_) => None,
    };
    ReferenceResult {
        origin: found.origin.to_owned(),
        moves,
        periodic: found.periodic.map(periodic_result),
        smoothing_cutoff_hz: found.smoothing_cutoff_hz,
        rms_deviation: found.rms_deviation(filtered),
    }
}

fn periodic_result(found: FoundPeriod) -> PeriodicResult {
    let FoundPeriod { base_frequency_hz, harmonics, degree, periods, stretch_s } = found;
    PeriodicResult { base_frequency_hz, harmonics, degree, periods, stretch_s }
}

/// The samples near rest that a recording leaves out.
fn near_rest(filtered: &FilteredRecording, problem: &Problem) -> Option<NearRestResult> {
    let mask = filtered.mask(&problem.model, &problem.base.columns())?;
    let rule = filtered.near_rest.as_ref()?;
    Some(NearRestResult {
        velocity: rule.velocity.clone(),
        widened_s: rule.widened as f64 / filtered.recording.sample_rate_hz,
        left_out_percent: mask.left_out().into_iter().map(|part| 100.0 * part).collect(),
    })
}

/// Their filtered recordings.
pub(super) fn filtered(prepared: &[PreparedRecording]) -> Vec<&FilteredRecording> {
    prepared.iter().map(|p| &p.filtered).collect()
}

/// The time of each row of a joint; the recordings follow one another.
pub(super) fn times(prepared: &[PreparedRecording], problem: &Problem) -> Vec<f64> {
    let mut times = Vec::new();
    let mut before_s = 0.0;
    for (PreparedRecording { filtered, .. }, decimator) in prepared.iter().zip(&problem.decimators) {
        times.extend(times_of(filtered, decimator, before_s));
        before_s += filtered.recording.position.len() as f64 / filtered.recording.sample_rate_hz;
    }
    times
}

/// The time of each row of a joint in one recording, which starts at `before_s`.
fn times_of<'a>(
    filtered: &'a FilteredRecording,
    decimator: &'a Decimator,
    before_s: f64,
) -> impl Iterator<Item = f64> + 'a {
    let rate = filtered.recording.sample_rate_hz;
    decimator.kept().map(move |k| before_s + filtered.start_s() + k as f64 / rate)
}
