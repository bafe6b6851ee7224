//! Causes that the model names and a setting mends.

use super::candidate::{Candidate, moves_position};
use crate::{
    experiment::description::{Experiment, RecordingDescription},
    preparation::EstimatedSize,
};
use thetahat_estimation::checks::Code;
use thetahat_ground::vector::{IDENTITY, Vec3, axis_angle, times};
use thetahat_report::results::{CauseKind, ModelCause, RecordingStep, RemedyStep};

/// Steps of gravity in one m/s^2: a hundred-thousandth of it.
const DIGITS: f64 = 1e4;

/// What the model names and a setting mends.
pub(super) fn of_causes(experiment: &Experiment, causes: &[ModelCause]) -> Vec<Candidate> {
    let sure: Vec<&ModelCause> = causes.iter().filter(|cause| cause.rivals.is_empty()).collect();
    let single = sure.iter().flat_map(|cause| of_cause(experiment, cause));
    single.chain(of_tilts(experiment, &sure)).collect()
}

fn of_cause(experiment: &Experiment, cause: &ModelCause) -> Vec<Candidate> {
    match cause.kind {
        CauseKind::LateTorque => of_delay(experiment, cause),
        CauseKind::GearRatio | CauseKind::DriveGain => of_scale(experiment, cause),
        CauseKind::TorqueFilter => of_filter(experiment, cause),
        CauseKind::JointSpring => of_term(experiment, cause, "joint-spring").into_iter().collect(),
        CauseKind::AsymmetricFriction => of_term(experiment, cause, "asymmetric-viscous").into_iter().collect(),
        CauseKind::LoadFriction => {
            let (term, joints) = ("load-friction".to_owned(), Vec::new());
            vec![candidate(cause, "load-friction".to_owned(), of_robot(RemedyStep::AddTerm { term, joints }))]
        }
        CauseKind::EncoderZero
        | CauseKind::OffsetDrift
        | CauseKind::Elasticity
        | CauseKind::LatePosition
        | CauseKind::TimeScale
        | CauseKind::Length
        | CauseKind::Coupling
        | CauseKind::SpeedFriction
        | CauseKind::FrictionDrift
        | CauseKind::Payload
        | CauseKind::Crosstalk
        | CauseKind::FallingConstant
        | CauseKind::GainDrift
        | CauseKind::TorqueRipple
        | CauseKind::ZeroShift
        // Tilts about two axes are one remedy.
        | CauseKind::GravityDirection => Vec::new(),
    }
}

/// A step that changes the robot.
pub(super) fn of_robot(step: RemedyStep) -> RecordingStep {
    RecordingStep { recording: None, held_back: false, with_reference: false, with_velocity: false, step }
}

/// Gravity in the frame of a base that is tilted about its axes.
fn of_tilts(experiment: &Experiment, causes: &[&ModelCause]) -> Option<Candidate> {
    let tilts: Vec<&ModelCause> =
        causes.iter().copied().filter(|cause| cause.kind == CauseKind::GravityDirection).collect();
    let turn = |gravity: Vec3, tilt: &&ModelCause| {
        let axis = ["about x", "about y", "about z"].iter().position(|subject| tilt.subject == *subject)?;
        Some(times(&axis_angle(IDENTITY[axis], -tilt.size?), gravity))
    };
    let gravity = tilts.iter().try_fold(experiment.robot.gravity, turn)?;
    let gravity = gravity.map(|g| (g * DIGITS).round() / DIGITS);
    let step = of_robot(RemedyStep::Gravity { gravity });
    tilts.first().map(|first| candidate(first, Code::GravityDirection.name().to_owned(), step))
}

/// A torque term of the joint.
fn of_term(experiment: &Experiment, cause: &ModelCause, term: &str) -> Option<Candidate> {
    let robot = &experiment.robot;
    let joint = robot.joint_of(coordinate_of(experiment, cause)?);
    let joints = vec![robot.joints[joint].name.clone()];
    let step = of_robot(RemedyStep::AddTerm { term: term.to_owned(), joints });
    Some(candidate(cause, format!("{term}-{}", joint + 1), step))
}

