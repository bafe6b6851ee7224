//! What `thetahat model` shows of a robot: its structure, its standard and its base parameters.

use serde::Serialize;

use crate::{
    base_parameters::BaseParameters,
    dynamics::Model,
    robot::{Joint, JointKind, Parameter, Placement, Robot, RobotSource, Role},
};

/// A robot as data for people and programs. Lengths in m, angles in rad, and so on in SI; joints, links and motors are
/// numbered from one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelReport {
    /// Name of the robot.
    pub name: String,
    /// The file that it was read from.
    pub source: String,
    /// What that is: `URDF`, `TOML` or `TOML on URDF`.
    pub format: &'static str,
    /// Acceleration of gravity in the base frame, m/s^2.
    pub gravity: [f64; 3],
    /// `symmetric` or `asymmetric`.
    pub friction: &'static str,
    /// The moving joints.
    pub joints: Vec<JointReport>,
    /// Motors to coordinates.
    pub transmission: TransmissionReport,
    /// The standard parameters in order.
    pub standard_parameters: Vec<StandardParameterReport>,
    /// The base parameters in order; none where they are not clear.
    pub base_parameters: Vec<BaseParameterReport>,
    /// Why there are no base parameters.
    pub problem: Option<String>,
    /// How many there are of each kind.
    pub counts: Counts,
}

/// A moving joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointReport {
    /// Its number, which is that of its link.
    pub number: usize,
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// The joint whose link carries it; none for the base.
    pub parent: Option<usize>,
    /// Its place in q and tau, from one; none where it follows another joint.
    pub coordinate: Option<usize>,
    /// The joint that it follows.
    pub mimic: Option<MimicReport>,
    /// Angles `Rot(z, gamma) Rot(x, alpha) Rot(z, theta)` to the frame before, rad.
    pub gamma_alpha_theta: [f64; 3],
    /// Origin in the frame before, m.
    pub origin: [f64; 3],
    /// Rotation from the link's axes, to which its inertial parameters refer, to those of the joint's frame; none where
    /// they are the same.
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
pub struct MimicReport {
    /// Number of the other.
    pub joint: usize,
    /// Velocity per velocity of the other.
    pub ratio: f64,
    /// Coordinate where that of the other is zero, rad or m.
    pub offset: f64,
}

/// The transmission, `q = N^-1 q_motor + offset`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TransmissionReport {
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
pub struct StandardParameterReport {
    /// Its name.
    pub name: String,
    /// Its unit in SI.
    pub unit: &'static str,
    /// The value that the description gives; zero where it gives none.
    pub a_priori: f64,
    /// Whether it acts on any torque; none where the base parameters are not clear.
    pub has_effect: Option<bool>,
    #[serde(skip)]
    pub(super) parameter: Parameter,
}

/// A base parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BaseParameterReport {
    /// Its name.
    pub name: String,
    /// The standard parameter that is kept.
    pub kept: String,
    /// Its formula.
    pub expression: String,
    /// The standard parameters regrouped into it, with their coefficients.
    pub regrouped: Vec<(String, f64)>,
    /// Its unit in SI.
    pub unit: &'static str,
    /// Its value by the a-priori values.
    pub a_priori: f64,
}

/// Numbers of parameters of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Count {
    /// Of links.
    pub inertial: usize,
    /// Of motors and their gears.
    pub motor_inertia: usize,
    /// Viscous and Coulomb.
    pub friction: usize,
    /// Of torques.
    pub offset: usize,
}

/// Numbers of parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// Standard parameters.
    pub standard: Count,
    /// Those of them that act on no torque.
    pub without_effect: Count,
    /// Base parameters, by what is kept.
    pub base: Count,
}

impl Count {
    fn of<'p>(parameters: impl Iterator<Item = &'p Parameter>) -> Self {
        let mut count = Self::default();
        for parameter in parameters {
            *match parameter.quantity.role() {
                Role::Inertial => &mut count.inertial,
                Role::MotorInertia => &mut count.motor_inertia,
                Role::ViscousFriction | Role::CoulombFriction => &mut count.friction,
                Role::Load => &mut count.offset,
            } += 1;
        }
        count
    }

    /// All kinds together.
    #[must_use]
    pub fn all(&self) -> usize {
        self.inertial + self.motor_inertia + self.friction + self.offset
    }
}

