//! The remedies of results: one for each finding, or cause that the model names, whose remedy is a setting.

use super::{
    candidate::{Candidate, is_of_recording, moves_position},
    causes::{of_causes, of_robot},
    chains::{chained, together},
    estimated::estimated_size,
    label::label,
    steps::Draft,
};
use crate::experiment::description::{Experiment, ExperimentFile, RecordingDescription};
use thetahat_estimation::checks::{Code, Finding, Severity};
use thetahat_model::robot::Robot;
use thetahat_report::results::{
    CauseKind, ModelCause, RecordingFindings, RecordingStep, Remedy, RemedyStep, Results, VerdictReason,
};

/// Enters the remedies of the results, and their codes into the reasons of the verdict.
pub(in crate::experiment) fn enter(experiment: &Experiment, results: &mut Results) {
    let is_late = results
        .verdict_reasons
        .iter()
        .any(|r| r.subject.cause == Some(CauseKind::LateTorque) && r.subject.joint.is_none());
    let causes: &[ModelCause] = results.model.as_ref().map_or(&[], |model| &model.causes);
    results.remedies = remedies(experiment, &results.findings, causes, is_late);
    for reason in &mut results.verdict_reasons {
        let codes = results.remedies.iter().filter(|remedy| is_of(remedy, reason)).map(|remedy| remedy.code.clone());
        reason.remedies = codes.collect();
    }
}

fn is_of(remedy: &Remedy, reason: &VerdictReason) -> bool {
    let of_finding = reason.subject.finding.is_some_and(|f| remedy.finding == Some(f) || remedy.also.contains(&f));
    // The delay that the model shows is the lag that the checks measure.
    let cause = remedy.cause.or((remedy.finding == Some(Code::Lag)).then_some(CauseKind::LateTorque));
    of_finding || (cause.is_some() && cause == reason.subject.cause)
}

impl Experiment {
    /// The remedies of findings of [`Experiment::check`], before anything is estimated.
    #[doc(hidden)]
    #[must_use]
    pub fn remedies_of(&self, findings: &[RecordingFindings]) -> Vec<Remedy> {
        remedies(self, findings, &[], false)
    }
}

/// The remedies of findings and of causes that the model names; `is_late` where the verdict says that the torques are late.
fn remedies(
    experiment: &Experiment,
    findings: &[RecordingFindings],
    causes: &[ModelCause],
    is_late: bool,
) -> Vec<Remedy> {
    let robot = &experiment.robot;
    let mut all: Vec<Candidate> = Vec::new();
    for recording in findings {
        let found = together(of_recording(experiment, recording, is_late), robot);
        all.extend(chained(found, robot.coordinate_count()));
    }
    let used = findings.iter().filter(|r| !r.held_back && is_recording(&experiment.file, r)).count();
    // A joint that one recording does not move, another may.
    let count = |code: &str| all.iter().filter(|candidate| candidate.code == code).count();
    let is_lock = |candidate: &&Candidate| matches!(candidate.step.step, RemedyStep::LockJoint { .. });
    let moved = all.iter().filter(is_lock).map(|candidate| candidate.code.clone()).filter(|code| count(code) != used);
    let moved: Vec<String> = moved.collect();
    all.retain(|candidate| !moved.contains(&candidate.code));
    // What the checks correct already the model does not correct again, and of wrong data it has no causes.
    let known: Vec<String> = all.iter().map(|candidate| candidate.code.clone()).collect();
    let is_wrong = findings.iter().flat_map(|r| &r.findings).any(|f| f.severity == Severity::Problem);
    let causes = if is_wrong { Vec::new() } else { of_causes(experiment, causes) };
    all.extend(causes.into_iter().filter(|candidate| !known.contains(&candidate.code)));
    let mut codes: Vec<String> = Vec::new();
    for candidate in &all {
        if !codes.contains(&candidate.code) {
            codes.push(candidate.code.clone());
        }
    }
    codes.iter().filter_map(|code| remedy(experiment, code, &all)).collect()
}

fn is_recording(file: &ExperimentFile, recording: &RecordingFindings) -> bool {
    file.twin.is_some() || description(file, recording).is_some()
}

fn description<'f>(file: &'f ExperimentFile, recording: &RecordingFindings) -> Option<&'f RecordingDescription> {
    let all = if recording.held_back { &file.validation } else { &file.recording };
    let named = |(i, d): &(usize, &RecordingDescription)| {
        d.name.as_ref().map_or_else(|| (i + 1).to_string() == recording.recording, |name| *name == recording.recording)
    };
    all.iter().enumerate().find(named).map(|(_, description)| description)
}

