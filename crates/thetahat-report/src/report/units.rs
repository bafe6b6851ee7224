//! Names and units of a joint in the figures; revolute units if the results do not contain the joint's kind.

use super::wrap::shortened;
use crate::results::{JointKind, JointResult, Results};

/// Longest name of a joint in a title.
const LONGEST: usize = 20;

pub(super) fn kind(results: &Results, joint: usize) -> JointKind {
    results.robot_joints.get(joint).map_or(JointKind::Revolute, |j| j.kind)
}

/// Unit of a joint's position times 1000.
pub(super) fn thousandth_of_position(results: &Results, joint: usize) -> &'static str {
    match kind(results, joint) {
        JointKind::Revolute => "mrad",
        JointKind::Prismatic => "mm",
    }
}

/// Unit of a joint's torque.
pub(super) fn torque(results: &Results, joint: usize) -> &str {
    results.robot_joints.get(joint).map_or("N m", |j| &j.torque_unit)
}

/// A joint's number, with its name if that says more, for a title.
pub(super) fn joint(results: &Results, joint: usize) -> String {
    let number = joint + 1;
    let Some(of_robot) = results.robot_joints.get(joint) else { return format!("Joint {number}") };
    let label = JointResult { name: shortened(&of_robot.name, LONGEST), ..of_robot.clone() }.label(number);
    label.replacen('j', "J", 1)
}

/// Whether a joint has measured torques.
pub(super) fn has_joint(results: &Results, joint: usize) -> bool {
    results.plots.measured.get(joint).is_none_or(|m| m.iter().any(|v| *v != 0.0))
}
