use super::{
    identification::CaseProblem,
    parameters::parameter_results,
    prepared::{PreparedRecording, filtered},
    validation::uncertain,
};
use crate::preparation::{Case, FilteredRecording, PreparationError, Problem, Recording, Setup};
use thetahat_estimation::{
    checks::{self, Code, Companion, Finding, OrderedStep, RemedyStep, Severity, SignalSettings, Subject},
    identification::{Method, Needs},
    simulation::Reference,
};
use thetahat_model::{base_parameters::BaseParameters, dynamics::Model, robot::Robot};
use thetahat_report::results::RecordingFindings;

/// The name under which findings of several recordings stand.
const TOGETHER: &str = "all recordings";

/// The model by which recordings are examined, with its base parameters: those that are estimated, and all.
#[derive(Clone, Copy)]
pub(crate) struct ExaminationModel<'a> {
    pub(crate) model: &'a Model,
    pub(crate) estimated: &'a BaseParameters,
    pub(crate) base: &'a BaseParameters,
}

impl<'a> ExaminationModel<'a> {
    pub(super) fn of(problem: &'a Problem) -> Self {
        Self { model: &problem.model, estimated: &problem.estimated, base: &problem.base }
    }
}

/// What the checks find in one recording.
pub(crate) fn examine(
    setup: Setup<'_>,
    prepared: &PreparedRecording,
    ExaminationModel { model, estimated, base }: ExaminationModel<'_>,
    held_back: bool,
) -> RecordingFindings {
    let PreparedRecording { filtered, reference } = prepared;
    let recording = &filtered.recording;
    let is_planned = recording.planned.is_some();
    // What is simulated along a recording that is held back is no part of the estimate.
    let is_used = !is_planned && !held_back;
    let reconstructed = reference.as_ref().filter(|r| matches!(r.reference, Reference::Moves(_)) && is_used);
    let deviation = reconstructed.map(|r| r.rms_deviation(filtered));
    // The checks see positions and torques alone: what multiplies another channel is left out of what they fit.
    let [base, all] = [estimated, base].map(|base| base.filtered(|kept| !model.takes_channel(kept)));
    let subject = Subject {
        reference: recording.reference.as_ref(),
        reconstructed_deviation: deviation.as_deref(),
        controller: setup.settings.controller.as_ref(),
        ..subject_of(setup, filtered, model, (&base, &all))
    };
    let mut findings = checks::examine(&subject);
    findings.extend(equations_used(setup.robot, filtered));
    findings.extend(recording.position_unit_guessed.then(guessed_unit_of_position));
    findings.extend(recording.torque_unit_guessed.then(guessed_unit_of_torque));
    RecordingFindings { recording: recording.name.clone(), held_back, findings }
}

/// The warning of joints that hardly turn in the unit of the others.
fn guessed_unit_of_position() -> Finding {
    guessed_unit(
        Code::PositionScale,
        "the unit of joints that hardly turn in degrees is a guess: they may be in rad, and their parameters are then wrong by a factor",
        "state the unit of each joint in [recording] position, unit = [...], and leave unit_guessed out",
    )
}

/// The warning of a torque whose unit was taken from the masses of the description, or from nothing: all torques and masses depend on it.
fn guessed_unit_of_torque() -> Finding {
    guessed_unit(
        Code::TorqueScale,
        "the unit of the torque is a guess: all torques, and with them masses and friction, are wrong by a factor if it is another",
        "find the unit in the manual of the drive or the driver, then leave unit_guessed of torque out",
    )
}

fn guessed_unit(code: Code, message: &str, remedy: &str) -> Finding {
    Finding {
        code,
        severity: Severity::Warning,
        joint: None,
        joint_name: None,
        value: 0.0,
        unit: String::new(),
        limit: None,
        message: message.to_owned(),
        remedy: remedy.to_owned(),
        parameters: Vec::new(),
        step: None,
    }
}

