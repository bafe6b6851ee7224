//! The robot that an exported file describes, in the names of the robot that was exported.

use super::{coupling::Tendon, represented::RepresentedRobot};
use thetahat_ground::vector::{Mat3, product, times};
use thetahat_model::robot::{
    Frame, INERTIAL, JointQuantity, LoopFrame, MotorQuantity, Parameter, Placement, Quantity, Robot,
};

/// A link with its joint as a file has them.
#[derive(Debug, Clone, Copy)]
pub(super) struct ReadLink {
    /// The frame of the joint, z along the axis, in that of the joint before it or of the base.
    pub(super) joint: Frame,
    /// The inertial parameters in that frame.
    pub(super) in_joint: [f64; 10],
    /// The same in the frame of the exported robot's link.
    pub(super) in_link: [f64; 10],
    pub(super) armature: f64,
    pub(super) damping: f64,
    pub(super) friction: f64,
}

/// Where the kinematics of what is read back are from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kinematics {
    File,
    Robot,
}

/// The exported robot with the values of the file, and its kinematics.
pub(super) fn robot_of(
    represented: &RepresentedRobot,
    links: &[ReadLink],
    tendons: &[Tendon],
    kinematics: Kinematics,
) -> Robot {
    let mut robot = represented.robot.clone();
    if kinematics == Kinematics::File {
        let in_joint = |frame: LoopFrame| {
            let axes = frame.joint.and_then(|joint| represented.robot.joints[joint].link_axes);
            let turned = |axes: Mat3| LoopFrame {
                rotation: product(&axes, &frame.rotation),
                origin: times(&axes, frame.origin),
                ..frame
            };
            axes.map_or(frame, turned)
        };
        for of_loop in &mut robot.loops {
            (of_loop.from, of_loop.to) = (in_joint(of_loop.from), in_joint(of_loop.to));
        }
        for (joint, link) in robot.joints.iter_mut().zip(links) {
            joint.placement = Placement::new(&link.joint.rotation, link.joint.origin);
            joint.link_axes = None;
        }
    }
    let value = |parameter: &Parameter| value(parameter, links, tendons, kinematics);
    robot.a_priori = represented.table.iter().map(|parameter| (parameter.name(), value(parameter))).collect();
    robot
}

fn value(parameter: &Parameter, links: &[ReadLink], tendons: &[Tendon], kinematics: Kinematics) -> f64 {
    let place = parameter.number - 1;
    let own =
        |t: &Tendon| t.joints.iter().find(|(joint, _)| *joint == place).map_or(0.0, |(_, weight)| weight * weight);
    let on_joint = |of: fn(&Tendon) -> f64| tendons.iter().map(|t| own(t) * of(t)).sum::<f64>();
    let of_motor = |of: fn(&Tendon) -> f64| tendons.iter().find(|t| t.motor == place).map_or(0.0, of);
    match parameter.quantity {
        Quantity::Link(quantity) => {
            let link = &links[place];
            let inertial = if kinematics == Kinematics::File { link.in_joint } else { link.in_link };
            INERTIAL.iter().position(|own| *own == quantity).map_or(0.0, |i| inertial[i])
        }
        Quantity::Joint(JointQuantity::Ia) => links[place].armature + on_joint(|t| t.armature),
        Quantity::Joint(JointQuantity::Fv) => links[place].damping + on_joint(|t| t.damping),
        Quantity::Joint(JointQuantity::Fc) => links[place].friction,
        Quantity::Motor(MotorQuantity::Iam) => of_motor(|t| t.armature),
        Quantity::Motor(MotorQuantity::Fvm) => of_motor(|t| t.damping),
        Quantity::Motor(MotorQuantity::Fcm) => of_motor(|t| t.friction_loss),
        Quantity::Joint(
            JointQuantity::Fvp | JointQuantity::Fcp | JointQuantity::Fvn | JointQuantity::Fcn | JointQuantity::Off,
        )
        | Quantity::Term(_) => 0.0,
    }
}
