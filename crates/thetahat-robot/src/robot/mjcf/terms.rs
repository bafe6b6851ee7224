//! Springs of joints, and damping by powers of the velocity, as torque terms.

use super::{actuators::Actuators, assembly::Assembly};
use crate::robot::{JointKind, Robot, RobotError, TermDescription};

/// Adds the springs and the damping by powers of the velocity that differ from zero, with their values.
pub(super) fn add_terms(
    robot: &mut Robot,
    assembly: &Assembly<'_>,
    actuators: &Actuators<'_>,
) -> Result<(), RobotError> {
    for joint in 0..robot.joints.len() {
        let stiffness = assembly.moving[joint].stiffness[0];
        if stiffness != 0.0 {
            let spring = spring(robot, assembly, joint);
            add(robot, assembly, joint, spring, &[("k", stiffness)])?;
        }
        let [_, square, cube] = damping(assembly, actuators, joint);
        let names = Some(vec![robot.joints[joint].name.clone()]);
        let given = [(2, "fvq", square), (3, "fvc", cube)].into_iter().filter(|(.., value)| *value != 0.0);
        let given: Vec<(u8, &str, f64)> = given.collect();
        if !given.is_empty() {
            let powers = given.iter().map(|(power, ..)| *power).collect();
            let values: Vec<(&str, f64)> = given.iter().map(|(_, name, value)| (*name, *value)).collect();
            add(robot, assembly, joint, TermDescription::PolynomialViscous { joints: names, powers }, &values)?;
        }
    }
    Ok(())
}

/// The damping of a joint and its actuators: by the velocity, its square and its cube.
pub(super) fn damping(assembly: &Assembly<'_>, actuators: &Actuators<'_>, joint: usize) -> [f64; 3] {
    let own = assembly.moving[joint].damping;
    let driven = actuators.damping(joint);
    [0, 1, 2].map(|power| own[power] + driven[power])
}

fn spring(robot: &Robot, assembly: &Assembly<'_>, joint: usize) -> TermDescription {
    let (rest, kind) = (assembly.moving[joint].rest, robot.joints[joint].kind);
    let (rest_deg, rest_m) = match kind {
        JointKind::Revolute => (Some(rest.to_degrees()), None),
        JointKind::Prismatic => (None, Some(rest)),
    };
    TermDescription::JointSpring { joints: Some(vec![robot.joints[joint].name.clone()]), rest_deg, rest_m }
}

fn add(
    robot: &mut Robot,
    assembly: &Assembly<'_>,
    joint: usize,
    term: TermDescription,
    values: &[(&str, f64)],
) -> Result<(), RobotError> {
    let path = assembly.moving[joint].element.path().to_owned();
    robot.add_terms(&[term]).map_err(|source| RobotError::Term { path, source: Box::new(source) })?;
    robot.a_priori.extend(values.iter().map(|(name, value)| (format!("{name}{}", joint + 1), *value)));
    Ok(())
}
