//! The ways in which a record is known to go wrong, and how each is put right.

use super::{
    Code,
    affine::{Affine, diagonal},
};
use crate::{
    linear_algebra::Matrix,
    robot::{JointKind, Robot},
};

/// How many times smaller a correction of all joints must make the squared residual; also one of a zero. Such
/// corrections are few; on the clean records the best makes it no smaller (1.00).
const COMMON_LIMIT: f64 = 1.15;
/// The same for a correction of one joint: at most 1.12 on the clean records.
const SINGLE_LIMIT: f64 = 1.5;
/// The same for exchanges and for two signs at once, of which there are many: at most 1.50 on the clean records.
const MANY_LIMIT: f64 = 2.0;
/// A way in which a record goes wrong, and its correction.
pub(super) struct Hypothesis {
    pub(super) code: Code,
    /// From zero.
    pub(super) joint: Option<usize>,
    pub(super) correction: Affine,
    /// How many times smaller it must make the squared residual.
    pub(super) limit: f64,
    /// Whether it changes the sign of the joint's power.
    pub(super) flips_power: bool,
    /// What is wrong, to follow "the torques fit ... better if".
    pub(super) words: String,
    pub(super) remedy: &'static str,
}

impl Hypothesis {
    fn new(code: Code, joint: Option<usize>, correction: Affine, words: String, remedy: &'static str) -> Self {
        let limit = if joint.is_some() { SINGLE_LIMIT } else { COMMON_LIMIT };
        Self { code, joint, correction, limit, flips_power: false, words, remedy }
    }

    fn with_limit(self, limit: f64) -> Self {
        Self { limit, ..self }
    }

    fn flipping(self) -> Self {
        Self { flips_power: true, ..self }
    }
}

/// All hypotheses for a robot, the simple ones first.
pub(super) fn hypotheses(robot: &Robot) -> Vec<Hypothesis> {
    let mut all = units(robot);
    all.extend(sides(robot));
    all.extend(zeros(robot));
    all.extend(signs(robot));
    all.extend(exchanges(robot));
    all
}

const SIGN: &str = "turn the sign of the channel by its gain, or of the row of the motor in [transmission] matrix";
const ORDER: &str = "put the columns of the channel in the order of the robot's joints";
const UNIT: &str = "set the unit of the channel in [recording]";
const SIDE: &str = "set side = \"motor\" or \"joint\" of the channel in [recording], or the ratios in [transmission]";

/// Degrees and radians, millimetres and metres, of all joints and of each.
fn units(robot: &Robot) -> Vec<Hypothesis> {
    let factor = |j: usize| match robot.joints[j].kind {
        JointKind::Revolute => 1.0_f64.to_radians(),
        _ => 1e-3,
    };
    let scale = |joints: &[usize], up: bool| {
        let of = |j: usize| if up { 1.0 / factor(j) } else { factor(j) };
        Affine::scaled_positions(&select(robot, joints, &of), &vec![0.0; robot.coordinate_count()])
    };
    each_and_all(robot)
        .into_iter()
        .flat_map(|(joint, joints)| {
            let whose = whose(joint);
            let down = format!("{whose} position is taken from degrees (or mm), not from rad (or m)");
            let up = format!("{whose} position is taken as rad (or m): it was converted from degrees (or mm) twice");
            [
                Hypothesis::new(Code::PositionScale, joint, scale(&joints, false), down, UNIT),
                Hypothesis::new(Code::PositionScale, joint, scale(&joints, true), up, UNIT),
            ]
        })
        .collect()
}

/// Motor side and joint side, where they differ.
fn sides(robot: &Robot) -> Vec<Hypothesis> {
    let ratio = |j: usize| robot.transmission.matrix().at(j, j);
    let geared = |joints: &[usize]| joints.iter().any(|&j| ratio(j) != 1.0 && ratio(j) != 0.0);
    let sides = |(joint, joints): (Option<usize>, Vec<usize>)| {
        let mut both = sides_of_positions(robot, joint);
        both.extend(sides_of_torques(robot, joint, &joints));
        both
    };
    each_and_all(robot).into_iter().filter(|(_, joints)| geared(joints)).flat_map(sides).collect()
}

fn sides_of_positions(robot: &Robot, joint: Option<usize>) -> Vec<Hypothesis> {
    let whose = whose(joint);
    let (to_joint, to_motor) = match joint {
        None => (motor_to_joint(robot), joint_to_motor(robot)),
        Some(j) => (Some(one_to_joint(robot, j)), one_to_motor(robot, j)),
    };
    let motor = to_joint.map(|c| (c, format!("{whose} position is taken from the motor side")));
    let twice = format!("{whose} position is taken as it is on the joint side: it went through the gear twice");
    let corrections = motor.into_iter().chain([(to_motor, twice)]);
    corrections.map(|(c, words)| Hypothesis::new(Code::PositionScale, joint, c, words, SIDE)).collect()
}

fn sides_of_torques(robot: &Robot, joint: Option<usize>, joints: &[usize]) -> Vec<Hypothesis> {
    let whose = whose(joint);
    let ratio = |j: usize| robot.transmission.matrix().at(j, j);
    let up = Affine::scaled_torques(&select(robot, joints, &ratio));
    let down = Affine::scaled_torques(&select(robot, joints, &|j| 1.0 / ratio(j)));
    let motor = format!("{whose} torque is taken from the motor side");
    let twice = format!("{whose} torque is taken as it is on the joint side: it went through the gear twice");
    let hypothesis = |(c, words)| Hypothesis::new(Code::TorqueScale, joint, c, words, SIDE);
    [(up, motor), (down, twice)].map(hypothesis).into()
}

