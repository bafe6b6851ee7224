use super::prepared::Prepared;
use crate::{
    checks::{self, SignalSettings, Subject},
    preparation::{Case, PreparationError, Problem, Recording, Setup},
    results::RecordingFindings,
    robot::Robot,
    simulation::Reference,
};

/// What the checks find in one recording.
pub(crate) fn examine(setup: Setup<'_>, prepared: &Prepared, problem: &Problem, held_back: bool) -> RecordingFindings {
    let Prepared { filtered, reference } = prepared;
    let (recording, options) = (&filtered.recording, &setup.settings.signal);
    let is_planned = recording.planned.is_some();
    let reconstructed = reference.as_ref().filter(|r| matches!(r.reference, Reference::Moves(_)) && !is_planned);
    let deviation = reconstructed.map(|r| r.rms_deviation(filtered));
    // The checks see positions and torques alone: what multiplies another channel is left out of what they fit.
    let base = problem.estimated.filtered(|kept| !problem.model.takes_channel(kept));
    let subject = Subject {
        robot: setup.robot,
        model: &problem.model,
        base: &base,
        sample_rate_hz: recording.sample_rate_hz,
        time_s: recording.time_stamps_s.as_deref(),
        position: &recording.position,
        geared: recording.geared,
        velocity: recording.velocity.as_ref(),
        torque: recording.torque.as_ref(),
        reference: recording.reference.as_ref(),
        reconstructed_deviation: deviation.as_deref(),
        added_signal: recording.added_signal.is_some(),
        signal: SignalSettings {
            filter_order: options.filter_order,
            cutoff_hz: options.cutoff_hz,
            decimation: options.decimation,
            window: filtered.window.clone(),
        },
        controller: setup.settings.controller.as_ref(),
    };
    RecordingFindings { recording: recording.name.clone(), held_back, findings: checks::examine(&subject) }
}

/// What the checks find in the robot's description, under its name; none where that is nothing.
pub(crate) fn examine_robot(robot: &Robot) -> Option<RecordingFindings> {
    let findings = checks::examine_robot(robot);
    let recording = format!("robot {}", robot.name);
    (!findings.is_empty()).then_some(RecordingFindings { recording, held_back: false, findings })
}

/// What the checks find in a recording from which nothing is estimated.
///
/// # Errors
/// [`PreparationError`] where it cannot be filtered or makes no regression. A motion that no reference describes is a
/// finding, and not the end of the checks.
pub(crate) fn check_recording(
    setup: Setup<'_>,
    recording: Recording,
    held_back: bool,
) -> Result<RecordingFindings, PreparationError> {
    let filtered = setup.filter(recording)?;
    let problem = setup.problem(&Case::nominal(), &[&filtered])?;
    let controller = setup.settings.controller.as_ref();
    let reference = controller.and_then(|_| setup.reference(&filtered.recording).ok());
    Ok(examine(setup, &Prepared { filtered, reference }, &problem, held_back))
}