impl ModelReport {
    /// The report of a robot that was read from `source`.
    #[must_use]
    pub fn new(source: &RobotSource, robot: &Robot) -> Self {
        let model = Model::new(robot);
        let (base, problem) = match BaseParameters::of(&model, &[]) {
            Ok(base) => (Some(base), None),
            Err(error) => (None, Some(error.to_string())),
        };
        let a_priori = robot.a_priori_parameters();
        let standard = standard_parameters(&model, &a_priori, base.as_ref());
        let base_parameters = base.as_ref().map(|base| base_parameters(&model, base, &a_priori)).unwrap_or_default();
        Self {
            name: robot.name.clone(),
            source: source.path().display().to_string(),
            format: source.format(),
            gravity: robot.gravity,
            friction: robot.friction.name(),
            joints: joints(robot),
            transmission: transmission(robot),
            counts: counts(&model, &standard, base.as_ref()),
            standard_parameters: standard,
            base_parameters,
            problem,
        }
    }

    /// Number of coordinates.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.joints.iter().filter(|joint| joint.coordinate.is_some()).count()
    }
}

fn joints(robot: &Robot) -> Vec<JointReport> {
    let coordinates = robot.coordinate_joints();
    let joint = |(j, joint): (usize, &Joint)| {
        let Placement { gamma, alpha, theta, origin } = joint.placement;
        JointReport {
            number: j + 1,
            name: joint.name.clone(),
            kind: joint.kind,
            parent: joint.parent.map(|p| p + 1),
            coordinate: coordinates.iter().position(|&c| c == j).map(|c| c + 1),
            mimic: joint.mimic.map(|m| MimicReport { joint: m.of + 1, ratio: m.ratio, offset: m.offset }),
            gamma_alpha_theta: [gamma, alpha, theta],
            origin,
            link_axes: joint.link_axes,
            lower: joint.limits.lower,
            upper: joint.limits.upper,
            velocity: joint.limits.velocity,
            effort: joint.limits.effort,
        }
    };
    robot.joints.iter().enumerate().map(joint).collect()
}

fn transmission(robot: &Robot) -> TransmissionReport {
    let transmission = &robot.transmission;
    let n = transmission.joints();
    let row = |i: usize| (0..n).map(|j| transmission.matrix().at(i, j)).collect();
    TransmissionReport {
        matrix: (0..n).map(row).collect(),
        offset: transmission.offset().to_vec(),
        drive_to_joint: transmission.drive_to_joint_units(),
        coupled_motors: transmission.coupled_motors().iter().map(|i| i + 1).collect(),
    }
}

fn standard_parameters(model: &Model, a_priori: &[f64], base: Option<&BaseParameters>) -> Vec<StandardParameterReport> {
    let mut acts = vec![false; a_priori.len()];
    for parameter in base.iter().flat_map(|base| base.parameters()) {
        acts[parameter.kept] = true;
        parameter.regrouped.iter().for_each(|&(i, _)| acts[i] = true);
    }
    let report = |(i, parameter): (usize, &Parameter)| StandardParameterReport {
        name: parameter.name(),
        unit: parameter.unit,
        a_priori: a_priori[i],
        has_effect: base.map(|_| acts[i]),
        parameter: parameter.clone(),
    };
    model.parameter_table().iter().enumerate().map(report).collect()
}

fn base_parameters(model: &Model, base: &BaseParameters, a_priori: &[f64]) -> Vec<BaseParameterReport> {
    let name = |i: usize| model.parameter_table().get(i).name();
    let values = base.from_standard(a_priori);
    let report = |(parameter, a_priori): (&crate::base_parameters::BaseParameter, f64)| BaseParameterReport {
        name: parameter.name.clone(),
        kept: name(parameter.kept),
        expression: parameter.expression.clone(),
        regrouped: parameter.regrouped.iter().map(|&(i, c)| (name(i), c)).collect(),
        unit: parameter.unit,
        a_priori,
    };
    base.parameters().iter().zip(values).map(report).collect()
}

fn counts(model: &Model, standard: &[StandardParameterReport], base: Option<&BaseParameters>) -> Counts {
    let table = model.parameter_table();
    let idle = standard.iter().filter(|p| p.has_effect == Some(false));
    Counts {
        standard: Count::of(table.iter()),
        without_effect: Count::of(idle.map(|p| &p.parameter)),
        base: Count::of(base.iter().flat_map(|base| base.parameters()).map(|p| table.get(p.kept))),
    }
}
