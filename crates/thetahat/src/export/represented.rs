//! The part of a robot that a format can represent, and what it cannot.

use super::{
    coupling::{Tendon, not_representable, tendons},
    format::ExportFormat,
    xml::{number, numbers},
};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::robot::{
    Friction, INERTIAL, JointQuantity, MotorQuantity, Parameter, ParameterTable, Quantity, Robot, Transmission,
};

/// Gravity of simulators if a file does not state it, m/s^2.
const USUAL_GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// The robot as a format represents it: its torques are those of the exported file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RepresentedRobot {
    /// The robot with the friction, drives and terms that the format has.
    pub(super) robot: Robot,
    /// Its parameters.
    pub(super) table: ParameterTable,
    /// Their values.
    pub(super) parameters: Vec<f64>,
    /// Its coupled motors, where the format has them.
    pub(super) tendons: Vec<Tendon>,
    /// What the format cannot represent, a sentence each.
    pub(super) not_represented: Vec<String>,
}

impl RepresentedRobot {
    /// The value of a quantity of a joint.
    pub(super) fn of_joint(&self, quantity: JointQuantity, joint: usize) -> f64 {
        self.table.value(&self.parameters, Quantity::Joint(quantity), joint)
    }

    /// The inertial parameters of link `k`.
    pub(super) fn inertial_of(&self, k: usize) -> [f64; 10] {
        INERTIAL.map(|quantity| self.table.value(&self.parameters, Quantity::Link(quantity), k))
    }
}

/// A robot with standard parameters, as a format represents it.
///
/// `has_servos` says that actuators of the file hold the constant torques of the joints.
pub(super) fn represented(
    robot: &Robot,
    parameters: &[f64],
    format: ExportFormat,
    has_servos: bool,
) -> RepresentedRobot {
    let table = robot.parameter_table();
    if format == ExportFormat::Json {
        return RepresentedRobot {
            robot: robot.clone(),
            table,
            parameters: parameters.to_vec(),
            tendons: Vec::new(),
            not_represented: Vec::new(),
        };
    }
    let of_format = Conversion { robot, table, parameters, format, has_servos };
    let transmission = match format {
        ExportFormat::Mjcf => robot.transmission.clone(),
        ExportFormat::Urdf
        | ExportFormat::Sdf
        | ExportFormat::Json
        | ExportFormat::Pace
        | ExportFormat::Isaac
        | ExportFormat::Bam => Transmission::direct(robot.coordinate_count()),
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
    let tendons = if format == ExportFormat::Mjcf { tendons(&rest, &values) } else { Vec::new() };
    RepresentedRobot {
        not_represented: of_format.not_represented(&lost),
        tendons,
        robot: rest,
        table,
        parameters: values,
    }
}

/// The conversion of a robot to a format that cannot represent everything.
struct Conversion<'a> {
    robot: &'a Robot,
    table: ParameterTable,
    parameters: &'a [f64],
    format: ExportFormat,
    has_servos: bool,
}

