//! The known faults of recordings, and their corrections.

use crate::checks::{
    finding::Code,
    fit::affine::{Affine, diagonal},
    remedy_step::{RemedySignal, RemedyStep},
};
use thetahat_model::robot::{JointKind, Robot};

/// Factor by which a correction of all joints, of the unit of some, or of a zero, must reduce the squared residual. There are few such
/// corrections; on the clean recordings the best one has 1.00, and for units of some 1.05.
const COMMON_LIMIT: f64 = 1.15;
/// The same for a correction of one joint; the clean recordings have at most 1.12.
const SINGLE_LIMIT: f64 = 1.5;
/// The same for exchanges and for two signs at once, of which there are many; the clean recordings have at most 1.50.
const MANY_LIMIT: f64 = 2.0;

/// The same for any order of the joints.
const ORDER_LIMIT: f64 = 4.0;

/// A possible fault of a recording, and its correction.
pub(in crate::checks) struct Hypothesis {
    pub(in crate::checks) code: Code,
    /// From zero; `None` for all coordinates.
    pub(in crate::checks) coordinate: Option<usize>,
    pub(in crate::checks) correction: Affine,
    /// Factor by which it must reduce the squared residual.
    pub(in crate::checks) limit: f64,
    /// Whether it changes the sign of the joint's power.
    pub(in crate::checks) flips_power: bool,
    /// The fault, to follow "the torques fit ... better if".
    pub(in crate::checks) text: String,
    pub(in crate::checks) remedy: String,
    /// The side of the gears, where a wrong one of all joints is the fault.
    side: Option<RemedyStep>,
}

/// The coordinates of a correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scope {
    All,
    One(usize),
}

impl Scope {
    /// All coordinates together, and each alone if there are several.
    fn all_of(robot: &Robot) -> impl Iterator<Item = Self> {
        let n = robot.coordinate_count();
        std::iter::once(Self::All).chain((0..n).filter(move |_| n > 1).map(Self::One))
    }

    fn contains(self, coordinate: usize) -> bool {
        match self {
            Self::All => true,
            Self::One(own) => own == coordinate,
        }
    }

    fn coordinate(self) -> Option<usize> {
        match self {
            Self::All => None,
            Self::One(coordinate) => Some(coordinate),
        }
    }

    /// A value for each coordinate in the scope, one for the others.
    fn select(self, robot: &Robot, value: &dyn Fn(usize) -> f64) -> Vec<f64> {
        (0..robot.coordinate_count()).map(|j| if self.contains(j) { value(j) } else { 1.0 }).collect()
    }

    fn possessive(self, robot: &Robot) -> String {
        match self {
            Self::All => "every joint's".to_owned(),
            Self::One(coordinate) => format!("joint {}'s", robot.joint_of(coordinate) + 1),
        }
    }
}

/// The unit that the positions of some joints are in, where those of the others are in the stated one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum UnitOfSome {
    Radians,
    Degrees,
}

impl UnitOfSome {
    /// What the stated positions are to be multiplied by.
    pub(super) fn factor(self) -> f64 {
        match self {
            Self::Radians => 1.0_f64.to_degrees(),
            Self::Degrees => 1.0_f64.to_radians(),
        }
    }
}

impl Hypothesis {
    fn new(code: Code, scope: Scope, correction: Affine, text: String, remedy: impl Into<String>) -> Self {
        let limit = match scope {
            Scope::All => COMMON_LIMIT,
            Scope::One(_) => SINGLE_LIMIT,
        };
        Self {
            code,
            coordinate: scope.coordinate(),
            correction,
            limit,
            flips_power: false,
            text,
            remedy: remedy.into(),
            side: None,
        }
    }

    /// The channels of joint j are those of joint `order[j]`.
    pub(super) fn of_order(robot: &Robot, order: &[usize], signal: RemedySignal) -> Self {
        let (what, columns) = match signal {
            RemedySignal::Torque => ("the torques", "torque columns"),
            RemedySignal::Position => ("the positions", "position columns"),
            RemedySignal::Both => ("positions and torques", "position and torque columns"),
        };
        let number = |&j: &usize| (robot.joint_of(j) + 1).to_string();
        let numbers = order.iter().map(number).collect::<Vec<_>>().join(", ");
        let text = format!("{what} of the joints are taken in the order {numbers}");
        let remedy = format!("take the {columns} in this order in the experiment file");
        let first = (0..order.len()).find(|&j| order[j] != j).unwrap_or(0);
        let correction = Affine::ordered(order, signal);
        Self::new(Code::JointsSwapped, Scope::One(first), correction, text, remedy).with_limit(ORDER_LIMIT)
    }

