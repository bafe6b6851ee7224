//! The torque terms of friction that the residual asks for.

use crate::run::{identification::Identification, prepared::filtered};
use thetahat_model::robot::TermDescription;
use thetahat_report::results::{CauseKind, ModelCause};

/// Velocities at which friction fades, over the peak velocity of the joint.
const FADING: [f64; 4] = [0.05, 0.1, 0.2, 0.4];

/// Sets of terms that are tried, one for each law and one for each two of different causes.
pub(super) fn friction_terms(identification: &Identification, causes: &[ModelCause]) -> Vec<Vec<TermDescription>> {
    let shows = |kind: CauseKind| causes.iter().any(|cause| cause.kind == kind);
    let of_load = vec![TermDescription::LoadFriction { joints: None }];
    let mut of_speed: Vec<Vec<TermDescription>> = FADING.iter().map(|part| fading(identification, *part)).collect();
    of_speed.push(vec![TermDescription::PolynomialViscous { joints: None, powers: vec![2] }]);
    let both = of_speed.iter().map(|terms| [&of_load[..], terms].concat());
    match (shows(CauseKind::LoadFriction), shows(CauseKind::SpeedFriction)) {
        (false, false) => Vec::new(),
        (true, false) => vec![of_load],
        (false, true) => of_speed,
        (true, true) => both.chain([of_load.clone()]).chain(of_speed.clone()).collect(),
    }
}

/// Friction that fades above a part of each joint's peak velocity.
fn fading(identification: &Identification, part: f64) -> Vec<TermDescription> {
    let robot = identification.setup().robot;
    let recordings = filtered(&identification.main);
    let peak = |joint: usize| {
        let speeds = recordings.iter().flat_map(|r| (0..r.motion.dq.len()).map(move |k| r.motion.dq.sample(k)[joint]));
        speeds.fold(0.0, |peak: f64, dq| peak.max(dq.abs()))
    };
    let term = |joint: usize| TermDescription::ExponentialStribeck {
        joints: Some(vec![robot.joints[robot.joint_of(joint)].name.clone()]),
        velocity: part * peak(joint),
        exponent: 2.0,
        profile: false,
    };
    (0..robot.coordinate_count()).filter(|joint| peak(*joint) > 0.0).map(term).collect()
}