/// `q_j' = q_j / N_jj + o_j`.
fn one_to_joint(robot: &Robot, j: usize) -> Affine {
    let ratio = robot.transmission.matrix().at(j, j);
    let shift =
        (0..robot.coordinate_count()).map(|i| if i == j { robot.transmission.offset()[j] } else { 0.0 }).collect();
    let position = diagonal(&select(robot, &[j], &|_| 1.0 / ratio));
    Affine { position, shift, torque: Matrix::identity(robot.coordinate_count()) }
}

/// `q_j' = N_jj (q_j - o_j)`.
fn one_to_motor(robot: &Robot, j: usize) -> Affine {
    let (ratio, offset) = (robot.transmission.matrix().at(j, j), robot.transmission.offset()[j]);
    let shift = (0..robot.coordinate_count()).map(|i| if i == j { -ratio * offset } else { 0.0 }).collect();
    let position = diagonal(&select(robot, &[j], &|_| ratio));
    Affine { position, shift, torque: Matrix::identity(robot.coordinate_count()) }
}

/// `q' = N^-1 q + o`.
fn motor_to_joint(robot: &Robot) -> Option<Affine> {
    let position = robot.transmission.matrix().inverse()?;
    let shift = robot.transmission.offset().to_vec();
    Some(Affine { position, shift, ..Affine::identity(robot.coordinate_count()) })
}

/// `q' = N (q - o)`.
fn joint_to_motor(robot: &Robot) -> Affine {
    let position = robot.transmission.matrix().clone();
    let shift = position.times(robot.transmission.offset()).iter().map(|v| -v).collect();
    Affine { position, shift, ..Affine::identity(robot.coordinate_count()) }
}

/// The offsets of the transmission left out or added twice.
fn zeros(robot: &Robot) -> Vec<Hypothesis> {
    let offset = robot.transmission.offset();
    if offset.iter().all(|o| *o == 0.0) {
        return Vec::new();
    }
    let of = |sign: f64, j: Option<usize>| {
        let entry = |(i, o): (usize, &f64)| if j.is_none_or(|j| j == i) { sign * o } else { 0.0 };
        Affine::shifted(offset.iter().enumerate().map(entry).collect())
    };
    let remedy = "check offset_deg in [transmission], and whether the positions already hold it";
    let with_offset = (0..offset.len()).filter(|&j| offset[j] != 0.0).map(Some);
    std::iter::once(None)
        .chain(with_offset)
        .flat_map(|joint| {
            let whose = whose(joint);
            [(1.0, "is added to"), (-1.0, "is taken from")].map(|(sign, verb)| {
                let words = format!("the transmission's offset {verb} {whose} position");
                Hypothesis::new(Code::PositionZero, joint, of(sign, joint), words, remedy).with_limit(COMMON_LIMIT)
            })
        })
        .collect()
}

/// Each joint's position or torque with the other sign.
fn signs(robot: &Robot) -> Vec<Hypothesis> {
    let offset = robot.transmission.offset();
    let flip = |j: usize| select(robot, &[j], &|_| -1.0);
    let sign = |j: usize| {
        let torque = Affine::scaled_torques(&flip(j));
        let position = Affine::scaled_positions(&flip(j), offset);
        let both = Affine { torque: torque.torque.clone(), ..position.clone() };
        let number = j + 1;
        let (torque_words, position_words) = (
            format!("the torque of joint {number} has the other sign"),
            format!("the position of joint {number} has the other sign"),
        );
        let both_words = format!("position and torque of joint {number} have the other sign");
        [
            Hypothesis::new(Code::TorqueSign, Some(j), torque, torque_words, SIGN).flipping(),
            Hypothesis::new(Code::PositionSign, Some(j), position, position_words, SIGN).flipping(),
            Hypothesis::new(Code::PositionSign, Some(j), both, both_words, SIGN).with_limit(MANY_LIMIT),
        ]
    };
    (0..robot.coordinate_count()).flat_map(sign).collect()
}

/// Positions, torques or both of each pair exchanged.
fn exchanges(robot: &Robot) -> Vec<Hypothesis> {
    let n = robot.coordinate_count();
    let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b)));
    let exchange = |(a, b): (usize, usize)| {
        [(true, false, "the positions"), (false, true, "the torques"), (true, true, "positions and torques")].map(
            |(positions, torques, what)| {
                let correction = Affine::exchanged(n, (a, b), positions, torques);
                let words = format!("{what} of joints {} and {} are exchanged", a + 1, b + 1);
                Hypothesis::new(Code::JointsSwapped, Some(a), correction, words, ORDER).with_limit(MANY_LIMIT)
            },
        )
    };
    pairs.flat_map(exchange).collect()
}

/// All joints together, and each by itself where there are several.
fn each_and_all(robot: &Robot) -> Vec<(Option<usize>, Vec<usize>)> {
    let n = robot.coordinate_count();
    let each = (0..n).filter(|_| n > 1).map(|j| (Some(j), vec![j]));
    std::iter::once((None, (0..n).collect())).chain(each).collect()
}

/// A value for each of `joints`, one for the others.
fn select(robot: &Robot, joints: &[usize], value: &dyn Fn(usize) -> f64) -> Vec<f64> {
    (0..robot.coordinate_count()).map(|j| if joints.contains(&j) { value(j) } else { 1.0 }).collect()
}

fn whose(joint: Option<usize>) -> String {
    joint.map_or_else(|| "every joint's".to_owned(), |j| format!("joint {}'s", j + 1))
}
