//! A plain model file: everything that the torques depend on, as JSON.

use std::collections::BTreeMap;

use serde::Serialize;

use super::represented::RepresentedRobot;
use thetahat_model::robot::{Joint, JointKind, Loop, LoopKind, Parameter, Robot, TermDescription};

#[derive(Serialize)]
struct Model<'a> {
    thetahat: &'a str,
    content: &'a str,
    about: Vec<String>,
    robot: &'a str,
    gravity: [f64; 3],
    friction: &'a str,
    joints: Vec<JointEntry<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    loops: Vec<LoopEntry<'a>>,
    transmission: TransmissionEntry<'a>,
    terms: &'a [TermDescription],
    parameters: BTreeMap<String, Value>,
}

#[derive(Serialize)]
struct JointEntry<'a> {
    name: &'a str,
    kind: JointKind,
    parent: Option<&'a str>,
    rotation: [[f64; 3]; 3],
    origin: [f64; 3],
    link_axes: [[f64; 3]; 3],
    mimic: Option<MimicEntry<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    also_follows: Vec<ShareEntry<'a>>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    passive: bool,
    lower: Option<f64>,
    upper: Option<f64>,
    velocity: Option<f64>,
    effort: Option<f64>,
}

/// Points of two links, in the links' axes, that coincide or keep a distance.
#[derive(Serialize)]
struct LoopEntry<'a> {
    name: &'a str,
    from: Option<&'a str>,
    to: Option<&'a str>,
    points: Vec<[[f64; 3]; 2]>,
    distance: Option<f64>,
    near: Vec<(&'a str, f64)>,
}

#[derive(Serialize)]
struct ShareEntry<'a> {
    joint: &'a str,
    ratio: f64,
}

#[derive(Serialize)]
struct MimicEntry<'a> {
    joint: &'a str,
    ratio: f64,
    offset: f64,
}

#[derive(Serialize)]
struct TransmissionEntry<'a> {
    matrix: Vec<Vec<f64>>,
    offset: &'a [f64],
    drive_gain: &'a [f64],
}

#[derive(Serialize)]
struct Value {
    value: f64,
    /// What friction by load takes masses from.
    a_priori: f64,
    unit: String,
}

/// The JSON of a robot; `about` says where it comes from.
pub(super) fn json(represented: &RepresentedRobot, about: &[String]) -> Result<String, serde_json::Error> {
    let robot = &represented.robot;
    let a_priori = robot.a_priori_parameters();
    let value = |((p, value), a_priori): ((&Parameter, &f64), &f64)| {
        (p.name(), Value { value: *value, a_priori: *a_priori, unit: p.unit.to_string() })
    };
    let matrix = robot.transmission.matrix();
    let model = Model {
        thetahat: env!("CARGO_PKG_VERSION"),
        content: "model",
        about: about.to_vec(),
        robot: &robot.name,
        gravity: robot.gravity,
        friction: robot.friction.name(),
        joints: robot.joints.iter().map(|joint| entry(robot, joint)).collect(),
        loops: robot.loops.iter().map(|of_loop| loop_entry(robot, of_loop)).collect(),
        transmission: TransmissionEntry {
            matrix: (0..matrix.rows()).map(|i| (0..matrix.columns()).map(|j| matrix.at(i, j)).collect()).collect(),
            offset: robot.transmission.offset(),
            drive_gain: robot.transmission.drive_gain(),
        },
        terms: &robot.term_descriptions,
        parameters: represented.table.iter().zip(&represented.parameters).zip(&a_priori).map(value).collect(),
    };
    Ok(serde_json::to_string_pretty(&model)? + "\n")
}

fn loop_entry<'a>(robot: &'a Robot, of_loop: &'a Loop) -> LoopEntry<'a> {
    let name = |k: usize| robot.joints[k].name.as_str();
    LoopEntry {
        name: &of_loop.name,
        from: of_loop.from.joint.map(name),
        to: of_loop.to.joint.map(name),
        points: of_loop.points(),
        distance: match of_loop.kind {
            LoopKind::Distance { length } => Some(length),
            LoopKind::Point | LoopKind::Axis | LoopKind::Pose => None,
        },
        near: of_loop.near.iter().map(|(joint, position)| (name(*joint), *position)).collect(),
    }
}

fn entry<'a>(robot: &'a Robot, joint: &'a Joint) -> JointEntry<'a> {
    let name = |k: usize| robot.joints[k].name.as_str();
    JointEntry {
        name: &joint.name,
        kind: joint.kind,
        parent: joint.parent.map(name),
        rotation: joint.placement.rotation(),
        origin: joint.placement.origin,
        link_axes: joint.link_axes.unwrap_or(thetahat_ground::vector::IDENTITY),
        mimic: joint.mimic.map(|m| MimicEntry { joint: name(m.of), ratio: m.ratio, offset: m.offset }),
        also_follows: joint.also_follows.iter().map(|s| ShareEntry { joint: name(s.of), ratio: s.ratio }).collect(),
        passive: joint.passive,
        lower: joint.limits.lower,
        upper: joint.limits.upper,
        velocity: joint.limits.velocity,
        effort: joint.limits.effort,
    }
}