/// The coordinate of "joint 3", from zero.
fn coordinate_of(experiment: &Experiment, cause: &ModelCause) -> Option<usize> {
    let number = cause.subject.strip_prefix("joint ").and_then(|number| number.parse::<usize>().ok())?;
    (1..=experiment.robot.coordinate_count()).contains(&number).then(|| number - 1)
}

fn candidate(cause: &ModelCause, code: String, step: RecordingStep) -> Candidate {
    let found = format!("The residual shows {}", cause.kind.with_subject(&cause.subject));
    let (also, before) = (Vec::new(), Vec::new());
    Candidate { code, coordinate: None, found, finding: None, also, cause: Some(cause.kind), step, before }
}

/// The torque of one joint is late in every recording; a delay of all is what the checks measure.
fn of_delay(experiment: &Experiment, cause: &ModelCause) -> Vec<Candidate> {
    let Some((coordinate, size)) = coordinate_of(experiment, cause).zip(cause.size) else { return Vec::new() };
    let delay_s = (1e6 * size).round() / 1e6;
    let step = RemedyStep::Delay { delay_s, joints: vec![coordinate + 1] };
    let code = format!("{}-{}", Code::Lag.name(), experiment.robot.joint_of(coordinate) + 1);
    in_every_recording(experiment, cause, &code, &step)
}

/// A filter of the torques. At first the whole delay is taken for the filter's; later the filter is corrected by what is left.
fn of_filter(experiment: &Experiment, cause: &ModelCause) -> Vec<Candidate> {
    let estimated = &experiment.settings.model.estimated;
    let torque = experiment.file.recording.first().and_then(|recording| recording.torque.as_ref());
    let Some((torque, size)) = torque.zip(cause.size) else { return Vec::new() };
    let is_late = estimated.contains(&EstimatedSize::Lag(None));
    let delay_s = torque.least_delay_s();
    let time_constant_s = match torque.low_pass_s {
        None if is_late && delay_s > 0.0 => delay_s,
        None => size.max(0.0),
        Some(stated) if estimated.contains(&EstimatedSize::TorqueFilter) => {
            (stated * stated + size * size.abs()).max(0.0).sqrt()
        }
        Some(_) => return Vec::new(),
    };
    let step = RemedyStep::LowPass { time_constant_s: (1e6 * time_constant_s).round() / 1e6 };
    in_every_recording(experiment, cause, "torque-filter", &step)
}

/// Positions that are too large by a ratio, and torques that are too small by it, or torques that are too large, in every recording. A
/// simulated loop has the ratio of the description, which no channel changes.
fn of_scale(experiment: &Experiment, cause: &ModelCause) -> Vec<Candidate> {
    let n = experiment.robot.coordinate_count();
    let Some((coordinate, size)) = coordinate_of(experiment, cause).zip(cause.size) else { return Vec::new() };
    if experiment.settings.controller.is_some() {
        return Vec::new();
    }
    let ratio = 1.0 + size;
    let factors = |factor: f64| (0..n).map(|k| if k == coordinate { factor } else { 1.0 }).collect();
    let of_gear = cause.kind == CauseKind::GearRatio;
    let [position, torque] = if of_gear { [1.0 / ratio, ratio] } else { [1.0, 1.0 / ratio] };
    let step = RemedyStep::Scale { position: factors(position), torque: factors(torque) };
    let name = if of_gear { "gear-ratio" } else { "drive-gain" };
    let code = format!("{name}-{}", experiment.robot.joint_of(coordinate) + 1);
    in_every_recording(experiment, cause, &code, &step)
}

/// A step that changes the description of every recording.
fn in_every_recording(experiment: &Experiment, cause: &ModelCause, code: &str, step: &RemedyStep) -> Vec<Candidate> {
    let of = |held_back: bool, all: &[RecordingDescription]| -> Vec<Candidate> {
        let one = |(i, d): (usize, &RecordingDescription)| {
            let moves = moves_position(step);
            let step = RecordingStep {
                recording: Some(d.name.clone().unwrap_or_else(|| (i + 1).to_string())),
                held_back,
                with_reference: moves && d.reference.is_some(),
                with_velocity: moves && d.velocity.is_some(),
                step: step.clone(),
            };
            candidate(cause, code.to_owned(), step)
        };
        all.iter().enumerate().map(one).collect()
    };
    [of(false, &experiment.file.recording), of(true, &experiment.file.validation)].concat()
}
