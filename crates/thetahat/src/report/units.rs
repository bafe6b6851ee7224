//! Names and units of a joint in the figures; revolute units where the results do not tell the joint's kind.

use super::wrap::shortened;
use crate::results::{JointKind, Results};

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

/// A joint by its number, with its name where that says more.
pub(super) fn joint(results: &Results, joint: usize) -> String {
    let number = joint + 1;
    let name = results.robot_joints.get(joint).map_or("", |j| j.name.as_str());
    let says_number = name.is_empty()
        || name.trim_end_matches(|c: char| c.is_ascii_digit()).len() <= 6 && name.ends_with(&number.to_string());
    if says_number {
        return format!("Joint {number}");
    }
    format!("Joint {number} ({})", shortened(name, LONGEST))
}

/// Whether anything was measured of a joint.
pub(super) fn has_joint(results: &Results, joint: usize) -> bool {
    results.plots.measured.get(joint).is_none_or(|m| m.iter().any(|v| *v != 0.0))
}