/// The note of a base that floats: which equations are used, and when.
fn equations_used(robot: &Robot, filtered: &FilteredRecording) -> Option<Finding> {
    let base = robot.base_coordinates();
    if base == 0 {
        return None;
    }
    let left_out = filtered.unused.as_ref().map_or_else(|| vec![0.0; robot.coordinate_count()], |mask| mask.left_out());
    let used = |parts: &[f64]| 100.0 * (1.0 - parts.iter().sum::<f64>() / parts.len().max(1) as f64);
    let [of_base, of_joints] = [used(&left_out[..base]), used(&left_out[base..])];
    let reasons = &filtered.recording.notes_of_base;
    let why =
        if reasons.is_empty() { "what touches the robot was measured, or nothing does" } else { &reasons.join("; ") };
    Some(Finding {
        code: Code::EquationsUsed,
        severity: Severity::Note,
        joint: None,
        joint_name: None,
        value: of_base,
        unit: "% of the window".to_owned(),
        limit: None,
        message: format!(
            "the six equations of the base are used in {of_base:.0} % of the window, those of the joints in {of_joints:.0} %: {why}"
        ),
        remedy: "nothing to do; forces of contacts, torques, and times without contact give more equations".to_owned(),
        parameters: Vec::new(),
        step: None,
    })
}

