//! The remedies of results: one for each finding, or cause that the model names, whose remedy is a setting.

use super::{label::label, steps::Draft};
use crate::experiment::description::{Experiment, ExperimentFile, RecordingDescription};
use thetahat_estimation::checks::{Code, Finding, Severity};
use thetahat_model::robot::Robot;
use thetahat_report::results::{
    CauseKind, ModelCause, ReasonCode, RecordingFindings, RecordingStep, Remedy, RemedyStep, Results, VerdictReason,
};

/// A step with the code under which it is asked for.
#[derive(Debug, Clone)]
struct Candidate {
    code: String,
    /// The joint of the finding, by its coordinate from zero.
    coordinate: Option<usize>,
    found: String,
    finding: Option<Code>,
    /// Findings of earlier links of its chain.
    also: Vec<Code>,
    cause: Option<CauseKind>,
    step: RecordingStep,
    /// Steps before it, which it holds after.
    before: Vec<RecordingStep>,
}

/// Enters the remedies of the results, and their codes into the reasons of the verdict.
pub(in crate::experiment) fn enter(experiment: &Experiment, results: &mut Results) {
    let is_late = results
        .verdict_reasons
        .iter()
        .any(|r| r.code == ReasonCode::Cause && r.text.contains(CauseKind::LateTorque.words()));
    let causes: &[ModelCause] = results.model.as_ref().map_or(&[], |model| &model.causes);
    results.remedies = remedies(experiment, &results.findings, causes, is_late);
    for reason in &mut results.verdict_reasons {
        let codes = results.remedies.iter().filter(|remedy| is_of(remedy, reason)).map(|remedy| remedy.code.clone());
        reason.remedies = codes.collect();
    }
}

