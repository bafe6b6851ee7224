//! What the model is chosen from.

use crate::preparation::Setup;
use thetahat_model::{dynamics::FrictionTransition, robot::JointKind};

/// Velocities v of `tanh(dq / v)`, the sign of the Coulomb friction, rad/s; the first is the default.
const TRANSITIONS: [f64; 5] = [0.03, 0.001, 0.003, 0.01, 0.1];
/// The largest velocities that are tried.
pub(super) const LARGEST: FrictionTransition = FrictionTransition::of_all(0.1);
/// Radians of a motor for each metre of a robot whose joints all slide: a pinion of 0.1 m.
const SLIDING: f64 = 10.0;
/// Metres of joints that slide for each radian of others that turn, from which both are searched.
const SLIDING_OF_BOTH: f64 = 0.3;

/// Weights of the belief, in long-run variances of the residual; the first is the default.
const WEIGHTS: [f64; 7] = [1.0, 1e-3, 1e-2, 0.1, 10.0, 100.0, 1000.0];

/// The weights of the belief from which one is chosen.
pub(super) fn weights(setup: Setup<'_>) -> Vec<f64> {
    setup.settings.model.belief_weight.map_or_else(|| WEIGHTS.to_vec(), |stated| vec![stated])
}

/// Whether each joint turns or slides.
pub(crate) fn kinds(setup: Setup<'_>) -> Vec<JointKind> {
    setup.robot.coordinates().map(|joint| joint.kind).collect()
}

/// The velocities at which friction changes its sign from which one is chosen.
pub(crate) fn transitions(setup: Setup<'_>) -> Vec<FrictionTransition> {
    let model = &setup.settings.model;
    if let Some(turning) = model.friction_transition {
        return vec![FrictionTransition { turning, sliding: model.friction_transition_sliding.unwrap_or(turning) }];
    }
    // Nothing rubs in a base that floats.
    let has = |kind: JointKind| setup.robot.coordinates().any(|joint| joint.kind == kind && !joint.of_base);
    let of_number = |v: f64| match (has(JointKind::Revolute), has(JointKind::Prismatic)) {
        (true, true) => FrictionTransition { turning: v, sliding: SLIDING_OF_BOTH * v },
        (false, true) => FrictionTransition::of_all(v / SLIDING),
        (true | false, false) => FrictionTransition::of_all(v),
    };
    TRANSITIONS.map(of_number).to_vec()
}