/// A recording with its signals as they are filtered, without reference and controller.
fn subject_of<'a>(
    setup: Setup<'a>,
    filtered: &'a FilteredRecording,
    model: &'a Model,
    (base, all): (&'a BaseParameters, &'a BaseParameters),
) -> Subject<'a> {
    let (recording, options) = (&filtered.recording, &setup.settings.signal);
    Subject {
        robot: setup.robot,
        model,
        base,
        all,
        sample_rate_hz: recording.sample_rate_hz,
        time_s: recording.time_stamps_s.as_deref(),
        position: &recording.position,
        geared: recording.geared,
        velocity: recording.velocity.as_ref(),
        // Forces of contacts are added to these torques, and jump, and some rows are not used: the checks of torques expect neither.
        torque: recording.torque.as_ref().filter(|_| setup.robot.base_coordinates() == 0),
        reference: None,
        reconstructed_deviation: None,
        held_part_of_step: recording.held_part_of_step(),
        left_out: &filtered.left_out,
        rests_left_out: filtered.near_rest.is_some(),
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

/// What the checks find in the robot's description, under its name; none if that is nothing.
pub(crate) fn examine_robot(robot: &Robot) -> Option<RecordingFindings> {
    let findings = checks::examine_robot(robot);
    let recording = format!("robot {}", robot.name);
    (!findings.is_empty()).then_some(RecordingFindings { recording, held_back: false, findings })
}

/// What the checks find in recordings compared with one another: those to identify from, and those held back.
pub(crate) fn compare(
    setup: Setup<'_>,
    [main, held_back]: [&[PreparedRecording]; 2],
    (model, base): (&Model, &BaseParameters),
) -> Option<RecordingFindings> {
    let base = base.filtered(|kept| !model.takes_channel(kept));
    let all = main.iter().map(|p| (p, false)).chain(held_back.iter().map(|p| (p, true)));
    let mut companions = Vec::new();
    for (PreparedRecording { filtered, .. }, held_back) in all {
        let subject = subject_of(setup, filtered, model, (&base, &base));
        companions.push(Companion { name: &filtered.recording.name, held_back, subject });
    }
    let findings = checks::compare(&companions);
    (!findings.is_empty()).then(|| RecordingFindings { recording: TOGETHER.to_owned(), held_back: false, findings })
}

/// What the checks find in recordings from which nothing is estimated yet: those to identify from, and those held back.
///
/// # Errors
/// [`PreparationError`] where one cannot be filtered or makes no regression. A motion that no reference describes is a
/// finding, and not the end of the checks.
pub(crate) fn check_recordings(
    setup: Setup<'_>,
    main: Vec<Recording>,
    held_back: Vec<Recording>,
) -> Result<Vec<RecordingFindings>, PreparationError> {
    let settings = setup.settings.clone().with_cutoff_of(&main)?;
    let setup = Setup { settings: &settings, ..setup };
    let prepare = |recording: Recording| {
        let filtered = setup.filter(recording)?;
        let controller = setup.settings.controller.as_ref();
        let reference = controller.and_then(|_| setup.reference(&filtered.recording).ok());
        Ok(PreparedRecording { filtered, reference })
    };
    let prepare_all = |all: Vec<Recording>| all.into_iter().map(prepare).collect::<Result<Vec<_>, PreparationError>>();
    let (main, held_back) = (prepare_all(main)?, prepare_all(held_back)?);
    let problem = setup.problem(&Case::nominal(), &filtered(&main))?;
    let of = |prepared: &[PreparedRecording], held_back| -> Vec<RecordingFindings> {
        prepared.iter().map(|p| examine(setup, p, ExaminationModel::of(&problem), held_back)).collect()
    };
    let (found, of_others) = (of(&main, false), of(&held_back, true));
    let together = compare(setup, [&main, &held_back], (&problem.model, &problem.base));
    let weights: Vec<f64> = main.iter().map(|p| p.filtered.recording.weight).collect();
    let has_torques = main.iter().all(|p| p.filtered.recording.torque.is_some());
    let note = has_torques.then(|| note_before_estimates(setup, problem, &weights)).flatten();
    let all: Vec<RecordingFindings> = with_note(found, note).into_iter().chain(of_others).chain(together).collect();
    Ok(if has_torques { all } else { with_positions_explained(all) })
}

/// The note on the estimates of the method that needs the measured motion alone.
fn note_before_estimates(setup: Setup<'_>, problem: Problem, weights: &[f64]) -> Option<Finding> {
    let settings = setup.settings;
    let mut methods = settings.estimation.methods.iter().copied();
    let method = methods.find(|m| m.needs() == Needs::Measurement).unwrap_or(Method::IDIM_LS);
    let problem = CaseProblem::new(setup.robot.friction, problem);
    let weights = problem.weights(settings, method, weights);
    let regression = problem.problem.regression.with_weights(weights);
    let fit = method.estimate(&regression, None, settings.estimation.variance).ok()?;
    let parameters = parameter_results(settings, &problem.problem.estimated, &fit, None, None);
    uncertain::note(setup, &problem.problem, method, &parameters)
}

/// Positions are fitted as they were recorded: the noise of filtered accelerations reaches start values alone. A controller without
/// torques in its log is often soft: how late the motion is says nothing against the reference.
pub(super) fn with_positions_explained(mut findings: Vec<RecordingFindings>) -> Vec<RecordingFindings> {
    for finding in findings.iter_mut().flat_map(|of| &mut of.findings) {
        let is_correction = |of: &OrderedStep| matches!(of.step, RemedyStep::CorrectReference { .. });
        let corrects = finding.step.as_ref().is_none_or(is_correction);
        if [Code::CutoffHigh, Code::PositionQuantised].contains(&finding.code) {
            finding.severity = Severity::Note;
            finding.message += "; positions are fitted as recorded, without it";
            finding.remedy = "nothing to do: the filter makes only start values".to_owned();
        } else if finding.code == Code::ReferenceMismatch && corrects {
            finding.step = None;
            finding.remedy = "a soft controller is late, and that is no fault; where the simulated loop is not late as well, check the columns, \
                              units and signs of commands and positions"
                .to_owned();
        }
    }
    findings
}

/// The findings with a note on all recordings together: in the findings of the only recording, or separately.
pub(super) fn with_note(mut found: Vec<RecordingFindings>, note: Option<Finding>) -> Vec<RecordingFindings> {
    let Some(note) = note else { return found };
    match &mut found[..] {
        [only] => {
            only.findings.push(note);
            only.findings.sort_by_key(|f| (f.severity, f.code, f.joint));
        }
        _ => {
            let recording = "all recordings".to_owned();
            found.push(RecordingFindings { recording, held_back: false, findings: vec![note] });
        }
    }
    found
}
