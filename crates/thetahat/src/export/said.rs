//! What a format can say of a robot, and what it cannot.

use super::{
    coupling::{Tendon, tendons, unsayable},
    format::Format,
    xml::number,
};
use crate::robot::{Friction, JointQuantity, MotorQuantity, Parameter, Quantity, Robot, Transmission};

/// Gravity of simulators where a file does not say it, m/s^2.
const USUAL_GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// The robot as a format says it: its torques are those of the exported file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Said {
    /// The robot with the friction, drives and terms that the format has.
    pub(super) robot: Robot,
    /// Its standard parameters.
    pub(super) parameters: Vec<f64>,
    /// Its coupled motors, where the format has them.
    pub(super) tendons: Vec<Tendon>,
    /// What the format cannot say, a sentence each.
    pub(super) unsaid: Vec<String>,
}

impl Said {
    /// The value of a quantity of a joint.
    pub(super) fn of_joint(&self, quantity: JointQuantity, joint: usize) -> f64 {
        value(&self.robot, &self.parameters, Quantity::Joint(quantity), joint)
    }
}

/// What a format says of a robot with standard parameters.
pub(super) fn said(robot: &Robot, parameters: &[f64], format: Format) -> Said {
    let of_format = Saying { robot, parameters, format };
    if format == Format::Json {
        return Said { robot: robot.clone(), parameters: parameters.to_vec(), tendons: Vec::new(), unsaid: Vec::new() };
    }
    let transmission = match format {
        Format::Mjcf => robot.transmission.clone(),
        Format::Urdf | Format::Sdf | Format::Json => Transmission::direct(robot.coordinate_count()),
    };
    let mut rest = Robot {
        friction: Friction::Symmetric,
        transmission,
        terms: Vec::new(),
        term_descriptions: Vec::new(),
        ..robot.clone()
    };
    let lost = of_format.lost_of_motors();
    let table = rest.parameter_table();
    let values: Vec<f64> = table.iter().map(|parameter| of_format.value(parameter, &lost)).collect();
    rest.a_priori = table.iter().map(Parameter::name).zip(values.iter().copied()).collect();
    let tendons = if format == Format::Mjcf { tendons(&rest, &values) } else { Vec::new() };
    Said { unsaid: of_format.unsaid(&lost), tendons, robot: rest, parameters: values }
}

fn value(robot: &Robot, parameters: &[f64], quantity: Quantity, joint: usize) -> f64 {
    robot.parameter_table().index(quantity, joint).map_or(0.0, |i| parameters[i])
}

/// A robot in a format that cannot say everything.
struct Saying<'a> {
    robot: &'a Robot,
    parameters: &'a [f64],
    format: Format,
}

impl Saying<'_> {
    fn says_motor_inertia(&self) -> bool {
        match self.format {
            Format::Urdf | Format::Sdf => false,
            Format::Mjcf | Format::Json => true,
        }
    }

    fn says_gravity(&self) -> bool {
        match self.format {
            Format::Urdf | Format::Sdf => false,
            Format::Mjcf | Format::Json => true,
        }
    }

    /// The quantities of coupled motors that the format has not.
    fn lost_of_motors(&self) -> Vec<MotorQuantity> {
        match self.format {
            Format::Urdf | Format::Sdf => MotorQuantity::ALL.to_vec(),
            Format::Mjcf => unsayable(self.robot, self.parameters),
            Format::Json => Vec::new(),
        }
    }

    /// A parameter as the format has it.
    fn value(&self, parameter: &Parameter, lost: &[MotorQuantity]) -> f64 {
        use JointQuantity::{Fc, Fcn, Fcp, Fv, Fvn, Fvp, Ia, Off};
        let joint = parameter.number - 1;
        let of = |quantity| value(self.robot, self.parameters, quantity, joint);
        let mean = |a, b| 0.5 * (of(Quantity::Joint(a)) + of(Quantity::Joint(b)));
        match (parameter.quantity, self.robot.friction) {
            (Quantity::Joint(Ia), _) if !self.says_motor_inertia() => 0.0,
            (Quantity::Joint(Off), _) => 0.0,
            (Quantity::Joint(Fv), Friction::Asymmetric) => mean(Fvp, Fvn),
            (Quantity::Joint(Fc), Friction::Asymmetric) => mean(Fcp, Fcn),
            (Quantity::Motor(quantity), _) if lost.contains(&quantity) => 0.0,
            (quantity @ (Quantity::Link(_) | Quantity::Joint(_) | Quantity::Motor(_) | Quantity::Term(_)), _) => {
                of(quantity)
            }
        }
    }

    /// What the format cannot say, a sentence each.
    fn unsaid(&self, lost: &[MotorQuantity]) -> Vec<String> {
        use JointQuantity::{Fcn, Fcp, Fvn, Fvp, Ia, Off};
        let joint = |wanted: &'static [JointQuantity]| {
            self.listed(|p| matches!(p.quantity, Quantity::Joint(quantity) if wanted.contains(&quantity)))
        };
        let coupled = self.listed(|p| matches!(p.quantity, Quantity::Motor(quantity) if lost.contains(&quantity)));
        let terms = self.listed(|p| p.quantity.is_term());
        let inertia = if self.says_motor_inertia() { String::new() } else { joint(&[Ia]) };
        let of_motors = match self.format {
            Format::Mjcf => "such coupled motors, as a joint's own armature or damping would be below zero",
            Format::Urdf | Format::Sdf | Format::Json => "coupled motors",
        };
        let both = "one friction for both directions, and has their mean";
        let title = self.format.title();
        let all = [
            ("motor inertia (seen at the joint; give it where the file is used, as armature)", inertia),
            ("constant torque of a joint; add it to the torques", joint(&[Off])),
            (both, joint(&[Fvp, Fcp, Fvn, Fcn])),
            (of_motors, coupled),
            ("torque terms of a user's own", terms),
        ];
        let verb = |what: &str| if what == both { "has" } else { "has no" };
        let line =
            |(what, list): (&str, String)| (!list.is_empty()).then(|| format!("{title} {} {what}: {list}", verb(what)));
        all.into_iter().filter_map(line).chain(self.unsaid_of_the_tree()).collect()
    }

    /// Gravity, and joints that follow others.
    fn unsaid_of_the_tree(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let title = self.format.title();
        if !self.says_gravity() && self.robot.gravity != USUAL_GRAVITY {
            let [x, y, z] = self.robot.gravity.map(number);
            lines.push(format!("{title} has no gravity: the robot's is {x} {y} {z} m/s^2 in the frame of its base"));
        }
        if self.format == Format::Mjcf && self.robot.joints.iter().any(|joint| joint.mimic.is_some()) {
            lines.push(format!("{title} has no joints that follow others but by soft constraints (<equality>)"));
        }
        lines
    }

    /// The parameters that are meant and are not zero, with their values.
    fn listed(&self, is_meant: impl Fn(&Parameter) -> bool) -> String {
        let with = |(p, v): (&Parameter, &f64)| {
            let shown = || format!("{} = {} {}", p.name(), number(*v), p.unit).trim_end().to_owned();
            (*v != 0.0 && is_meant(p)).then(shown)
        };
        let table = self.robot.parameter_table();
        table.iter().zip(self.parameters).filter_map(with).collect::<Vec<_>>().join(", ")
    }
}