/// The candidates of a recording, in the order in which they were found.
fn of_recording(experiment: &Experiment, recording: &RecordingFindings, is_late: bool) -> Vec<Candidate> {
    let description = description(&experiment.file, recording);
    let has = |code: Code| recording.findings.iter().any(|f| f.code == code && f.severity < Severity::Note);
    let with_reference = description.is_some_and(|d| d.reference.is_some()) && !has(Code::ReferenceMismatch);
    let with_velocity = description.is_some_and(|d| d.velocity.is_some()) && !has(Code::VelocityMismatch);
    // Corrections that leave a poor fit are not the cause, or not all of it.
    let is_poor = recording.findings.iter().any(|f| f.code == Code::PoorFit && f.joint.is_none());
    // Steps of the position ask for a lower cut-off where the fit asks for a higher one.
    let is_coarse = has(Code::PositionQuantised) || has(Code::CutoffHigh);
    let matters = |f: &&Finding| {
        let is_doubtful = (is_poor && is_correction(f.code)) || (is_coarse && f.code == Code::CutoffLow);
        let is_said = f.code == Code::NotExcited || (f.code == Code::Lag && is_late);
        (f.severity < Severity::Note || is_said) && !is_doubtful
    };
    let mut found: Vec<(usize, Candidate)> = Vec::new();
    for finding in recording.findings.iter().filter(matters) {
        let Some(ordered) = &finding.step else { continue };
        let is_of_recording = is_of_recording(&ordered.step);
        if !is_of_recording && recording.held_back {
            continue;
        }
        let step = RecordingStep {
            recording: is_of_recording.then(|| recording.recording.clone()),
            held_back: recording.held_back,
            with_reference: is_of_recording && with_reference && moves_position(&ordered.step),
            with_velocity: is_of_recording && with_velocity && moves_position(&ordered.step),
            step: ordered.step.clone(),
        };
        let coordinate = finding.joint.and_then(|joint| experiment.robot.coordinate_of_number(joint));
        let code = code_of(finding, &experiment.robot);
        if found.iter().any(|(_, other)| other.code == code && other.step == step) {
            continue;
        }
        let candidate = Candidate {
            code,
            coordinate,
            found: finding.message.clone(),
            finding: Some(finding.code),
            also: Vec::new(),
            cause: None,
            step,
            before: Vec::new(),
        };
        found.push((ordered.order, candidate));
    }
    found.sort_by_key(|(order, _)| *order);
    let all = found.into_iter().map(|(_, candidate)| candidate).collect();
    numbered(up_to_side(all))
}

/// The candidates without corrections after that of a side.
fn up_to_side(mut all: Vec<Candidate>) -> Vec<Candidate> {
    // The checks correct a side by ratios, without the couplings and signs of the transmission: what they find then may be of these.
    let side = all.iter().position(|candidate| matches!(candidate.step.step, RemedyStep::Side { .. }));
    let later = side.map(|side| all.split_off(side + 1)).unwrap_or_default();
    all.extend(later.into_iter().filter(|candidate| !candidate.finding.is_some_and(is_correction)));
    all
}

/// The candidates with a code for each.
fn numbered(mut all: Vec<Candidate>) -> Vec<Candidate> {
    for i in 0..all.len() {
        let same = all[..i].iter().filter(|other| other.code == all[i].code).count();
        if same > 0 {
            all[i].code = format!("{}-again{}", all[i].code, if same > 1 { same.to_string() } else { String::new() });
        }
    }
    all
}

/// Whether a finding is the correction of the channels that makes the fit better.
fn is_correction(code: Code) -> bool {
    matches!(
        code,
        Code::PositionScale
            | Code::PositionSign
            | Code::TorqueScale
            | Code::TorqueSign
            | Code::JointsSwapped
            | Code::GearRatio
    )
}

/// The code of a finding, with the joints that it is about.
fn code_of(finding: &Finding, robot: &Robot) -> String {
    let code = finding.code.name();
    match (finding.step.as_ref().map(|ordered| &ordered.step), finding.joint) {
        (Some(step @ RemedyStep::OrderJoints { .. }), _) => match step.moved_joints()[..] {
            [a, b] => {
                let [a, b] = [a, b].map(|coordinate| robot.joint_of(coordinate - 1) + 1);
                format!("{code}-{a}-{b}")
            }
            _ => code.to_owned(),
        },
        (Some(RemedyStep::CorrectReference { .. }), _) | (_, None) => code.to_owned(),
        (_, Some(joint)) => format!("{code}-{joint}"),
    }
}

/// The remedy with a code; none if the file has no place for it.
fn remedy(experiment: &Experiment, code: &str, all: &[Candidate]) -> Option<Remedy> {
    let own = || all.iter().filter(|candidate| candidate.code == code);
    let first = own().next()?;
    let mut steps: Vec<RecordingStep> =
        own().flat_map(|candidate| candidate.before.iter().chain([&candidate.step]).cloned()).collect();
    steps.dedup();
    if matches!(first.step.step, RemedyStep::LockJoint { .. } | RemedyStep::Gravity { .. }) {
        steps.truncate(1);
    }
    let size = estimated_size(first, &experiment.robot).map(|size| size.to_string());
    steps.extend(size.map(|size| of_robot(RemedyStep::Estimated { size })));
    let mut draft = Draft::of(experiment);
    steps.iter().try_for_each(|step| draft.make(step))?;
    let chain = first.before.iter().chain([&first.step]);
    let labels: Vec<String> = chain.map(|step| label(&step.step, &draft.changes, &experiment.robot)).collect();
    let label = labels.join("; ");
    Some(Remedy {
        code: code.to_owned(),
        label,
        found: first.found.clone(),
        finding: first.finding,
        also: first.also.clone(),
        cause: first.cause,
        changes: draft.changes,
        steps,
    })
}
