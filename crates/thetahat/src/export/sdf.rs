//! A new SDF of a robot, as Gazebo and Drake read it.

use super::{
    body::Body,
    frames::{LinkFrame, link_name},
    represented::RepresentedRobot,
    xml::{escaped, number, numbers},
};
use thetahat_model::robot::{JointKind, JointQuantity, Robot};

/// The SDF of a robot, with `header` at its start.
pub(super) fn sdf(represented: &RepresentedRobot, header: &str) -> String {
    let robot = &represented.robot;
    // Mimic joints are of version 1.11.
    let version = if robot.joints.iter().any(|j| j.mimic.is_some()) { "1.11" } else { "1.9" };
    let mut lines =
        vec![format!("<sdf version=\"{version}\">"), format!("  <model name=\"{}\">", escaped(&robot.name))];
    // A link that no joint holds moves freely.
    let base = robot.base_coordinates();
    (base.saturating_sub(1)..robot.joints.len()).for_each(|k| lines.extend(link(represented, k)));
    (base..robot.joints.len()).for_each(|k| lines.extend(joint(represented, k)));
    lines.extend(["  </model>", "</sdf>"].map(str::to_owned));
    format!("<?xml version=\"1.0\"?>\n{header}{}\n", lines.join("\n"))
}

fn link(represented: &RepresentedRobot, k: usize) -> Vec<String> {
    let own = &represented.robot.joints[k];
    let frame =
        if own.of_base { LinkFrame::of_root(&represented.robot, k) } else { LinkFrame::of(&represented.robot, k) };
    let body = Body::new(represented.inertial_of(k));
    let within = own.parent.filter(|_| !own.of_base).map_or_else(|| "__model__".to_owned(), link_name);
    let pose = [frame.origin, frame.roll_pitch_yaw()].concat();
    let keys = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
    let inertia: String = keys.iter().zip(body.six()).map(|(k, v)| format!("<{k}>{}</{k}>", number(v))).collect();
    vec![
        format!("    <link name=\"{}\">", link_name(k)),
        format!("      <pose relative_to=\"{within}\">{}</pose>", numbers(&pose)),
        "      <inertial>".to_owned(),
        format!("        <pose>{} 0 0 0</pose>", numbers(&body.centre)),
        format!("        <mass>{}</mass>", number(body.mass)),
        format!("        <inertia>{inertia}</inertia>"),
        "      </inertial>".to_owned(),
        "    </link>".to_owned(),
    ]
}

fn joint(represented: &RepresentedRobot, k: usize) -> Vec<String> {
    let joint = &represented.robot.joints[k];
    let kind = match joint.kind {
        JointKind::Revolute => "revolute",
        JointKind::Prismatic => "prismatic",
    };
    let parent = joint.parent.map_or_else(|| "world".to_owned(), link_name);
    let [damping, friction] = [JointQuantity::Fv, JointQuantity::Fc].map(|q| number(represented.of_joint(q, k)));
    let axis = LinkFrame::of(&represented.robot, k).axis;
    let mut lines = vec![
        format!("    <joint name=\"{}\" type=\"{kind}\">", escaped(&joint.name)),
        format!("      <parent>{parent}</parent>"),
        format!("      <child>{}</child>", link_name(k)),
        "      <axis>".to_owned(),
        format!("        <xyz>{}</xyz>", numbers(&axis)),
        limit(joint),
        format!("        <dynamics><damping>{damping}</damping><friction>{friction}</friction></dynamics>"),
    ];
    lines.extend(mimic(&represented.robot, joint));
    lines.extend(["      </axis>", "    </joint>"].map(str::to_owned));
    lines
}

/// What is not known is left out, and unlimited then.
fn limit(joint: &thetahat_model::robot::Joint) -> String {
    let limits = &joint.limits;
    let given =
        [("lower", limits.lower), ("upper", limits.upper), ("effort", limits.effort), ("velocity", limits.velocity)];
    let inside: String = given.into_iter().filter_map(|(k, v)| Some(format!("<{k}>{}</{k}>", number(v?)))).collect();
    format!("        <limit>{inside}</limit>")
}

fn mimic(robot: &Robot, joint: &thetahat_model::robot::Joint) -> Option<String> {
    let mimic = joint.mimic?;
    let leader = escaped(&robot.joints[mimic.of].name);
    let [ratio, offset] = [mimic.ratio, mimic.offset].map(number);
    Some(format!(
        "        <mimic joint=\"{leader}\"><multiplier>{ratio}</multiplier><offset>{offset}</offset><reference>0</reference></mimic>"
    ))
}