impl Conversion<'_> {
    fn has_motor_inertia(&self) -> bool {
        match self.format {
            ExportFormat::Urdf | ExportFormat::Sdf => false,
            ExportFormat::Mjcf | ExportFormat::Json | ExportFormat::Pace | ExportFormat::Isaac | ExportFormat::Bam => {
                true
            }
        }
    }

    fn has_gravity(&self) -> bool {
        match self.format {
            ExportFormat::Urdf | ExportFormat::Sdf => false,
            ExportFormat::Mjcf | ExportFormat::Json | ExportFormat::Pace | ExportFormat::Isaac | ExportFormat::Bam => {
                true
            }
        }
    }

    /// Whether the format has zeros of encoders.
    fn has_zeros(&self) -> bool {
        match self.format {
            ExportFormat::Urdf | ExportFormat::Mjcf | ExportFormat::Sdf | ExportFormat::Isaac => false,
            ExportFormat::Json | ExportFormat::Pace | ExportFormat::Bam => true,
        }
    }

    /// What a format of drives does not have.
    fn links(&self) -> Option<String> {
        match self.format {
            ExportFormat::Urdf | ExportFormat::Mjcf | ExportFormat::Sdf | ExportFormat::Json => None,
            ExportFormat::Pace | ExportFormat::Isaac | ExportFormat::Bam => {
                let title = self.format.title();
                Some(format!("{title} has no links: give it the robot's description, or its export as URDF or MJCF"))
            }
        }
    }

    /// The quantities of coupled motors that the format does not have.
    fn lost_of_motors(&self) -> Vec<MotorQuantity> {
        match self.format {
            ExportFormat::Urdf | ExportFormat::Sdf | ExportFormat::Pace | ExportFormat::Isaac | ExportFormat::Bam => {
                MotorQuantity::ALL.to_vec()
            }
            ExportFormat::Mjcf => not_representable(self.robot, self.parameters),
            ExportFormat::Json => Vec::new(),
        }
    }

    /// A parameter as the format has it.
    fn value(&self, parameter: &Parameter, lost: &[MotorQuantity]) -> f64 {
        use JointQuantity::{Fc, Fcn, Fcp, Fv, Fvn, Fvp, Ia, Off};
        let joint = parameter.number - 1;
        let of = |quantity| self.table.value(self.parameters, quantity, joint);
        let mean = |a, b| 0.5 * (of(Quantity::Joint(a)) + of(Quantity::Joint(b)));
        match (parameter.quantity, self.robot.friction) {
            (Quantity::Joint(Ia), _) if !self.has_motor_inertia() => 0.0,
            (Quantity::Joint(Off), _) => 0.0,
            (Quantity::Joint(Fv), Friction::Asymmetric) => mean(Fvp, Fvn),
            (Quantity::Joint(Fc), Friction::Asymmetric) => mean(Fcp, Fcn),
            (Quantity::Motor(quantity), _) if lost.contains(&quantity) => 0.0,
            (quantity @ (Quantity::Link(_) | Quantity::Joint(_) | Quantity::Motor(_) | Quantity::Term(_)), _) => {
                of(quantity)
            }
        }
    }

    /// What the format cannot represent, a sentence each.
    fn not_represented(&self, lost: &[MotorQuantity]) -> Vec<String> {
        use JointQuantity::{Fcn, Fcp, Fvn, Fvp, Ia, Off};
        let joint = |wanted: &'static [JointQuantity]| {
            self.listed(|p| matches!(p.quantity, Quantity::Joint(quantity) if wanted.contains(&quantity)))
        };
        let coupled = self.listed(|p| matches!(p.quantity, Quantity::Motor(quantity) if lost.contains(&quantity)));
        let terms = self.listed(|p| p.quantity.is_term());
        let constant = if self.has_servos { String::new() } else { joint(&[Off]) };
        let inertia = if self.has_motor_inertia() { String::new() } else { joint(&[Ia]) };
        let of_motors = match self.format {
            ExportFormat::Mjcf => "such coupled motors, as a joint's own armature or damping would be below zero",
            ExportFormat::Urdf
            | ExportFormat::Sdf
            | ExportFormat::Json
            | ExportFormat::Pace
            | ExportFormat::Isaac
            | ExportFormat::Bam => "coupled motors",
        };
        let both = "one friction for both directions, and has their mean";
        let title = self.format.title();
        let all = [
            ("motor inertia (seen at the joint; give it where the file is used, as armature)", inertia),
            ("constant torque of a joint; add it to the torques", constant),
            (both, joint(&[Fvp, Fcp, Fvn, Fcn])),
            (of_motors, coupled),
            ("torque terms of a user's own", terms),
        ];
        let verb = |what: &str| if what == both { "has" } else { "has no" };
        let line =
            |(what, list): (&str, String)| (!list.is_empty()).then(|| format!("{title} {} {what}: {list}", verb(what)));
        all.into_iter()
            .filter_map(line)
            .chain(self.links())
            .chain(self.not_represented_of_drives())
            .chain(self.not_represented_of_the_tree())
            .collect()
    }

    /// Gear ratios, offsets and gains of the motors. The ratios of motors that are not coupled are in a URDF.
    fn not_represented_of_drives(&self) -> Option<String> {
        let transmission = &self.robot.transmission;
        let n = transmission.joints();
        let has_ratios = self.format == ExportFormat::Urdf && transmission.coupled_motors().is_empty();
        let row = |i: usize| numbers(&(0..n).map(|j| transmission.matrix().at(i, j)).collect::<Vec<_>>());
        let ratios = if has_ratios || *transmission.matrix() == Matrix::identity(n) {
            None
        } else {
            Some(format!("motor positions per joint positions [{}]", (0..n).map(row).collect::<Vec<_>>().join("; ")))
        };
        let of = |what: &str, values: &[f64], usual: f64| {
            values.iter().any(|v| *v != usual).then(|| format!("{what} {}", numbers(values)))
        };
        let offset = of("joint positions at the motors' zero", transmission.offset(), 0.0);
        let offset = if self.has_zeros() { None } else { offset };
        let gain = of("drive gains", transmission.drive_gain(), 1.0);
        let all: Vec<String> = [ratios, offset, gain].into_iter().flatten().collect();
        let title = self.format.title();
        (!all.is_empty()).then(|| format!("{title} has no drives; {}, in rad or m", all.join(", ")))
    }

    /// Gravity, and joints that follow others.
    fn not_represented_of_the_tree(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let title = self.format.title();
        if !self.has_gravity() && self.robot.gravity != USUAL_GRAVITY {
            let [x, y, z] = self.robot.gravity.map(number);
            lines.push(format!("{title} has no gravity: the robot's is {x} {y} {z} m/s^2 in the frame of its base"));
        }
        if self.format == ExportFormat::Mjcf && self.robot.joints.iter().any(|joint| joint.mimic.is_some()) {
            lines.push(format!("{title} has no joints that follow others but by soft constraints (<equality>)"));
        }
        if self.format == ExportFormat::Mjcf && !self.robot.loops.is_empty() {
            lines.push(format!("{title} has no loops but by soft constraints (<equality>)"));
        }
        if self.robot.joints.iter().any(|joint| !joint.also_follows.is_empty()) {
            lines.push(format!(
                "{title} has no joints that follow several others: other programs take the first <mimic> of each"
            ));
        }
        lines
    }

    /// The selected parameters that are not zero, with their values.
    fn listed(&self, is_selected: impl Fn(&Parameter) -> bool) -> String {
        let with = |(p, v): (&Parameter, &f64)| {
            let shown = || format!("{} = {} {}", p.name(), number(*v), p.unit).trim_end().to_owned();
            (*v != 0.0 && is_selected(p)).then(shown)
        };
        self.table.iter().zip(self.parameters).filter_map(with).collect::<Vec<_>>().join(", ")
    }
}
