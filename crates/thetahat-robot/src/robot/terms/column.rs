use std::sync::Arc;

use super::expression::{Expression, Variable};
use crate::robot::{Bound, Role};

/// One column of the torque model in addition to those of the links and drives, with its parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct TermColumn {
    /// Name of the parameter, such as `fs3` or `k_balancer`.
    pub parameter: String,
    /// Unit of the parameter in SI.
    pub unit: String,
    /// What kind of torque it gives.
    pub role: Role,
    /// The physical bound of the parameter.
    pub bound: Bound,
    /// Index of the joint to which the parameter belongs.
    pub joint: usize,
    /// The torque for a unit of the parameter.
    pub shape: Shape,
    /// A recorded channel that multiplies it.
    pub factor: Option<ChannelFactor>,
    /// Index of its term in the list, from zero.
    pub term: usize,
}

/// A factor `value - reference` of a recorded channel, such as a temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelFactor {
    /// Name of the channel.
    pub channel: String,
    /// The value at which the factor is zero.
    pub reference: f64,
}

/// The torque for a unit of a term's parameter, as a function of the state. `q` and `dq` belong to the term's joint, `s` is the
/// sign of `dq`, smooth in simulations.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// `1`.
    Constant,
    /// `q - rest`.
    Deflection {
        /// The angle or position without torque, rad or m.
        rest: f64,
    },
    /// `dq`.
    Velocity,
    /// `s dq`.
    AbsoluteVelocity,
    /// `dq |dq|^(n - 1)`.
    VelocityPower {
        /// The exponent n.
        exponent: u8,
    },
    /// `s`.
    Sign,
    /// `s` times a function that falls with the velocity.
    Stribeck(Stribeck),
    /// `s` times the magnitude of the joint's gravity torque at the a-priori parameters.
    Load,
    /// The sine or cosine of a multiple of a motor's angle, as a torque of that motor in joint units.
    Harmonic {
        /// The motor's angle per coordinate, a row of the motor-joint matrix: coordinate and weight.
        angle: Vec<(usize, f64)>,
        /// The torque on coordinates per torque of the motor in joint units: coordinate and weight.
        torque: Vec<(usize, f64)>,
        /// The multiple.
        multiple: f64,
        /// Whether it is the sine.
        sine: bool,
    },
    /// A force along the line between two points of the robot: a unit of it pulls them together with 1 N, or, if `free_length`
    /// is given, with the excess of their distance over it in metres.
    BetweenPoints(TwoPoints),
    /// A user-defined expression.
    Expression(Arc<Expression>),
}

/// The decay of the friction above Coulomb friction with rising velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stribeck {
    /// The law.
    pub law: StribeckLaw,
    /// The velocity `vs`, rad/s or m/s.
    pub velocity: f64,
    /// The exponent `delta`.
    pub exponent: f64,
}

/// The law of the decay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StribeckLaw {
    /// `exp(-|dq / vs|^delta)`.
    Exponential,
    /// `1 / (1 + |dq / vs|^delta)`.
    Rational,
}

/// A force between two points as a function of their distance `l`.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoPoints {
    /// One end.
    pub from: LinkPoint,
    /// The other.
    pub to: LinkPoint,
    /// The tension for a unit of the parameter.
    pub tension: Cylinder,
}

/// The tension for a unit of the parameter: positive pulls the points together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cylinder {
    /// A constant.
    Constant(f64),
    /// `l - length`.
    Linear {
        /// The length without tension, m.
        length: f64,
    },
    /// `sign (h / (h - sign (l - length)))^n`: gas that is compressed as the points move apart (sign 1), or together (-1).
    Gas {
        /// 1 pulls, -1 pushes.
        sign: f64,
        /// The length at which the force is the parameter, m.
        length: f64,
        /// Volume of the gas there over the area of the piston, m.
        gas_length: f64,
        /// The polytropic exponent n.
        exponent: f64,
    },
}

/// A point of a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkPoint {
    /// Index of the link's joint; none for the base.
    pub joint: Option<usize>,
    /// The point in the link's own axes, from the origin of the joint's frame, m.
    pub position: [f64; 3],
}

impl Shape {
    /// Whether it depends on the state of its own joint or of two points, and on no other coordinate or torque.
    pub(in crate::robot) fn is_of_joints_or_points(&self) -> bool {
        match self {
            Self::Constant
            | Self::Deflection { .. }
            | Self::Velocity
            | Self::AbsoluteVelocity
            | Self::VelocityPower { .. }
            | Self::Sign
            | Self::Stribeck(_)
            | Self::BetweenPoints(_) => true,
            Self::Load | Self::Harmonic { .. } | Self::Expression(_) => false,
        }
    }

    /// Whether it depends on accelerations, so that it cannot be simulated.
    #[must_use]
    pub fn needs_acceleration(&self) -> bool {
        match self {
            Self::Expression(expression) => expression.needs_acceleration(),
            Self::Constant
            | Self::Deflection { .. }
            | Self::Velocity
            | Self::AbsoluteVelocity
            | Self::VelocityPower { .. }
            | Self::Sign
            | Self::Stribeck(_)
            | Self::Load
            | Self::Harmonic { .. }
            | Self::BetweenPoints(_) => false,
        }
    }
}

/// The recorded channels that columns use, without duplicates.
#[must_use]
pub fn channels_of(columns: &[TermColumn]) -> Vec<String> {
    let mut names = Vec::new();
    for column in columns {
        names.extend(column.factor.iter().map(|factor| factor.channel.clone()));
        if let Shape::Expression(expression) = &column.shape {
            let channel = |v: &Variable| if let Variable::Channel(name) = v { Some(name.clone()) } else { None };
            names.extend(expression.variables().iter().filter_map(channel));
        }
    }
    names.sort_unstable();
    names.dedup();
    names
}
