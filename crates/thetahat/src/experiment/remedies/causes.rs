//! Causes that the model names and a setting mends.

use super::candidate::Candidate;
use crate::experiment::description::{Experiment, RecordingDescription};
use thetahat_report::results::{CauseKind, ModelCause, RecordingStep, RemedyStep};

/// What the model names and a setting mends.
pub(super) fn of_causes(experiment: &Experiment, causes: &[ModelCause]) -> Vec<Candidate> {
    let sure = causes.iter().filter(|cause| cause.rivals.is_empty());
    sure.flat_map(|cause| of_cause(experiment, cause)).collect()
}

fn of_cause(experiment: &Experiment, cause: &ModelCause) -> Vec<Candidate> {
    match cause.kind {
        CauseKind::GearRatio | CauseKind::DriveGain => of_scale(experiment, cause),
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
        | CauseKind::OffsetDrift
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

/// Positions that are too large by a ratio, and torques that are too small by it, or torques that are too large, in every recording. A
/// simulated loop has the ratio of the description, which no channel changes.
fn of_scale(experiment: &Experiment, cause: &ModelCause) -> Vec<Candidate> {
    let n = experiment.robot.coordinate_count();
    let number = cause.subject.strip_prefix("joint ").and_then(|number| number.parse::<usize>().ok());
    let Some((number, size)) = number.filter(|k| (1..=n).contains(k)).zip(cause.size) else { return Vec::new() };
    if experiment.settings.controller.is_some() {
        return Vec::new();
    }
    let ratio = 1.0 + size;
    let factors = |factor: f64| (1..=n).map(|k| if k == number { factor } else { 1.0 }).collect();
    let of_gear = cause.kind == CauseKind::GearRatio;
    let [position, torque] = if of_gear { [1.0 / ratio, ratio] } else { [1.0, 1.0 / ratio] };
    let step = RemedyStep::Scale { position: factors(position), torque: factors(torque) };
    let name = if of_gear { "gear-ratio" } else { "drive-gain" };
    let code = format!("{name}-{}", experiment.robot.joint_of(number - 1) + 1);
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