    /// The positions of some joints are in another unit than those of the others.
    pub(super) fn of_mixed_units(robot: &Robot, coordinates: &[usize], unit: UnitOfSome) -> Self {
        let mut sorted = coordinates.to_vec();
        sorted.sort_unstable();
        let numbers: Vec<String> = sorted.iter().map(|&j| (robot.joint_of(j) + 1).to_string()).collect();
        let joints = numbers.join(", ");
        let text = match unit {
            UnitOfSome::Radians => {
                format!("the positions of joints {joints} are in rad already: they were converted from degrees twice")
            }
            UnitOfSome::Degrees => format!("the positions of joints {joints} are in degrees, not in rad"),
        };
        let factor = |j| if sorted.contains(&j) { unit.factor() } else { 1.0 };
        let factors: Vec<f64> = (0..robot.coordinate_count()).map(factor).collect();
        let correction = Affine::scaled_positions(&factors, &vec![0.0; factors.len()]);
        Self::new(Code::PositionScale, Scope::One(sorted[0]), correction, text, UNIT).with_limit(COMMON_LIMIT)
    }

    fn with_limit(self, limit: f64) -> Self {
        Self { limit, ..self }
    }

    /// The same, of a signal of all joints whose side is stated wrongly.
    fn of_side(self, scope: Scope, signal: RemedySignal, at_motor: bool) -> Self {
        let side = (scope == Scope::All).then_some(RemedyStep::Side { signal, at_motor });
        Self { side, ..self }
    }

    /// The change of the settings that corrects it.
    pub(in crate::checks) fn step(&self) -> Option<RemedyStep> {
        self.side.clone().or_else(|| self.correction.step())
    }

    /// Whether it is the same wrong sign of another joint.
    pub(in crate::checks) fn is_sign_like(&self, other: &Self) -> bool {
        let is_sign = matches!(self.code, Code::PositionSign | Code::TorqueSign);
        is_sign && (self.code, self.flips_power) == (other.code, other.flips_power)
    }

    fn flipping(self) -> Self {
        Self { flips_power: true, ..self }
    }
}

/// All hypotheses for a robot, the simple ones first.
pub(in crate::checks) fn hypotheses(robot: &Robot) -> Vec<Hypothesis> {
    let mut all = units(robot);
    all.extend(sides(robot));
    all.extend(zeros(robot));
    all.extend(signs(robot));
    all.extend(exchanges(robot));
    all
}

const SIGN: &str = "change the sign of the channel's gain, or of the motor's row in [transmission] matrix";
const UNIT: &str = "set the unit of the channel in [recording]";
const SIDE: &str = "set side = \"motor\" or \"joint\" of the channel in [recording], or the ratios in [transmission]";

/// Degrees and radians, millimetres and metres, of all joints and of each.
fn units(robot: &Robot) -> Vec<Hypothesis> {
    let factor = |j: usize| match robot.joints[robot.joint_of(j)].kind {
        JointKind::Revolute => 1.0_f64.to_radians(),
        JointKind::Prismatic => 1e-3,
    };
    let scaled = |factor: Vec<f64>| Affine::scaled_positions(&factor, &vec![0.0; factor.len()]);
    let both = |scope: Scope| {
        let whose = scope.possessive(robot);
        let down = format!("{whose} position is in degrees (or mm), not in rad (or m)");
        let up = format!("{whose} position is in rad (or m) already: it was converted from degrees (or mm) twice");
        let by_down = scaled(scope.select(robot, &factor));
        let by_up = scaled(scope.select(robot, &|j| 1.0 / factor(j)));
        [(by_down, down), (by_up, up)].map(|(c, text)| Hypothesis::new(Code::PositionScale, scope, c, text, UNIT))
    };
    Scope::all_of(robot).flat_map(both).collect()
}

/// Motor side and joint side, where they differ.
fn sides(robot: &Robot) -> Vec<Hypothesis> {
    let is_geared = |j: usize| ratio(robot, j) != 1.0 && ratio(robot, j) != 0.0;
    let geared = |scope: &Scope| (0..robot.coordinate_count()).any(|j| scope.contains(j) && is_geared(j));
    let sides = |scope: Scope| {
        let mut both = sides_of_positions(robot, scope);
        both.extend(sides_of_torques(robot, scope));
        both
    };
    Scope::all_of(robot).filter(geared).flat_map(sides).collect()
}

/// Motor positions per joint position of a coordinate, without the coupling.
fn ratio(robot: &Robot, j: usize) -> f64 {
    robot.transmission.matrix().at(j, j)
}

fn sides_of_positions(robot: &Robot, scope: Scope) -> Vec<Hypothesis> {
    let whose = scope.possessive(robot);
    let (to_joint, to_motor) = match scope {
        Scope::All => (motor_to_joint(robot), joint_to_motor(robot)),
        Scope::One(j) => (Some(one_to_joint(robot, j)), one_to_motor(robot, j)),
    };
    let motor = to_joint.map(|c| (c, true, format!("{whose} position is on the motor side")));
    let twice = format!("{whose} position is on the joint side already: it was converted by the gear twice");
    let corrections = motor.into_iter().chain([(to_motor, false, twice)]);
    let of = |(correction, at_motor, text)| {
        let hypothesis = Hypothesis::new(Code::PositionScale, scope, correction, text, SIDE);
        hypothesis.of_side(scope, RemedySignal::Position, at_motor)
    };
    corrections.map(of).collect()
}

