//! A new URDF of a robot that was read from another description.

use super::{
    body::Body,
    frames::{LinkFrame, link_name},
    represented::RepresentedRobot,
    urdf_edit::inertial_lines,
    xml::{escaped, number, numbers},
};
use thetahat_model::robot::{Joint, JointKind, JointQuantity, Robot};

/// The link of the base.
const BASE_LINK: &str = "base_link";
/// A limit that is not known: URDF must have one, and readers would take zero literally.
const UNKNOWN: f64 = 1e9;

/// The URDF of a robot, with `header` at its start. `reductions` are the gear ratios of the coordinates' motors, `None` if
/// motors are coupled.
pub(super) fn urdf(represented: &RepresentedRobot, header: &str, reductions: Option<&[f64]>) -> String {
    let robot = &represented.robot;
    let mut lines = vec![format!("<robot name=\"{}\">", escaped(&robot.name))];
    match robot.root_joint() {
        None => lines.push("  <link name=\"base_link\"/>".to_owned()),
        Some(root) => lines.extend(link(represented, root, BASE_LINK)),
    }
    let own = robot.base_coordinates()..robot.joints.len();
    own.clone().for_each(|k| lines.extend(link(represented, k, &link_name(k))));
    own.for_each(|k| lines.extend(joint(represented, k)));
    let ratios = reductions.into_iter().flatten().zip(robot.coordinates());
    lines.extend(ratios.filter(|(ratio, _)| **ratio != 1.0).map(|(ratio, joint)| transmission(joint, *ratio)));
    lines.push("</robot>".to_owned());
    format!("<?xml version=\"1.0\"?>\n{header}{}\n", lines.join("\n"))
}

fn link(represented: &RepresentedRobot, k: usize, name: &str) -> [String; 3] {
    let body = Body::new(represented.inertial_of(k));
    [format!("  <link name=\"{name}\">"), inertial_lines(&body, "  ", "\n"), "  </link>".to_owned()]
}

fn joint(represented: &RepresentedRobot, k: usize) -> Vec<String> {
    let RepresentedRobot { robot, .. } = represented;
    let joint = &robot.joints[k];
    let frame = LinkFrame::of(robot, k);
    let parent = joint.parent.filter(|parent| Some(*parent) != robot.root_joint());
    let parent = parent.map_or_else(|| BASE_LINK.to_owned(), link_name);
    let [damping, friction] = [JointQuantity::Fv, JointQuantity::Fc].map(|q| number(represented.of_joint(q, k)));
    let mut lines = vec![
        format!("  <joint name=\"{}\" type=\"{}\">", escaped(&joint.name), kind(joint)),
        format!("    <parent link=\"{parent}\"/>"),
        format!("    <child link=\"{}\"/>", link_name(k)),
        format!("    <origin xyz=\"{}\" rpy=\"{}\"/>", numbers(&frame.origin), numbers(&frame.roll_pitch_yaw())),
        format!("    <axis xyz=\"{}\"/>", numbers(&frame.axis)),
        limit(joint),
        format!("    <dynamics damping=\"{damping}\" friction=\"{friction}\"/>"),
    ];
    lines.extend(mimic(robot, joint));
    lines.push("  </joint>".to_owned());
    lines
}

fn kind(joint: &Joint) -> &'static str {
    match (joint.kind, joint.limits.lower.and(joint.limits.upper)) {
        (JointKind::Revolute, Some(_)) => "revolute",
        (JointKind::Revolute, None) => "continuous",
        (JointKind::Prismatic, _) => "prismatic",
    }
}

fn limit(joint: &Joint) -> String {
    let limits = &joint.limits;
    let bound = |given: Option<f64>, unknown: f64| number(given.unwrap_or(unknown));
    let range = match kind(joint) {
        "continuous" => String::new(),
        _ => format!("lower=\"{}\" upper=\"{}\" ", bound(limits.lower, -UNKNOWN), bound(limits.upper, UNKNOWN)),
    };
    let [effort, velocity] = [limits.effort, limits.velocity].map(|given| bound(given, UNKNOWN));
    format!("    <limit {range}effort=\"{effort}\" velocity=\"{velocity}\"/>")
}

fn mimic(robot: &Robot, joint: &Joint) -> Option<String> {
    let mimic = joint.mimic?;
    let leader = escaped(&robot.joints[mimic.of].name);
    let [ratio, offset] = [mimic.ratio, mimic.offset].map(number);
    Some(format!("    <mimic joint=\"{leader}\" multiplier=\"{ratio}\" offset=\"{offset}\"/>"))
}

fn transmission(joint: &Joint, ratio: f64) -> String {
    let name = escaped(&joint.name);
    [
        format!("  <transmission name=\"{name}_transmission\">"),
        "    <type>transmission_interface/SimpleTransmission</type>".to_owned(),
        format!("    <joint name=\"{name}\"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>"),
        format!("    <actuator name=\"{name}_motor\"><mechanicalReduction>{}</mechanicalReduction></actuator>", number(ratio)),
        "  </transmission>".to_owned(),
    ]
    .join("\n")
}
