//! Units of a joint in the figures; revolute units where the results do not tell the joint's kind.

use crate::results::{JointKind, Results};

fn kind(results: &Results, joint: usize) -> JointKind {
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
