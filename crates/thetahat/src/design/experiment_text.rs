//! The experiment file that follows a design.

use super::description::Design;
use crate::{results::ExperimentText, robot::JointKind};

/// Files of a design and its record, beside one another.
const TRAJECTORY: &str = "trajectory.csv";
const RECORDING: &str = "recording.csv";

/// Tables of a design file that an experiment file has as well.
const SETTINGS: [&str; 6] = ["signal", "parameters", "estimation", "controller", "simulation", "locked"];

pub(super) fn experiment_text(design: &Design) -> ExperimentText {
    ExperimentText {
        robot: design.robot_path.clone(),
        title: design.file.title.clone(),
        recording: recording(design),
        twin: twin(design),
        settings: settings(design),
    }
}

/// A source of one signal of the joints.
fn source(design: &Design, file: &str, name: &str, units: [&str; 2]) -> String {
    let (mut columns, mut of_joints) = (Vec::new(), Vec::new());
    for (j, joint) in design.robot.coordinates().enumerate() {
        columns.push(format!("\"{name}_{}\"", j + 1));
        of_joints.push(match joint.kind {
            JointKind::Revolute => format!("\"{}\"", units[0]),
            JointKind::Prismatic => format!("\"{}\"", units[1]),
        });
    }
    format!("{{ file = \"{file}\", columns = [{}], unit = [{}] }}", columns.join(", "), of_joints.join(", "))
}

fn recording(design: &Design) -> String {
    let position = source(design, RECORDING, "position", ["rad", "m"]);
    let torque = source(design, RECORDING, "torque", ["N m", "N"]);
    let reference = source(design, TRAJECTORY, "q", ["rad", "m"]);
    format!(
        "# The record of the motion: put in its file, columns and units where they are others.\n[recording]\n\
         sample_rate_hz = {}\nposition = {position}\ntorque = {torque}\nreference = {reference}\n",
        design.file.sample_rate_hz
    )
}

/// The robot that moves with its a-priori parameters, recorded with the noise of the design.
fn twin(design: &Design) -> String {
    let joints = design.robot.coordinate_count();
    let reference = source(design, TRAJECTORY, "q", ["rad", "m"]);
    format!(
        "# The robot with its a-priori parameters follows the motion: a rehearsal.\n[twin]\nsample_rate_hz = {}\n\
         unlisted = \"a-priori\"\nreference = {reference}\n\n[twin.sensors]\nencoder_counts_per_turn = 1048576\n\
         torque_noise = {:?}\ntorque_ripple = 0.0\nripple_per_turn = 0\nseed = {}\n",
        design.file.sample_rate_hz,
        design.file.noise.torque.to_list(joints),
        design.file.motion.seed
    )
}

/// The tables of the settings as they stand in the design; without methods the promised one, and IV to compare it with: no
/// verdict takes numbers that nothing is compared with.
fn settings(design: &Design) -> String {
    let mut tables = toml::Table::new();
    for name in SETTINGS {
        if let Some(table) = design.tables.get(name) {
            tables.insert(name.to_owned(), table.clone());
        }
    }
    if !tables.contains_key("estimation") {
        let methods = toml::Value::from(vec!["idim-wls", "idim-iv"]);
        tables.insert(
            "estimation".to_owned(),
            toml::Value::Table([("methods".to_owned(), methods)].into_iter().collect()),
        );
    }
    tables.to_string()
}
