//! Gross faults of the record, by the scale of the fit: the record is put right in every way that is known to go wrong,
//! and the correction that makes the fit much better is what was wrong.

use super::{
    Code, Severity,
    affine::{Affine, diagonal},
    chain::{Chain, Motion, at, squared_residual},
    examination::{Evidence, Examination},
};
use crate::robot::{JointKind, Robot};

/// A correction that leaves less than this part of the squared residual names the fault. On the clean records none
/// leaves less than 0.8.
const LEFT_LIMIT: f64 = 0.5;
/// A later hypothesis of the list must be better than an earlier one by this factor.
const BETTER: f64 = 0.9;
/// Rows of all joints per parameter in the screening.
const ROWS_PER_PARAMETER: usize = 8;
/// Faults that are looked for one after the other.
const MOST_FAULTS: usize = 4;

/// A way in which a record goes wrong, and its correction.
pub(super) struct Hypothesis {
    pub(super) code: Code,
    /// From zero.
    pub(super) joint: Option<usize>,
    pub(super) correction: Affine,
    /// What is wrong, to follow "the torques fit ... better if".
    pub(super) words: String,
    pub(super) remedy: &'static str,
}

/// Corrects the chain by every fault that is found.
pub(super) fn check(exam: &mut Examination<'_>, chain: &mut Chain<'_>) {
    let hypotheses = hypotheses(exam.subject.robot);
    for round in 0..MOST_FAULTS {
        let Some((best, left)) = best(chain, &hypotheses) else { return };
        let hypothesis = &hypotheses[best];
        // The evidence grows with the fault: how many times larger the squared residual is than with the correction.
        let evidence = Evidence {
            code: hypothesis.code,
            joint: hypothesis.joint,
            value: 1.0 / left,
            unit: "times the squared residual",
            limit: 1.0 / LEFT_LIMIT,
        };
        if round > 0 && left >= LEFT_LIMIT {
            return;
        }
        let words = || {
            let message = format!("the torques fit {:.1} times better if {}", left.sqrt().recip(), hypothesis.words);
            (message, hypothesis.remedy.to_owned())
        };
        if !exam.judge(evidence, Severity::Problem, words) {
            return;
        }
        chain.correct(&hypothesis.correction);
    }
}

/// The hypothesis that leaves the smallest part of the squared residual, and that part.
fn best(chain: &Chain<'_>, hypotheses: &[Hypothesis]) -> Option<(usize, f64)> {
    let screening = Screening::new(chain);
    let as_it_is = screening.squares(chain, &Affine::identity(chain.joints()))?;
    let mut best: Option<(usize, f64)> = None;
    for (h, hypothesis) in hypotheses.iter().enumerate() {
        let Some(squares) = screening.squares(chain, &hypothesis.correction) else { continue };
        let left = squares / as_it_is;
        if best.is_none_or(|(_, smallest)| left < BETTER * smallest) {
            best = Some((h, left));
        }
    }
    best.filter(|b| b.1.is_finite())
}

/// A few rows of the record, unfiltered.
struct Screening {
    motion: Motion,
    torque: crate::series::Series,
}

impl Screening {
    fn new(chain: &Chain<'_>) -> Self {
        let wanted = ROWS_PER_PARAMETER * chain.subject.base.len() / chain.joints() + 1;
        let step = (chain.rows() / wanted).max(1);
        let samples: Vec<usize> = chain.kept.iter().step_by(step).copied().collect();
        let Motion { q, dq, ddq } = &chain.motion;
        let motion = Motion { q: at(q, &samples), dq: at(dq, &samples), ddq: at(ddq, &samples) };
        Self { motion, torque: at(&chain.torque, &samples) }
    }

    /// Squared residual, relative to the torques as corrected; none where it is not finite.
    fn squares(&self, chain: &Chain<'_>, correction: &Affine) -> Option<f64> {
        let x = chain.raw_matrix(&correction.motion(&self.motion));
        let torque = correction.torque(&self.torque);
        let y: Vec<f64> = (0..torque.channels()).flat_map(|j| torque.channel(j)).collect();
        let squares = squared_residual(&x, &y, chain.joints());
        squares.is_finite().then_some(squares)
    }
}

/// All hypotheses for a robot, the simple ones first.
fn hypotheses(robot: &Robot) -> Vec<Hypothesis> {
    let mut all = units(robot);
    all.extend(sides(robot));
    all.extend(zeros(robot));
    all.extend(signs(robot));
    all.extend(exchanges(robot));
    all
}

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
        Affine::scaled_positions(&select(robot, joints, &of), &vec![0.0; robot.joint_count()])
    };
    each_and_all(robot)
        .into_iter()
        .flat_map(|(joint, joints)| {
            let whose = whose(joint);
            let down = format!("{whose} position is taken from degrees (or mm), not from rad (or m)");
            let up = format!("{whose} position is taken as rad (or m): it was converted from degrees (or mm) twice");
            [
                Hypothesis { code: Code::PositionScale, joint, correction: scale(&joints, false), words: down, remedy: UNIT },
                Hypothesis { code: Code::PositionScale, joint, correction: scale(&joints, true), words: up, remedy: UNIT },
            ]
        })
        .collect()
}

