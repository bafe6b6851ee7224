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
    let model = setup.settings.model;
    if let Some(turning) = model.friction_transition {
        return vec![FrictionTransition { turning, sliding: model.friction_transition_sliding.unwrap_or(turning) }];
    }
    let kinds = kinds(setup);
    let all_slide = kinds.iter().all(|kind| *kind == JointKind::Prismatic);
    let of_number = |v: f64| match (all_slide, has_both(&kinds)) {
        (true, _) => FrictionTransition::of_all(v / SLIDING),
        (false, true) => FrictionTransition { turning: v, sliding: SLIDING_OF_BOTH * v },
        (false, false) => FrictionTransition::of_all(v),
    };
    TRANSITIONS.map(of_number).to_vec()
}

/// Whether some joints turn and others slide.
pub(super) fn has_both(kinds: &[JointKind]) -> bool {
    kinds.iter().any(|kind| *kind != kinds[0])
}

/// The transition of joints that slide where others turn.
pub(crate) fn sliding_apart(transition: FrictionTransition, kinds: &[JointKind]) -> Option<f64> {
    has_both(kinds).then_some(transition.sliding)
}
