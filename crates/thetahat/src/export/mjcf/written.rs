//! A new MJCF of a robot: MuJoCo's model file.

use super::{loops, servos::Servos};
use crate::export::{
    body::Body,
    coupling::{Tendon, drive_without_tendons},
    frames::{LinkFrame, link_name},
    represented::RepresentedRobot,
    xml::{escaped, number, numbers},
};
use thetahat_model::robot::{JointKind, JointQuantity, Robot};

/// The MJCF of a robot, with `header` at its start.
pub(in crate::export) fn mjcf(represented: &RepresentedRobot, header: &str, servos: Option<&Servos>) -> String {
    let robot = &represented.robot;
    let options = servos.map_or_else(String::new, Servos::options);
    let mut lines = vec![
        format!("<mujoco model=\"{}\">", escaped(&robot.name)),
        "  <compiler angle=\"radian\"/>".to_owned(),
        format!("  <option gravity=\"{}\"{options}/>", numbers(&robot.gravity)),
    ];
    lines.extend(servos.map(Servos::defaults));
    lines.push("  <worldbody>".to_owned());
    lines.extend(loops::sites(robot, None).into_iter().map(|site| format!("    {site}")));
    let first = |k: &usize| robot.joints[*k].parent.is_none();
    let roots: Vec<usize> = match robot.root_joint() {
        Some(root) => vec![root],
        None => (0..robot.joints.len()).filter(first).collect(),
    };
    roots.into_iter().for_each(|k| add_body(represented, k, 2, &mut lines));
    lines.push("  </worldbody>".to_owned());
    lines.extend(loops::tendons(robot));
    lines.extend(equalities(robot));
    lines.extend(coupled_motors(represented));
    lines.extend(servos.map_or_else(|| loops::motors(robot), |servos| vec![servos.actuators()]));
    lines.extend(loops::keyframe(robot));
    lines.push("</mujoco>".to_owned());
    format!("{header}{}\n", lines.join("\n"))
}

/// The body of a link with those that it carries; robots have at most a hundred joints.
fn add_body(represented: &RepresentedRobot, k: usize, depth: usize, lines: &mut Vec<String>) {
    let space = "  ".repeat(depth);
    let is_root = represented.robot.joints[k].of_base;
    let frame = if is_root { LinkFrame::of_root(&represented.robot, k) } else { LinkFrame::of(&represented.robot, k) };
    lines.push(format!(
        "{space}<body name=\"{}\" pos=\"{}\" quat=\"{}\">",
        link_name(k),
        numbers(&frame.origin),
        numbers(&frame.quaternion())
    ));
    lines.push(format!("{space}  {}", inertial(&Body::new(represented.inertial_of(k)))));
    let moved = if is_root { "<freejoint name=\"base\"/>".to_owned() } else { joint(represented, k, &frame) };
    lines.push(format!("{space}  {moved}"));
    lines.extend(loops::sites(&represented.robot, Some(k)).into_iter().map(|site| format!("{space}  {site}")));
    let children = (0..represented.robot.joints.len()).filter(|&j| represented.robot.joints[j].parent == Some(k));
    children.for_each(|child| add_body(represented, child, depth + 1, lines));
    lines.push(format!("{space}</body>"));
}

/// The `<inertial>` of a body.
pub(super) fn inertial(body: &Body) -> String {
    let [xx, xy, xz, yy, yz, zz] = body.six();
    format!(
        "<inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{}\"/>",
        numbers(&body.centre),
        number(body.mass),
        numbers(&[xx, yy, zz, xy, xz, yz])
    )
}

fn joint(represented: &RepresentedRobot, k: usize, frame: &LinkFrame) -> String {
    let joint = &represented.robot.joints[k];
    let kind = match joint.kind {
        JointKind::Revolute => "hinge",
        JointKind::Prismatic => "slide",
    };
    let range = match joint.limits.lower.zip(joint.limits.upper) {
        Some((lower, upper)) if lower < upper => format!(" range=\"{} {}\"", number(lower), number(upper)),
        Some(_) | None => String::new(),
    };
    let [armature, damping] =
        drive_without_tendons(&represented.robot, &represented.parameters, &represented.tendons, k).map(number);
    let friction = number(represented.of_joint(JointQuantity::Fc, k));
    format!(
        "<joint name=\"{}\" type=\"{kind}\" axis=\"{}\"{range} armature=\"{armature}\" damping=\"{damping}\" \
         frictionloss=\"{friction}\"/>",
        escaped(&joint.name),
        numbers(&frame.axis)
    )
}

/// The name of a coupled motor's tendon.
pub(super) fn tendon_name(tendon: &Tendon) -> String {
    format!("motor_{}", tendon.motor + 1)
}

/// Motors that turn with several joints, as fixed tendons.
pub(super) fn coupled_motors(represented: &RepresentedRobot) -> Vec<String> {
    if represented.tendons.is_empty() {
        return Vec::new();
    }
    let mut lines = vec!["  <tendon>".to_owned()];
    for tendon in &represented.tendons {
        let [armature, damping, friction] = [tendon.armature, tendon.damping, tendon.friction_loss].map(number);
        lines.push(format!(
            "    <fixed name=\"{}\" armature=\"{armature}\" damping=\"{damping}\" frictionloss=\"{friction}\">",
            tendon_name(tendon)
        ));
        let joint = |(j, weight): &(usize, f64)| {
            let name = escaped(&represented.robot.joints[*j].name);
            format!("      <joint joint=\"{name}\" coef=\"{}\"/>", number(*weight))
        };
        lines.extend(tendon.joints.iter().map(joint));
        lines.push("    </fixed>".to_owned());
    }
    lines.push("  </tendon>".to_owned());
    lines
}

/// Joints that follow others, and loops, which MuJoCo holds by constraints.
fn equalities(robot: &Robot) -> Vec<String> {
    let follower = |joint: &thetahat_model::robot::Joint| {
        let mimic = joint.mimic?;
        let leader = escaped(&robot.joints[mimic.of].name);
        let [offset, ratio] = [mimic.offset, mimic.ratio].map(number);
        let name = escaped(&joint.name);
        Some(format!("    <joint joint1=\"{name}\" joint2=\"{leader}\" polycoef=\"{offset} {ratio} 0 0 0\"/>"))
    };
    let constraints: Vec<String> = robot.joints.iter().filter_map(follower).chain(loops::constraints(robot)).collect();
    if constraints.is_empty() {
        return Vec::new();
    }
    [vec!["  <equality>".to_owned()], constraints, vec!["  </equality>".to_owned()]].concat()
}