/// Motor side and joint side, where they differ.
fn sides(robot: &Robot) -> Vec<Hypothesis> {
    let n = robot.joint_count();
    let (matrix, offset) = (robot.transmission.matrix(), robot.transmission.offset());
    let ratio = |j: usize| matrix.at(j, j);
    let mut all = Vec::new();
    for (joint, joints) in each_and_all(robot) {
        if joints.iter().all(|&j| ratio(j) == 1.0 || ratio(j) == 0.0) {
            continue;
        }
        let whose = whose(joint);
        let mut add = |code, correction, words| all.push(Hypothesis { code, joint, correction, words, remedy: SIDE });
        let (to_joint, to_motor) = match joint {
            None => (motor_to_joint(robot), Some(joint_to_motor(robot))),
            Some(j) => {
                let down = select(robot, &[j], &|j| 1.0 / ratio(j));
                let up = select(robot, &[j], &ratio);
                let kept = |j: &usize| if joints.contains(j) { offset[*j] } else { 0.0 };
                let shift: Vec<f64> = (0..n).map(|j| kept(&j)).collect();
                let back = shift.iter().zip(&up).map(|(o, r)| -o * r).collect();
                let down = Affine { position: diagonal(&down), shift, torque: crate::linear_algebra::Matrix::identity(n) };
                (Some(down), Some(Affine { position: diagonal(&up), shift: back, ..Affine::identity(n) }))
            }
        };
        if let Some(correction) = to_joint {
            add(Code::PositionScale, correction, format!("{whose} position is taken from the motor side"));
        }
        if let Some(correction) = to_motor {
            let words = format!("{whose} position is taken as it is on the joint side: it went through the gear twice");
            add(Code::PositionScale, correction, words);
        }
        let torques = |up: bool| {
            Affine::scaled_torques(&select(robot, &joints, &|j| if up { ratio(j) } else { 1.0 / ratio(j) }))
        };
        let words = format!("{whose} torque is taken from the motor side");
        add(Code::TorqueScale, torques(true), words);
        let words = format!("{whose} torque is taken as it is on the joint side: it went through the gear twice");
        add(Code::TorqueScale, torques(false), words);
    }
    all
}

/// `q' = N^-1 q + o`.
fn motor_to_joint(robot: &Robot) -> Option<Affine> {
    let position = robot.transmission.matrix().inverse()?;
    let shift = robot.transmission.offset().to_vec();
    Some(Affine { position, shift, ..Affine::identity(robot.joint_count()) })
}

/// `q' = N (q - o)`.
fn joint_to_motor(robot: &Robot) -> Affine {
    let position = robot.transmission.matrix().clone();
    let shift = position.times(robot.transmission.offset()).iter().map(|v| -v).collect();
    Affine { position, shift, ..Affine::identity(robot.joint_count()) }
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
            [(1.0, "is added to"), (-1.0, "is taken from")].map(|(sign, verb)| Hypothesis {
                code: Code::PositionZero,
                joint,
                correction: of(sign, joint),
                words: format!("the transmission's offset {verb} {whose} position"),
                remedy,
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
        [
            (Code::TorqueSign, torque, format!("the torque of joint {number} has the other sign")),
            (Code::PositionSign, position, format!("the position of joint {number} has the other sign")),
            (Code::PositionSign, both, format!("position and torque of joint {number} have the other sign")),
        ]
        .map(|(code, correction, words)| Hypothesis {
            code,
            joint: Some(j),
            correction,
            words,
            remedy: "turn the sign of the channel by its gain, or of the row of the motor in [transmission] matrix",
        })
    };
    (0..robot.joint_count()).flat_map(sign).collect()
}

/// Positions, torques or both of each pair exchanged.
fn exchanges(robot: &Robot) -> Vec<Hypothesis> {
    let n = robot.joint_count();
    let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b)));
    let exchange = |(a, b): (usize, usize)| {
        [(true, false, "the positions"), (false, true, "the torques"), (true, true, "positions and torques")].map(
            |(positions, torques, what)| Hypothesis {
                code: Code::JointsSwapped,
                joint: Some(a),
                correction: Affine::exchanged(n, (a, b), positions, torques),
                words: format!("{what} of joints {} and {} are exchanged", a + 1, b + 1),
                remedy: "put the columns of the channel in the order of the robot's joints",
            },
        )
    };
    pairs.flat_map(exchange).collect()
}

/// All joints together, and each by itself where there are several.
fn each_and_all(robot: &Robot) -> Vec<(Option<usize>, Vec<usize>)> {
    let n = robot.joint_count();
    let each = (0..n).filter(|_| n > 1).map(|j| (Some(j), vec![j]));
    std::iter::once((None, (0..n).collect())).chain(each).collect()
}

/// A value for each of `joints`, one for the others.
fn select(robot: &Robot, joints: &[usize], value: &dyn Fn(usize) -> f64) -> Vec<f64> {
    (0..robot.joint_count()).map(|j| if joints.contains(&j) { value(j) } else { 1.0 }).collect()
}

fn whose(joint: Option<usize>) -> String {
    joint.map_or_else(|| "every joint's".to_owned(), |j| format!("joint {}'s", j + 1))
}
