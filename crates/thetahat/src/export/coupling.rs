//! Coupled motors as MuJoCo's fixed tendons, whose velocity is a combination of joint velocities.
//!
//! Our `iam` and `fvm` multiply the cross terms of `n^T n` alone, and `ia` and `fv` of the joints hold the diagonal. A tendon's
//! armature and damping multiply all of `n^T n`, so the joints' own lose the diagonal. MuJoCo has none below zero: where a joint
//! would get one, the motor's inertia or viscous friction cannot be represented.

use thetahat_model::{
    dynamics::{CoupledMotor, Model},
    robot::{JointQuantity, MotorQuantity, Quantity, Robot},
};

/// A motor that turns with several joints.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tendon {
    /// Index of the joint whose number the motor has.
    pub(super) motor: usize,
    /// Joints, by their index, with the motor's velocity in joint units per joint velocity.
    pub(super) joints: Vec<(usize, f64)>,
    pub(super) armature: f64,
    pub(super) damping: f64,
    pub(super) friction_loss: f64,
}

/// What a quantity of the joints and its counterpart of the coupled motors become.
struct Pair {
    own: JointQuantity,
    cross: MotorQuantity,
}

const INERTIA: Pair = Pair { own: JointQuantity::Ia, cross: MotorQuantity::Iam };
const VISCOUS: Pair = Pair { own: JointQuantity::Fv, cross: MotorQuantity::Fvm };

/// The tendons of a robot's coupled motors.
pub(super) fn tendons(robot: &Robot, parameters: &[f64]) -> Vec<Tendon> {
    let (model, table, joints) = (Model::new(robot), robot.parameter_table(), robot.coordinate_joints());
    let of = |quantity, motor| table.value(parameters, Quantity::Motor(quantity), motor);
    let tendon = |motor: &CoupledMotor| Tendon {
        motor: motor.motor,
        joints: motor.weights.iter().map(|&(c, weight)| (joints[c], weight)).collect(),
        armature: of(MotorQuantity::Iam, motor.motor),
        damping: of(MotorQuantity::Fvm, motor.motor),
        friction_loss: of(MotorQuantity::Fcm, motor.motor),
    };
    model.coupled_motors().iter().map(tendon).collect()
}

/// The quantities of coupled motors that tendons cannot represent, since a joint's own would be below zero.
pub(super) fn not_representable(robot: &Robot, parameters: &[f64]) -> Vec<MotorQuantity> {
    let tendons = tendons(robot, parameters);
    let below = |pair: &Pair| (0..robot.joints.len()).any(|j| rest_of(robot, parameters, &tendons, pair, j) < 0.0);
    [INERTIA, VISCOUS].iter().filter(|pair| below(pair)).map(|pair| pair.cross).collect()
}

/// The armature and the damping of a joint, without what the tendons hold.
pub(super) fn drive_without_tendons(robot: &Robot, parameters: &[f64], tendons: &[Tendon], joint: usize) -> [f64; 2] {
    [INERTIA, VISCOUS].map(|pair| rest_of(robot, parameters, tendons, &pair, joint))
}

fn rest_of(robot: &Robot, parameters: &[f64], tendons: &[Tendon], pair: &Pair, joint: usize) -> f64 {
    let of_tendon = |t: &Tendon| if pair.cross == MotorQuantity::Iam { t.armature } else { t.damping };
    let weight = |t: &Tendon| t.joints.iter().find(|(j, _)| *j == joint).map_or(0.0, |(_, w)| w * w);
    let own = robot.parameter_table().value(parameters, Quantity::Joint(pair.own), joint);
    own - tendons.iter().map(|t| weight(t) * of_tendon(t)).sum::<f64>()
}