fn is_of(remedy: &Remedy, reason: &VerdictReason) -> bool {
    let of_finding = reason.subject.finding.is_some_and(|f| remedy.finding == Some(f) || remedy.also.contains(&f));
    let of_cause = |cause: CauseKind| reason.code == ReasonCode::Cause && reason.text.contains(cause.words());
    // The delay that the model shows is the lag that the checks measure.
    let cause = remedy.cause.or((remedy.finding == Some(Code::Lag)).then_some(CauseKind::LateTorque));
    of_finding || cause.is_some_and(of_cause)
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
    let in_all = |code: &str| all.iter().filter(|candidate| candidate.code == code).count() == used;
    let is_kept =
        |candidate: &Candidate| !matches!(candidate.step.step, RemedyStep::LockJoint { .. }) || in_all(&candidate.code);
    let mut is_kept = all.iter().map(is_kept).collect::<Vec<bool>>().into_iter();
    all.retain(|_| is_kept.next().unwrap_or(true));
    all.extend(of_causes(experiment, causes));
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
        let coordinate = finding.joint.and_then(|joint| {
            (0..experiment.robot.coordinate_count()).find(|&c| experiment.robot.joint_of(c) + 1 == joint)
        });
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
    let mut all: Vec<Candidate> = found.into_iter().map(|(_, candidate)| candidate).collect();
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

/// Whether a step changes the description of a recording.
fn is_of_recording(step: &RemedyStep) -> bool {
    match step {
        RemedyStep::ExchangeJoints { .. }
        | RemedyStep::Scale { .. }
        | RemedyStep::Side { .. }
        | RemedyStep::Delay { .. }
        | RemedyStep::Hold
        | RemedyStep::EqualSteps { .. }
        | RemedyStep::CorrectReference { .. } => true,
        RemedyStep::Cutoff { .. }
        | RemedyStep::LeaveOutRests
        | RemedyStep::Essential { .. }
        | RemedyStep::LockJoint { .. }
        | RemedyStep::AddTerm { .. } => false,
    }
}

fn moves_position(step: &RemedyStep) -> bool {
    match step {
        RemedyStep::ExchangeJoints { signal, .. } | RemedyStep::Side { signal, .. } => signal.has_position(),
        RemedyStep::Scale { position, .. } => !position.is_empty(),
        RemedyStep::Delay { .. }
        | RemedyStep::Hold
        | RemedyStep::EqualSteps { .. }
        | RemedyStep::CorrectReference { .. }
        | RemedyStep::Cutoff { .. }
        | RemedyStep::LeaveOutRests
        | RemedyStep::Essential { .. }
        | RemedyStep::LockJoint { .. }
        | RemedyStep::AddTerm { .. } => false,
    }
}

/// The code of a finding, with the joints that it is about.
fn code_of(finding: &Finding, robot: &Robot) -> String {
    let code = finding.code.name();
    match (finding.step.as_ref().map(|ordered| &ordered.step), finding.joint) {
        (Some(RemedyStep::ExchangeJoints { joints: [a, b], .. }), _) => {
            let [a, b] = [a, b].map(|coordinate| robot.joint_of(coordinate.saturating_sub(1)) + 1);
            format!("{code}-{a}-{b}")
        }
        (Some(RemedyStep::CorrectReference { .. }), _) | (_, None) => code.to_owned(),
        (_, Some(joint)) => format!("{code}-{joint}"),
    }
}

/// Factors of every joint become one remedy: all torques with the opposite sign, or all positions in degrees.
fn together(candidates: Vec<Candidate>, robot: &Robot) -> Vec<Candidate> {
    let n = robot.coordinate_count();
    let mut all: Vec<Candidate> = Vec::new();
    for candidate in &candidates {
        let group: Vec<&Candidate> = candidates.iter().filter(|other| candidate.has_factors_with(other)).collect();
        let is_at = |coordinate: usize| group.iter().any(|other| other.coordinate == Some(coordinate));
        if n < 2 || group.len() != n || !(0..n).all(is_at) {
            all.push(candidate.clone());
        } else if std::ptr::eq(group[0], candidate) {
            all.push(group[1..].iter().fold(candidate.clone(), |all, other| all.and(other)).of_all());
        }
    }
    all
}

impl Candidate {
    /// Whether both have the same finding, of one joint, and factors of the same signals.
    fn has_factors_with(&self, other: &Self) -> bool {
        let signals = |candidate: &Self| match &candidate.step.step {
            RemedyStep::Scale { position, torque } => Some((position.is_empty(), torque.is_empty())),
            _ => None,
        };
        let own = signals(self).filter(|_| self.coordinate.is_some() && other.coordinate.is_some());
        self.finding == other.finding && own.is_some() && own == signals(other)
    }

    /// With the factors of another one in addition.
    fn and(mut self, other: &Self) -> Self {
        if let (RemedyStep::Scale { position, torque }, RemedyStep::Scale { position: p, torque: t }) =
            (&mut self.step.step, &other.step.step)
        {
            position.iter_mut().zip(p).for_each(|(own, factor)| *own *= factor);
            torque.iter_mut().zip(t).for_each(|(own, factor)| *own *= factor);
        }
        self
    }

    fn of_all(self) -> Self {
        let code = self.finding.map_or(self.code, |finding| finding.name().to_owned());
        Self { code, coordinate: None, found: format!("at every joint: {}", self.found), ..self }
    }
}

/// Corrections of the same joints are links of a chain, each found in the recording that the earlier ones have corrected: they become one
/// remedy. A torque with the other sign, and then torque and position of that joint, is a position with the other sign.
fn chained(candidates: Vec<Candidate>, n: usize) -> Vec<Candidate> {
    let mut all: Vec<Candidate> = Vec::new();
    for candidate in candidates {
        let joints = joints_of(&candidate.step.step, n);
        let shares = |other: &Candidate| {
            let steps = other.before.iter().chain([&other.step]);
            steps.flat_map(|step| joints_of(&step.step, n)).any(|joint| joints.contains(&joint))
        };
        match all.iter().position(shares) {
            Some(place) => {
                let earlier = all.remove(place);
                all.push(candidate.after(earlier));
            }
            None => all.push(candidate),
        }
    }
    all
}

/// The joints whose channels a step corrects one by one, from one; empty where it corrects all alike.
fn joints_of(step: &RemedyStep, n: usize) -> Vec<usize> {
    match step {
        RemedyStep::ExchangeJoints { joints, .. } => joints.to_vec(),
        RemedyStep::Scale { position, torque } => {
            let is_scaled = |k: usize| [position, torque].iter().any(|f| f.get(k - 1).is_some_and(|f| *f != 1.0));
            let joints: Vec<usize> = (1..=n).filter(|k| is_scaled(*k)).collect();
            if n > 1 && joints.len() == n { Vec::new() } else { joints }
        }
        RemedyStep::Side { .. }
        | RemedyStep::Delay { .. }
        | RemedyStep::Hold
        | RemedyStep::EqualSteps { .. }
        | RemedyStep::CorrectReference { .. }
        | RemedyStep::Cutoff { .. }
        | RemedyStep::LeaveOutRests
        | RemedyStep::Essential { .. }
        | RemedyStep::LockJoint { .. }
        | RemedyStep::AddTerm { .. } => Vec::new(),
    }
}

/// Factors one after the other; none if one of the steps has another form.
fn product(first: &RemedyStep, second: &RemedyStep) -> Option<RemedyStep> {
    let (RemedyStep::Scale { position, torque }, RemedyStep::Scale { position: p, torque: t }) = (first, second) else {
        return None;
    };
    let times = |a: &[f64], b: &[f64]| -> Vec<f64> {
        let n = a.len().max(b.len());
        let of = |factors: &[f64], j: usize| factors.get(j).copied().unwrap_or(1.0);
        let both: Vec<f64> = (0..n).map(|j| of(a, j) * of(b, j)).collect();
        if both.iter().all(|factor| *factor == 1.0) { Vec::new() } else { both }
    };
    Some(RemedyStep::Scale { position: times(position, p), torque: times(torque, t) })
}

impl Candidate {
    /// The candidate as the last link of a chain.
    fn after(mut self, earlier: Self) -> Self {
        self.also = earlier.also.into_iter().chain(earlier.finding).collect();
        self.before = earlier.before;
        match product(&earlier.step.step, &self.step.step) {
            Some(step) => {
                self.step.with_reference |= earlier.step.with_reference;
                self.step.with_velocity |= earlier.step.with_velocity;
                self.step.step = step;
            }
            None => self.before.push(earlier.step),
        }
        self
    }
}

/// What the model names and a setting mends.
fn of_causes(experiment: &Experiment, causes: &[ModelCause]) -> Vec<Candidate> {
    let sure = causes.iter().filter(|cause| cause.rivals.is_empty());
    sure.flat_map(|cause| of_cause(experiment, cause)).collect()
}

fn of_cause(experiment: &Experiment, cause: &ModelCause) -> Vec<Candidate> {
    match cause.kind {
        CauseKind::GearRatio => of_gear(experiment, cause),
        CauseKind::LoadFriction => {
            let term = "load-friction".to_owned();
            let step = RecordingStep {
                recording: None,
                held_back: false,
                with_reference: false,
                with_velocity: false,
                step: RemedyStep::AddTerm { term },
            };
            vec![candidate(cause, "load-friction".to_owned(), step)]
        }
        CauseKind::LateTorque
        | CauseKind::EncoderZero
        | CauseKind::Elasticity
        | CauseKind::Length
        | CauseKind::Coupling
        | CauseKind::SpeedFriction
        | CauseKind::FrictionDrift
        | CauseKind::Payload => Vec::new(),
    }
}

fn candidate(cause: &ModelCause, code: String, step: RecordingStep) -> Candidate {
    let found = format!("The residual shows {}", cause.kind.with_subject(&cause.subject));
    let (also, before) = (Vec::new(), Vec::new());
    Candidate { code, coordinate: None, found, finding: None, also, cause: Some(cause.kind), step, before }
}

/// Positions that are too large by a ratio, and torques that are too small by it, in every recording. A simulated loop has the
/// ratio of the description, which no channel changes.
fn of_gear(experiment: &Experiment, cause: &ModelCause) -> Vec<Candidate> {
    let n = experiment.robot.coordinate_count();
    let number = cause.subject.strip_prefix("joint ").and_then(|number| number.parse::<usize>().ok());
    let Some((number, size)) = number.filter(|k| (1..=n).contains(k)).zip(cause.size) else { return Vec::new() };
    if experiment.settings.controller.is_some() {
        return Vec::new();
    }
    let ratio = 1.0 + size;
    let factors = |factor: f64| (1..=n).map(|k| if k == number { factor } else { 1.0 }).collect();
    let step = RemedyStep::Scale { position: factors(1.0 / ratio), torque: factors(ratio) };
    let code = format!("gear-ratio-{}", experiment.robot.joint_of(number - 1) + 1);
    let of = |held_back: bool, all: &[RecordingDescription]| -> Vec<Candidate> {
        let one = |(i, d): (usize, &RecordingDescription)| {
            let step = RecordingStep {
                recording: Some(d.name.clone().unwrap_or_else(|| (i + 1).to_string())),
                held_back,
                with_reference: d.reference.is_some(),
                with_velocity: d.velocity.is_some(),
                step: step.clone(),
            };
            candidate(cause, code.clone(), step)
        };
        all.iter().enumerate().map(one).collect()
    };
    [of(false, &experiment.file.recording), of(true, &experiment.file.validation)].concat()
}

/// The remedy with a code; none if the file has no place for it.
fn remedy(experiment: &Experiment, code: &str, all: &[Candidate]) -> Option<Remedy> {
    let own = || all.iter().filter(|candidate| candidate.code == code);
    let first = own().next()?;
    let mut steps: Vec<RecordingStep> =
        own().flat_map(|candidate| candidate.before.iter().chain([&candidate.step]).cloned()).collect();
    steps.dedup();
    if matches!(first.step.step, RemedyStep::LockJoint { .. }) {
        steps.truncate(1);
    }
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
