use super::prepared::Prepared;
use crate::{
    base_parameters::BaseParameters,
    checks::{self, Companion, SignalSettings, Subject},
    dynamics::Model,
    preparation::{Basis, Case, FilteredRecording, PreparationError, Problem, Recording, Setup},
    results::RecordingFindings,
    robot::Robot,
    simulation::Reference,
};

/// The name under which findings of several recordings stand.
const TOGETHER: &str = "all recordings";

/// What the checks find in one recording.
pub(crate) fn examine(setup: Setup<'_>, prepared: &Prepared, problem: &Problem, held_back: bool) -> RecordingFindings {
    let Prepared { filtered, reference } = prepared;
    let recording = &filtered.recording;
    let is_planned = recording.planned.is_some();
    let reconstructed = reference.as_ref().filter(|r| matches!(r.reference, Reference::Moves(_)) && !is_planned);
    let deviation = reconstructed.map(|r| r.rms_deviation(filtered));
    // The checks see positions and torques alone: what multiplies another channel is left out of what they fit.
    let base = problem.estimated.filtered(|kept| !problem.model.takes_channel(kept));
    let subject = Subject {
        reference: recording.reference.as_ref(),
        reconstructed_deviation: deviation.as_deref(),
        controller: setup.settings.controller.as_ref(),
        ..subject_of(setup, filtered, &problem.model, &base)
    };
    RecordingFindings { recording: recording.name.clone(), held_back, findings: checks::examine(&subject) }
}

/// A recording with its signals as they are filtered, without reference and controller.
fn subject_of<'a>(
    setup: Setup<'a>,
    filtered: &'a FilteredRecording,
    model: &'a Model,
    base: &'a BaseParameters,
) -> Subject<'a> {
    let (recording, options) = (&filtered.recording, &setup.settings.signal);
    Subject {
        robot: setup.robot,
        model,
        base,
        sample_rate_hz: recording.sample_rate_hz,
        time_s: recording.time_stamps_s.as_deref(),
        position: &recording.position,
        geared: recording.geared,
        velocity: recording.velocity.as_ref(),
        torque: recording.torque.as_ref(),
        reference: None,
        reconstructed_deviation: None,
        left_out: &filtered.left_out,
        contradicting_times: recording.contradicting_times.as_ref().map(|(column, rate)| (column.as_str(), *rate)),
        added_signal: recording.added_signal.is_some(),
        signal: SignalSettings {
            filter_order: options.filter_order,
            cutoff_hz: options.cutoff_hz,
            decimation: options.decimation,
            window: filtered.window.clone(),
        },
        controller: None,
    }
}

/// What the checks find in the robot's description, under its name; none where that is nothing.
pub(crate) fn examine_robot(robot: &Robot) -> Option<RecordingFindings> {
    let findings = checks::examine_robot(robot);
    let recording = format!("robot {}", robot.name);
    (!findings.is_empty()).then_some(RecordingFindings { recording, held_back: false, findings })
}

/// What the checks find in recordings beside one another, with whether each is held back.
pub(super) fn compare(
    setup: Setup<'_>,
    recordings: &[(&FilteredRecording, bool)],
    (model, base): (&Model, &BaseParameters),
) -> Option<RecordingFindings> {
    let base = base.filtered(|kept| !model.takes_channel(kept));
    let mut companions = Vec::with_capacity(recordings.len());
    for &(filtered, held_back) in recordings {
        let subject = subject_of(setup, filtered, model, &base);
        companions.push(Companion { name: &filtered.recording.name, held_back, subject });
    }
    let findings = checks::compare(&companions);
    (!findings.is_empty()).then(|| RecordingFindings { recording: TOGETHER.to_owned(), held_back: false, findings })
}

/// What the checks find in recordings from which nothing is estimated, each with whether it is held back.
///
/// # Errors
/// [`PreparationError`] where one cannot be filtered or makes no regression. A motion that no reference describes is a
/// finding, and not the end of the checks.
pub(crate) fn check_recordings(
    setup: Setup<'_>,
    recordings: Vec<(Recording, bool)>,
) -> Result<Vec<RecordingFindings>, PreparationError> {
    let (mut findings, mut all) = (Vec::new(), Vec::new());
    for (recording, held_back) in recordings {
        let filtered = setup.filter(recording)?;
        let problem = setup.problem(&Case::nominal(), &[&filtered])?;
        let controller = setup.settings.controller.as_ref();
        let reference = controller.and_then(|_| setup.reference(&filtered.recording).ok());
        let prepared = Prepared { filtered, reference };
        findings.push(examine(setup, &prepared, &problem, held_back));
        all.push((prepared, held_back));
    }
    let filtered: Vec<_> = all.iter().map(|(prepared, held_back)| (&prepared.filtered, *held_back)).collect();
    let Basis { model, base } = setup.basis(&Case::nominal())?;
    findings.extend(compare(setup, &filtered, (&model, &base)));
    Ok(findings)
}
