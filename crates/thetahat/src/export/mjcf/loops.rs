//! Loops of links in a new MJCF: sites that coincide, tendons of a constant length, the motors that say which joints are driven, and a
//! pose in which the loops are closed.

use crate::export::{
    frames::{LinkFrame, quaternion_of},
    xml::{escaped, number as decimal, numbers},
};
use thetahat_ground::vector::{Vec3, add, norm, sub, times};
use thetahat_model::{
    dynamics::Model,
    robot::{Loop, LoopFrame, LoopKind, Robot},
};

/// The pairs of frames that coincide, or keep a distance.
fn pairs(of_loop: &Loop) -> Vec<[LoopFrame; 2]> {
    let points = || {
        let pair = |[from, to]: [[f64; 3]; 2]| {
            [LoopFrame::of_point(of_loop.from.joint, from), LoopFrame::of_point(of_loop.to.joint, to)]
        };
        of_loop.points().into_iter().map(pair).collect()
    };
    match of_loop.kind {
        LoopKind::Pose => vec![[of_loop.from, of_loop.to]],
        LoopKind::Point | LoopKind::Axis | LoopKind::Distance { .. } => points(),
    }
}

fn site_name(number: usize, pair: usize, end: usize) -> String {
    format!("loop_{}_{}_{}", number + 1, pair + 1, ["from", "to"][end])
}

/// The sites of a link, or of the base.
pub(super) fn sites(robot: &Robot, joint: Option<usize>) -> Vec<String> {
    let mut lines = Vec::new();
    for (number, of_loop) in robot.loops.iter().enumerate() {
        for (pair, ends) in pairs(of_loop).iter().enumerate() {
            for (end, frame) in ends.iter().enumerate().filter(|(_, frame)| frame.joint == joint) {
                lines.push(format!(
                    "<site name=\"{}\" pos=\"{}\" quat=\"{}\"/>",
                    site_name(number, pair, end),
                    numbers(&frame.origin),
                    numbers(&quaternion_of(&frame.rotation))
                ));
            }
        }
    }
    lines
}

fn tendon_name(number: usize) -> String {
    format!("loop_{}", number + 1)
}

/// Rods between two links, as tendons.
pub(super) fn tendons(robot: &Robot) -> Vec<String> {
    let tendon = |(number, of_loop): (usize, &Loop)| match of_loop.kind {
        LoopKind::Distance { .. } => {
            let [from, to] = [0, 1].map(|end| format!("<site site=\"{}\"/>", site_name(number, 0, end)));
            Some(format!("    <spatial name=\"{}\">{from}{to}</spatial>", tendon_name(number)))
        }
        LoopKind::Point | LoopKind::Axis | LoopKind::Pose => None,
    };
    let tendons: Vec<String> = robot.loops.iter().enumerate().filter_map(tendon).collect();
    if tendons.is_empty() {
        return tendons;
    }
    [vec!["  <tendon>".to_owned()], tendons, vec!["  </tendon>".to_owned()]].concat()
}

/// A point of a link where all coordinates are zero, in the frame of the base.
fn at_zero(robot: &Robot, point: &LoopFrame) -> Vec3 {
    let (mut place, mut link) = (point.origin, point.joint);
    while let Some(k) = link.filter(|&k| !robot.joints[k].of_base) {
        let frame = LinkFrame::of(robot, k);
        place = add(frame.origin, times(&frame.rotation, place));
        link = robot.joints[k].parent;
    }
    place
}

/// The constraints. MuJoCo states the length of a tendon from that where all coordinates are zero.
pub(super) fn constraints(robot: &Robot) -> Vec<String> {
    let of_loop = |(number, of_loop): (usize, &Loop)| {
        let (pairs, name) = (pairs(of_loop), escaped(&of_loop.name));
        let joined = |tag: &str, pair: usize| {
            let [from, to] = [0, 1].map(|end| site_name(number, pair, end));
            let name = if pairs.len() > 1 { format!("{name} {}", pair + 1) } else { name.clone() };
            format!("    <{tag} name=\"{name}\" site1=\"{from}\" site2=\"{to}\"/>")
        };
        match of_loop.kind {
            LoopKind::Pose => vec![joined("weld", 0)],
            LoopKind::Point | LoopKind::Axis => (0..pairs.len()).map(|pair| joined("connect", pair)).collect(),
            LoopKind::Distance { length } => {
                let longer = length - norm(sub(at_zero(robot, &of_loop.to), at_zero(robot, &of_loop.from)));
                let tendon = tendon_name(number);
                vec![format!(
                    "    <tendon name=\"{name}\" tendon1=\"{tendon}\" polycoef=\"{} 0 0 0 0\"/>",
                    decimal(longer)
                )]
            }
        }
    };
    robot.loops.iter().enumerate().flat_map(of_loop).collect()
}

/// The motors of the driven joints.
pub(super) fn motors(robot: &Robot) -> Vec<String> {
    if robot.loops.is_empty() {
        return Vec::new();
    }
    let motor = |name: String| format!("    <motor name=\"{name}\" joint=\"{name}\"/>");
    let motors = robot.coordinates().map(|joint| motor(escaped(&joint.name))).collect();
    [vec!["  <actuator>".to_owned()], motors, vec!["  </actuator>".to_owned()]].concat()
}

/// The pose in which the loops are closed.
pub(super) fn keyframe(robot: &Robot) -> Option<String> {
    let positions = Model::new(robot).closed_positions()?;
    let listed = file_order(robot).into_iter().map(|joint| decimal(positions[joint])).collect::<Vec<_>>().join(" ");
    Some(format!("  <keyframe><key name=\"closed\" qpos=\"{listed}\"/></keyframe>"))
}

/// The joints in the order in which the file nests them.
fn file_order(robot: &Robot) -> Vec<usize> {
    let carried = |by: Option<usize>| (0..robot.joints.len()).rev().filter(move |&k| robot.joints[k].parent == by);
    let (mut waiting, mut order) = (carried(None).collect::<Vec<_>>(), Vec::new());
    while let Some(joint) = waiting.pop() {
        order.push(joint);
        waiting.extend(carried(Some(joint)));
    }
    order
}
