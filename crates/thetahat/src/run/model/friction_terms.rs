//! The torque terms of friction that the residual asks for.

use crate::run::{hidden_bias::peak_velocities, identification::Identification, prepared::filtered};
use thetahat_model::robot::{Robot, TermDescription};
use thetahat_report::results::{CauseKind, ModelCause};

/// Velocities at which friction fades, over the peak velocity of the joint.
const FADING: [f64; 4] = [0.05, 0.1, 0.2, 0.4];

/// Sets of terms that are tried, one for each law and one for each two of different causes.
pub(super) fn friction_terms(identification: &Identification, causes: &[ModelCause]) -> Vec<Vec<TermDescription>> {
    let shows = |kind: CauseKind| causes.iter().any(|cause| cause.kind == kind);
    let of_load = vec![TermDescription::LoadFriction { joints: None }];
    let is_of_speed = shows(CauseKind::SpeedFriction) || causes.iter().any(ModelCause::looks_early);
    if !is_of_speed {
        return if shows(CauseKind::LoadFriction) { vec![of_load] } else { Vec::new() };
    }
    let robot = identification.setup().robot;
    let peaks = peak_velocities(&filtered(&identification.main), robot.coordinate_count());
    let mut of_speed: Vec<Vec<TermDescription>> = FADING.iter().map(|part| fading(robot, &peaks, *part)).collect();
    of_speed.push(vec![TermDescription::PolynomialViscous { joints: None, powers: vec![2] }]);
    if !shows(CauseKind::LoadFriction) {
        return of_speed;
    }
    let both = of_speed.iter().map(|terms| [&of_load[..], terms].concat());
    both.chain([of_load.clone()]).chain(of_speed.clone()).collect()
}

/// Friction that fades above a part of each joint's peak velocity.
fn fading(robot: &Robot, peaks: &[f64], part: f64) -> Vec<TermDescription> {
    let term = |(joint, peak): (usize, &f64)| TermDescription::ExponentialStribeck {
        joints: Some(vec![robot.joints[robot.joint_of(joint)].name.clone()]),
        velocity: part * peak,
        exponent: 2.0,
        profile: false,
    };
    peaks.iter().enumerate().filter(|(_, peak)| **peak > 0.0).map(term).collect()
}
