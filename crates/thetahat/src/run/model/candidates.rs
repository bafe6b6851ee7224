//! What the model is chosen from.

use crate::preparation::Setup;
use thetahat_model::robot::JointKind;

/// Velocities v of `tanh(dq / v)`, the sign of the Coulomb friction, rad/s; the first is the default.
const TRANSITIONS: [f64; 5] = [0.03, 0.001, 0.003, 0.01, 0.1];
/// Radians of a motor for each metre of a robot whose joints all slide: a pinion of 0.1 m.
const SLIDING: f64 = 10.0;

/// Weights of the belief, in long-run variances of the residual; the first is the default.
const WEIGHTS: [f64; 7] = [1.0, 1e-3, 1e-2, 0.1, 10.0, 100.0, 1000.0];

/// The weights of the belief from which one is chosen.
pub(super) fn weights(setup: Setup<'_>) -> Vec<f64> {
    setup.settings.model.belief_weight.map_or_else(|| WEIGHTS.to_vec(), |stated| vec![stated])
}

/// Whether each joint turns or slides.
pub(super) fn kinds(setup: Setup<'_>) -> Vec<JointKind> {
    setup.robot.coordinates().map(|joint| joint.kind).collect()
}

/// The velocities at which friction changes its sign from which one is chosen.
pub(crate) fn transitions(setup: Setup<'_>) -> Vec<f64> {
    if let Some(stated) = setup.settings.model.friction_transition {
        return vec![stated];
    }
    let slides = setup.robot.coordinates().all(|joint| joint.kind == JointKind::Prismatic);
    TRANSITIONS.map(|v| if slides { v / SLIDING } else { v }).to_vec()
}
