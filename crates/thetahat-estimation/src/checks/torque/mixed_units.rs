//! Positions of which some are in rad and the others in degrees, read as if all were in one unit.
//!
//! Joints in rad that are read as degrees move little, and joints in degrees that are read as rad move much, so that the joints of a fault
//! are the first of those in order of their motion.

use super::{
    hypotheses::{Hypothesis, UnitOfSome},
    screening::SPANS_RAD,
};
use thetahat_model::robot::{JointKind, Robot};

/// The corrections of two joints or more, but not of all; those of one joint and of all are among the others.
pub(super) fn mixed_units(robot: &Robot, spans: &[f64]) -> Vec<Hypothesis> {
    let of = |unit: UnitOfSome| {
        let is_plausible = |j: &usize| {
            let turns = robot.joints[robot.joint_of(*j)].kind == JointKind::Revolute;
            turns && SPANS_RAD.contains(&(unit.factor() * spans[*j]))
        };
        let mut joints: Vec<usize> = (0..spans.len()).filter(is_plausible).collect();
        joints.sort_by(|a, b| spans[*a].total_cmp(&spans[*b]));
        if unit == UnitOfSome::Degrees {
            joints.reverse();
        }
        let some = 2..=joints.len().min(spans.len() - 1);
        some.map(move |count| Hypothesis::of_mixed_units(robot, &joints[..count], unit)).collect::<Vec<_>>()
    };
    [UnitOfSome::Radians, UnitOfSome::Degrees].into_iter().flat_map(of).collect()
}