fn sides_of_torques(robot: &Robot, scope: Scope) -> [Hypothesis; 2] {
    let whose = scope.possessive(robot);
    let up = Affine::scaled_torques(&scope.select(robot, &|j| ratio(robot, j)));
    let down = Affine::scaled_torques(&scope.select(robot, &|j| 1.0 / ratio(robot, j)));
    let motor = format!("{whose} torque is on the motor side");
    let twice = format!("{whose} torque is on the joint side already: it was converted by the gear twice");
    [(up, true, motor), (down, false, twice)].map(|(correction, at_motor, text)| {
        let hypothesis = Hypothesis::new(Code::TorqueScale, scope, correction, text, SIDE);
        hypothesis.of_side(scope, RemedySignal::Torque, at_motor)
    })
}

/// `q_j' = q_j / N_jj + o_j`.
fn one_to_joint(robot: &Robot, j: usize) -> Affine {
    let position = diagonal(&Scope::One(j).select(robot, &|_| 1.0 / ratio(robot, j)));
    let shift = only(robot, j, robot.transmission.offset()[j]);
    Affine { position, shift, ..Affine::identity(robot.coordinate_count()) }
}

/// `q_j' = N_jj (q_j - o_j)`.
fn one_to_motor(robot: &Robot, j: usize) -> Affine {
    let position = diagonal(&Scope::One(j).select(robot, &|_| ratio(robot, j)));
    let shift = only(robot, j, -ratio(robot, j) * robot.transmission.offset()[j]);
    Affine { position, shift, ..Affine::identity(robot.coordinate_count()) }
}

/// A value for coordinate `j`, zero for the others.
fn only(robot: &Robot, j: usize, value: f64) -> Vec<f64> {
    (0..robot.coordinate_count()).map(|i| if i == j { value } else { 0.0 }).collect()
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
    let shifted = |scope: Scope, sign: f64| {
        let entry = |(j, o): (usize, &f64)| if scope.contains(j) { sign * o } else { 0.0 };
        Affine::shifted(offset.iter().enumerate().map(entry).collect())
    };
    let remedy = "check offset_deg in [transmission], and whether the positions already contain it";
    let both = |scope: Scope| {
        [(1.0, "is added to"), (-1.0, "is subtracted from")].map(|(sign, verb)| {
            let text = format!("the transmission's offset {verb} {} position", scope.possessive(robot));
            let correction = shifted(scope, sign);
            Hypothesis::new(Code::PositionZero, scope, correction, text, remedy).with_limit(COMMON_LIMIT)
        })
    };
    let with_offset = (0..offset.len()).filter(|&j| offset[j] != 0.0).map(Scope::One);
    std::iter::once(Scope::All).chain(with_offset).flat_map(both).collect()
}

/// Each joint's position, torque or both with the opposite sign.
fn signs(robot: &Robot) -> Vec<Hypothesis> {
    let offset = robot.transmission.offset();
    let sign = |j: usize| {
        let scope = Scope::One(j);
        let flip = scope.select(robot, &|_| -1.0);
        let torque = Affine::scaled_torques(&flip);
        let position = Affine::scaled_positions(&flip, offset);
        let both = Affine { torque: torque.torque.clone(), ..position.clone() };
        let number = robot.joint_of(j) + 1;
        let torque_text = format!("the torque of joint {number} has the opposite sign");
        let position_text = format!("the position of joint {number} has the opposite sign");
        let both_text = format!("position and torque of joint {number} have the opposite sign");
        [
            Hypothesis::new(Code::TorqueSign, scope, torque, torque_text, SIGN).flipping(),
            Hypothesis::new(Code::PositionSign, scope, position, position_text, SIGN).flipping(),
            Hypothesis::new(Code::PositionSign, scope, both, both_text, SIGN).with_limit(MANY_LIMIT),
        ]
    };
    (0..robot.coordinate_count()).flat_map(sign).collect()
}

/// Positions, torques or both of each pair exchanged.
fn exchanges(robot: &Robot) -> Vec<Hypothesis> {
    let n = robot.coordinate_count();
    let exchange = move |a: usize, b: usize| {
        let positions = Affine::exchanged_positions(n, a, b);
        let torques = Affine::exchanged_torques(n, a, b);
        let both = Affine { torque: torques.torque.clone(), ..positions.clone() };
        let kinds = [
            (positions, "the positions", "position columns"),
            (torques, "the torques", "torque columns"),
            (both, "positions and torques", "position and torque columns"),
        ];
        let (first, second) = (robot.joint_of(a) + 1, robot.joint_of(b) + 1);
        kinds.map(|(correction, what, columns)| {
            let remedy = format!("exchange the {columns} of joints {first} and {second} in the experiment file");
            let text = format!("{what} of joints {first} and {second} are exchanged");
            Hypothesis::new(Code::JointsSwapped, Scope::One(a), correction, text, remedy).with_limit(MANY_LIMIT)
        })
    };
    (0..n).flat_map(|a| (a + 1..n).flat_map(move |b| exchange(a, b))).collect()
}
