//! An export read back: its torques are those of the robot that was exported.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    actuators,
    error::ExportError,
    format::{ActuatorFormat, ExportFormat},
    mjcf::{self, MjcfModel},
    read_back::{Kinematics, robot_of},
    render::Export,
    represented::RepresentedRobot,
    sdf_read,
};
use thetahat_model::{
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    robot::{Locks, Robot, RobotError, RobotSource},
};

/// Random states that are compared.
const STATES: usize = 1000;
/// Ranges of q, dq and ddq: rad, rad/s and rad/s^2, or m.
const RANGES: [f64; 3] = [3.0, 3.0, 10.0];
const SEED: u64 = 0;
/// Largest difference relative to the largest torque of a state: digits of the file are exact, sums in another order are not.
const TOLERANCE: f64 = 1e-9;
/// Difference of axes, rad and m, up to which the kinematics of a user's own model are compared as well.
const ROUNDING: f64 = 1e-12;

impl Export {
    /// Reads the file back and compares inverse dynamics at 1000 random states with those of the robot as the format represents it. Returns the largest difference, relative to the largest torque of its state.
    ///
    /// Everything that the torques depend on is read from the file, but for gravity, and the reductions of a URDF's
    /// transmissions. Of a MuJoCo model of the user's own whose axes are those of the robot up to rounding (above 1e-12 rad or
    /// m), the kinematics are the robot's. Of a format of drives alone, so are the links.
    ///
    /// # Errors
    /// [`ExportError::NoReader`] for JSON, [`ExportError::Robot`], [`ExportError::Mjcf`] and [`ExportError::ReadBack`] where the
    /// file cannot be read, [`ExportError::OtherJoints`], and [`ExportError::RoundTrip`] for a difference above 1e-9.
    pub fn check(&self) -> Result<f64, ExportError> {
        match self.format {
            ExportFormat::Urdf => compare(&self.represented, &read_back(&self.text, &self.represented.robot)?),
            ExportFormat::Mjcf if self.is_written_and_read() => {
                compare(&self.represented, &read_back(&self.text, &self.represented.robot)?)
            }
            ExportFormat::Mjcf => compare(&self.represented, &self.read_model()?),
            ExportFormat::Sdf => {
                let links = sdf_read::read(&self.text, &self.represented)?;
                compare(&self.represented, &robot_of(&self.represented, &links, &[], Kinematics::File))
            }
            ExportFormat::Json => Err(ExportError::NoReader { format: self.format }),
            ExportFormat::Pace => self.compare_actuators(ActuatorFormat::Pace),
            ExportFormat::Isaac => self.compare_actuators(ActuatorFormat::Isaac),
            ExportFormat::Bam => self.compare_actuators(ActuatorFormat::Bam),
        }
    }

    /// Whether the file has loops or a floating base of ours, and no tendons, which a robot description does not read.
    fn is_written_and_read(&self) -> bool {
        let robot = &self.represented.robot;
        let is_more = !robot.loops.is_empty() || robot.base_coordinates() > 0;
        is_more && self.represented.tendons.is_empty() && !self.is_edited_model
    }

    fn compare_actuators(&self, format: ActuatorFormat) -> Result<f64, ExportError> {
        compare(&self.represented, &actuators::read(format, &self.text, &self.represented)?)
    }

    fn read_model(&self) -> Result<Robot, ExportError> {
        let read = mjcf::read(&MjcfModel::from_text(self.text.clone(), Path::new("the export")), &self.represented)?;
        let rounded = self.is_edited_model && read.difference > ROUNDING;
        let kinematics = if rounded { Kinematics::Robot } else { Kinematics::File };
        Ok(robot_of(&self.represented, &read.links, &read.tendons, kinematics))
    }
}

/// The robot of a file, with the joints locked that the exported robot has locked, and its gravity.
fn read_back(text: &str, exported: &Robot) -> Result<Robot, RobotError> {
    let path = Path::new("the export");
    let text = if exported.base_coordinates() > 0 { on_floating_base(text) } else { text.to_owned() };
    let whole = RobotSource::from_text(text, path)?.robot_without_transmission()?;
    let robot = whole
        .with_locks(&Locks::restating(&exported.locked, &whole.joints))
        .map_err(|source| RobotError::Lock { path: path.to_owned(), source: Box::new(source) })?;
    Ok(Robot { gravity: exported.gravity, ..robot })
}

/// A description of the file's robot on a base that floats.
fn on_floating_base(text: &str) -> String {
    format!("floating_base = true\nurdf_text = {}\n", toml::Value::String(text.to_owned()))
}

/// The place of each joint that was read among those of the robot: the file may list them in another order.
fn order(names: &[&str], back: &Robot) -> Result<Vec<usize>, ExportError> {
    let found: Vec<&str> = back.coordinates().map(|j| j.name.as_str()).collect();
    let order: Option<Vec<usize>> = found.iter().map(|own| names.iter().position(|name| name == own)).collect();
    order.filter(|order| order.len() == names.len()).ok_or_else(|| {
        let [found, expected] = [&found, names].map(|all| all.iter().map(|&name| name.to_owned()).collect());
        ExportError::OtherJoints { found, expected }
    })
}

fn compare(represented: &RepresentedRobot, back: &Robot) -> Result<f64, ExportError> {
    let names: Vec<&str> = represented.robot.coordinates().map(|j| j.name.as_str()).collect();
    let order = order(&names, back)?;
    let (exported, read) =
        (Torques::of(&represented.robot, &represented.parameters), Torques::of(back, &back.a_priori_parameters()));
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut worst = (0.0, 0);
    for _ in 0..STATES {
        let mut state = RANGES.map(|range| names.iter().map(|_| rng.random_range(-range..range)).collect::<Vec<f64>>());
        exported.model.reach(&mut state[0]);
        let expected = exported.at(&state);
        let found = read.at(&state.map(|values| order.iter().map(|&k| values[k]).collect()));
        let largest = expected.iter().fold(f64::MIN_POSITIVE, |m, t| m.max(t.abs()));
        for (tau, &k) in found.iter().zip(&order) {
            let difference = (tau - expected[k]).abs() / largest;
            if difference > worst.0 || difference.is_nan() {
                worst = (difference, k);
            }
        }
    }
    if worst.0 <= TOLERANCE {
        return Ok(worst.0);
    }
    Err(ExportError::RoundTrip { joint: names[worst.1].to_owned(), difference: worst.0 })
}

struct Torques {
    model: Model,
    parameters: DynamicParameters,
}

impl Torques {
    fn of(robot: &Robot, parameters: &[f64]) -> Self {
        let model = Model::new(robot);
        Self { parameters: DynamicParameters::sorted(&model, parameters), model }
    }

    fn at(&self, [q, dq, ddq]: &[Vec<f64>; 3]) -> Vec<f64> {
        let mut tau = vec![0.0; q.len()];
        let mut workspace = Workspace::new(&self.model);
        self.model.inverse_dynamics(&self.parameters, State::new(q, dq), ddq, Sign::Exact, &mut workspace, &mut tau);
        tau
    }
}
