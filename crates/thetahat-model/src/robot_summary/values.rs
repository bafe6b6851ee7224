use std::borrow::Cow;

use serde::Serialize;

use crate::robot::{Doubt, JointKind, LockedJoint, Parameter};

/// A robot as data for people and programs. Lengths in m, angles in rad, and so on in SI; joints, links and motors are
/// numbered from one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobotSummary {
    /// Name of the robot.
    pub name: String,
    /// The file it was read from.
    pub source: String,
    /// The kind of file: `URDF`, `TOML` or `TOML on URDF`.
    pub format: &'static str,
    /// Acceleration of gravity in the base frame, m/s^2.
    pub gravity: [f64; 3],
    /// `symmetric` or `asymmetric`.
    pub friction: &'static str,
    /// The moving joints.
    pub joints: Vec<JointSummary>,
    /// The locked joints of the description, which are not in `joints`.
    pub locked: Vec<LockedJoint>,
    /// Physically impossible values in the description.
    pub doubts: Vec<Doubt>,
    /// Motors to coordinates.
    pub transmission: TransmissionSummary,
    /// The standard parameters in order.
    pub standard_parameters: Vec<StandardParameterSummary>,
    /// The base parameters in order; none if they are not unique.
    pub base_parameters: Vec<BaseParameterSummary>,
    /// Why there are no base parameters.
    pub problem: Option<String>,
    /// Numbers of parameters of each kind.
    pub counts: ParameterCounts,
}

/// A moving joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointSummary {
    /// Its number, which is also that of its link.
    pub number: usize,
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// The joint whose link carries it; none for the base.
    pub parent: Option<usize>,
    /// Its index in q and tau, from one; none if it follows another joint, or loops of links move it.
    pub coordinate: Option<usize>,
    /// Whether loops of links move it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub passive: bool,
    /// The joint that it follows.
    pub mimic: Option<MimicSummary>,
    /// Further joints that it follows: its coordinate is the sum.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub also_follows: Vec<ShareSummary>,
    /// Angles `Rot(z, gamma) Rot(x, alpha) Rot(z, theta)` to the frame before, rad.
    pub gamma_alpha_theta: [f64; 3],
    /// Origin in the frame before, m.
    pub origin: [f64; 3],
    /// Rotation from the link's axes, to which its inertial parameters refer, to the axes of the joint's frame; none if they
    /// are the same.
    pub link_axes: Option<[[f64; 3]; 3]>,
    /// Smallest coordinate, rad or m.
    pub lower: Option<f64>,
    /// Largest coordinate, rad or m.
    pub upper: Option<f64>,
    /// Largest velocity, rad/s or m/s.
    pub velocity: Option<f64>,
    /// Largest torque or force, N m or N.
    pub effort: Option<f64>,
}

/// How a joint follows another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MimicSummary {
    /// Number of the other.
    pub joint: usize,
    /// Velocity per velocity of the other.
    pub ratio: f64,
    /// Coordinate when the other joint's coordinate is zero, rad or m.
    pub offset: f64,
}

/// The share of a further joint that a joint follows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShareSummary {
    /// Number of the other.
    pub joint: usize,
    /// Velocity per velocity of the other.
    pub ratio: f64,
}

/// The transmission, `q = N^-1 q_motor + offset`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TransmissionSummary {
    /// `N`, row by row.
    pub matrix: Vec<Vec<f64>>,
    /// Joint positions at the motors' zero, rad or m.
    pub offset: Vec<f64>,
    /// Torque of each motor in joint units per drive signal.
    pub drive_to_joint: Vec<f64>,
    /// Motors that turn with several joints.
    pub coupled_motors: Vec<usize>,
}

/// A standard parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StandardParameterSummary {
    /// Its name.
    pub name: String,
    /// Its unit in SI.
    pub unit: Cow<'static, str>,
    /// The value in the description; zero if none is given.
    pub a_priori: f64,
    /// Whether it acts on any torque; none if the base parameters are not unique.
    pub has_effect: Option<bool>,
    /// Its quantity and number.
    #[serde(skip)]
    pub parameter: Parameter,
}

/// A base parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BaseParameterSummary {
    /// Its name.
    pub name: String,
    /// The standard parameter that is kept.
    pub kept: String,
    /// Its formula.
    pub expression: String,
    /// The standard parameters regrouped into it, with their coefficients.
    pub regrouped: Vec<(String, f64)>,
    /// Its unit in SI.
    pub unit: Cow<'static, str>,
    /// Its value from the a-priori values.
    pub a_priori: f64,
}

/// Numbers of parameters of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct ParameterCount {
    /// Of links.
    pub inertial: usize,
    /// Of motors and their gears.
    pub motor_inertia: usize,
    /// Viscous and Coulomb.
    pub friction: usize,
    /// Of torques.
    pub offset: usize,
    /// Of terms that the description adds.
    pub terms: usize,
}

/// Numbers of parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct ParameterCounts {
    /// Standard parameters.
    pub standard: ParameterCount,
    /// Standard parameters that act on no torque.
    pub without_effect: ParameterCount,
    /// Base parameters, by the kind of the kept parameter.
    pub base: ParameterCount,
}

impl ParameterCount {
    /// All kinds together.
    #[must_use]
    pub fn all(&self) -> usize {
        self.inertial + self.motor_inertia + self.friction + self.offset + self.terms
    }
}

impl RobotSummary {
    /// Number of coordinates.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.joints.iter().filter(|joint| joint.coordinate.is_some()).count()
    }
}
