//! The experiment file that follows a design.

use crate::design::{error::DesignError, text::description::Design};
use thetahat_model::{base_parameters::BaseParameters, dynamics::Model};
use thetahat_report::results::{ExperimentText, JointResult};

/// Files of a design and its recording, in one folder.
const TRAJECTORY: &str = "trajectory.csv";
const RECORDING: &str = "recording.csv";

/// Tables of a design file that an experiment file has as well.
const SETTINGS: [&str; 7] = ["signal", "parameters", "estimation", "controller", "simulation", "locked", "payload"];

/// The controller of a rehearsal whose design describes none: the default one of simulations.
pub(in crate::design) const USUAL_CONTROLLER: &str = "\n# The design has no controller: this one stands in for the robot's.\n[controller]\nlaw = \"pd\"\n\
    bandwidth_hz = [10]\ndamping = 1.0\nvelocity_feed_forward = 1.0\nacceleration_feed_forward = 1.0\n";

pub(in crate::design) fn experiment_text(design: &Design, model: &Model) -> Result<ExperimentText, DesignError> {
    Ok(ExperimentText {
        robot: design.robot_path.clone(),
        title: design.file.title.clone(),
        recording: recording(design),
        twin: twin(design) + &loaded_parameters(design, model)?,
        settings: settings(design),
    })
}

/// A source of one signal of the joints.
fn source(design: &Design, file: &str, name: &str, unit: fn(JointResult) -> String) -> String {
    let units: Vec<String> = JointResult::of_coordinates(&design.robot).into_iter().map(unit).collect();
    let columns: Vec<String> = (1..=units.len()).map(|j| format!("{name}_{j}")).collect();
    format!("{{ file = {file:?}, columns = {columns:?}, unit = {units:?} }}")
}

fn recording(design: &Design) -> String {
    let position = source(design, RECORDING, "position", |joint| joint.position_unit);
    let torque = source(design, RECORDING, "torque", |joint| joint.torque_unit);
    let reference = source(design, TRAJECTORY, "q", |joint| joint.position_unit);
    format!(
        "# The recording of the motion: correct its file, columns and units where yours differ.\n[recording]\n\
         sample_rate_hz = {}\nposition = {position}\ntorque = {torque}\nreference = {reference}\n{}",
        design.file.sample_rate_hz,
        design
            .payload()
            .map_or_else(String::new, |payload| format!("payload = {}\n", toml::Value::from(payload.name.clone())))
    )
}

/// The twin's base parameters with its payload: a twin has no other way to carry one.
fn loaded_parameters(design: &Design, model: &Model) -> Result<String, DesignError> {
    if design.payload().is_none() {
        return Ok(String::new());
    }
    let base = BaseParameters::of(model, &design.settings.parameters.exclude)
        .map_err(|source| DesignError::BaseParameters { path: design.path.clone(), source })?;
    let loaded = base.from_standard(&design.expected_robot(model)?);
    let values = base.parameters().iter().zip(loaded).map(|(p, value)| (p.name.clone(), toml::Value::from(value)));
    Ok(format!("\n# The robot with its payload.\n[twin.parameters]\n{}", values.collect::<toml::Table>()))
}

/// A simulated robot with the a-priori parameters, recorded with the noise of the design; under the default controller if the design
/// has none.
fn twin(design: &Design) -> String {
    let joints = design.robot.coordinate_count();
    let reference = source(design, TRAJECTORY, "q", |joint| joint.position_unit);
    format!(
        "# The robot with its a-priori parameters follows the motion: a rehearsal.\n[twin]\nsample_rate_hz = {}\n\
         unlisted = \"a-priori\"\nreference = {reference}\n\n[twin.sensors]\nencoder_counts_per_turn = 1048576\n\
         torque_noise = {:?}\nposition_noise = {:?}\ntorque_ripple = 0.0\nripple_per_turn = 0\nseed = {}\n{}",
        design.file.sample_rate_hz,
        design.noise.deviations,
        design.file.noise.position.to_list(joints),
        design.file.motion.seed,
        if design.settings.controller.is_some() { "" } else { USUAL_CONTROLLER }
    )
}

/// The tables of the settings, unchanged. A design without methods gets the predicted one and one to compare it with (IV, or LS with a
/// payload): the verdict does not accept an estimate that is compared with nothing.
fn settings(design: &Design) -> String {
    let mut tables = toml::Table::new();
    for name in SETTINGS {
        if let Some(table) = design.tables.get(name) {
            tables.insert(name.to_owned(), table.clone());
        }
    }
    if !tables.contains_key("estimation") {
        let other = if design.payload().is_some() { "idim-ls" } else { "idim-iv" };
        let methods = toml::Value::from(vec!["idim-wls", other]);
        // The intervals are predicted for rows that are weighted by joint.
        let weighting: toml::Table = [(other.to_owned(), toml::Value::from("per-joint"))].into_iter().collect();
        let weighting = toml::Value::Table(weighting);
        let estimation = [("methods".to_owned(), methods), ("weighting".to_owned(), weighting)];
        tables.insert("estimation".to_owned(), toml::Value::Table(estimation.into_iter().collect()));
    }
    tables.to_string()
}
