//! What a format can say of a robot, and what it cannot.

use super::{format::Format, xml::number};
use crate::robot::{
    Friction, JointQuantity, Parameter, Quantity, Robot, Transmission,
};

/// Gravity of simulators where a file does not say it, m/s^2.
const USUAL_GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// The robot as a format says it: its torques are those of the exported file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Said {
    /// The robot with the friction, drives and terms that the format has.
    pub(super) robot: Robot,
    /// Its standard parameters.
    pub(super) parameters: Vec<f64>,
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
    let mut rest = Robot {
        friction: Friction::Symmetric,
        transmission: Transmission::direct(robot.coordinate_count()),
        terms: Vec::new(),
        term_descriptions: Vec::new(),
        ..robot.clone()
    };
    let of = |quantity, joint| value(robot, parameters, quantity, joint);
    let said = |p: &Parameter| {
        let (joint, own) = (p.number - 1, of(p.quantity, p.number - 1));
        let mean = |a, b| 0.5 * (of(Quantity::Joint(a), joint) + of(Quantity::Joint(b), joint));
        match (p.quantity, robot.friction) {
            (Quantity::Joint(JointQuantity::Ia), _) if !says_motor_inertia(format) => 0.0,
            (Quantity::Joint(JointQuantity::Off), _) => 0.0,
            (Quantity::Joint(JointQuantity::Fv), Friction::Asymmetric) => mean(JointQuantity::Fvp, JointQuantity::Fvn),
            (Quantity::Joint(JointQuantity::Fc), Friction::Asymmetric) => mean(JointQuantity::Fcp, JointQuantity::Fcn),
            (Quantity::Link(_) | Quantity::Joint(_) | Quantity::Motor(_) | Quantity::Term(_), _) => own,
        }
    };
    let table = rest.parameter_table();
    let values: Vec<f64> = table.iter().map(said).collect();
    rest.a_priori = table.iter().map(Parameter::name).zip(values.iter().copied()).collect();
    Said { unsaid: unsaid(robot, parameters, format), robot: rest, parameters: values }
}

fn says_motor_inertia(format: Format) -> bool {
    match format {
        Format::Urdf => false,
        Format::Mjcf => true,
    }
}

fn value(robot: &Robot, parameters: &[f64], quantity: Quantity, joint: usize) -> f64 {
    robot.parameter_table().index(quantity, joint).map_or(0.0, |i| parameters[i])
}

/// What a format cannot say of a robot, a sentence each.
fn unsaid(robot: &Robot, parameters: &[f64], format: Format) -> Vec<String> {
    let listed = |is_meant: &dyn Fn(&Parameter) -> bool| {
        let table = robot.parameter_table();
        let with = |(p, v): (&Parameter, &f64)| {
            (*v != 0.0 && is_meant(p)).then(|| format!("{} = {} {}", p.name(), number(*v), p.unit).trim_end().to_owned())
        };
        table.iter().zip(parameters).filter_map(with).collect::<Vec<_>>().join(", ")
    };
    let joint = |wanted: &'static [JointQuantity]| {
        move |p: &Parameter| matches!(p.quantity, Quantity::Joint(quantity) if wanted.contains(&quantity))
    };
    use JointQuantity::{Fcn, Fcp, Fvn, Fvp, Ia, Off};
    let title = format.title();
    let mut lines = Vec::new();
    let mut add = |list: String, before: &str, after: &str| {
        if !list.is_empty() {
            lines.push(format!("{before}: {list}{after}"));
        }
    };
    if !says_motor_inertia(format) {
        let after = "; give it where the file is used, as armature";
        add(listed(&joint(&[Ia])), &format!("{title} has no motor inertia, seen at the joint"), after);
    }
    add(listed(&joint(&[Off])), &format!("{title} has no constant torque"), "; add it to the torques");
    let after = "; the file has the mean of both directions";
    add(listed(&joint(&[Fvp, Fcp, Fvn, Fcn])), &format!("{title} has one friction for both directions"), after);
    let coupled = |p: &Parameter| p.quantity.is_coupled_motor();
    add(listed(&coupled), &format!("{title} has no coupled motors"), "");
    let terms = |p: &Parameter| p.quantity.is_term();
    add(listed(&terms), &format!("{title} has no torque terms of a user's own"), "");
    if format == Format::Urdf && robot.gravity != USUAL_GRAVITY {
        let [x, y, z] = robot.gravity.map(number);
        lines.push(format!("{title} has no gravity: the robot's is {x} {y} {z} m/s^2 in the frame of its base"));
    }
    lines
}
