//! Exports robots as URDF, MJCF and SDF with the torques that thetahat computes for them, for other programs to compute:
//! `.ci/export` compares.
//!
//! ```text
//! cargo run --release -p thetahat --example studies -- exports DIR
//! ```
//!
//! DIR gets NAME.urdf, NAME.xml and NAME.sdf with NAME.urdf.json and so on: 1000 random states, and the torques of the robot as
//! the format says it, with friction and without. Next to them are NAME_into_a_users_own.xml, a user's MuJoCo model with the
//! robot's values, and NAME_derivatives.py, generated derivatives of the links' torques.

use std::{
    collections::BTreeMap,
    error::Error,
    fs,
    path::{Path, PathBuf},
};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::json;
use thetahat::{
    Robot,
    consistency::completed_a_priori,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    export::{Export, ExportFormat, MjcfModel, Target, export_robot},
    robot::{Parameter, Quantity, RobotSource},
    symbolic::{DriveTorques, Function, Language, ModelKind, ParameterSet, Request},
};
use thetahat_model::robot::Role;
use thetahat_testing::{data, project, shared, users_mjcf};

const STATES: usize = 1000;

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(super::arguments().next().ok_or("give the folder to write to")?);
    let own = [
        "two_joint.toml",
        "tx40.toml",
        "ur10.toml",
        "scara.toml",
        "branching.urdf",
        "seven_axes.urdf",
        "mobile_manipulator.urdf",
        "quadruped.urdf",
    ];
    let recorded = [
        data().join("kuka_lwr4/kuka_lwr4.urdf"),
        data().join("tx40/tx40_mdh_modified.urdf"),
        shared().join("reference/tree8.urdf"),
    ];
    let files = own.map(|name| project("robots").join(name)).into_iter().chain(recorded);
    for file in files.filter(|file| file.is_file()) {
        export(&file, &folder)?;
    }
    Ok(())
}

fn export(file: &Path, folder: &Path) -> Result<(), Box<dyn Error>> {
    let source = RobotSource::read(file)?;
    // What a URDF says of transmissions does not matter to its torques, and may couple joints.
    let robot = if source.urdf_text().is_some() { source.robot_without_transmission()? } else { source.robot()? };
    let parameters = parameters(&robot);
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    for format in [ExportFormat::Urdf, ExportFormat::Mjcf, ExportFormat::Sdf] {
        let export = export_robot(&robot, source.urdf_text(), &parameters, format, &[])?;
        write(&export, &folder.join(format!("{name}.{}", format.extension())))?;
        match format {
            ExportFormat::Urdf => fs::write(folder.join(format!("{name}_derivatives.py")), derivatives(&export)?)?,
            ExportFormat::Mjcf => {
                let model = MjcfModel::from_text(users_mjcf(&export.text), Path::new("the user's model"));
                let into = export_robot(&robot, None, &parameters, Target::Into(&model), &[])?;
                write(&into, &folder.join(format!("{name}_into_a_users_own.xml")))?;
            }
            ExportFormat::Sdf | ExportFormat::Json | ExportFormat::Pace | ExportFormat::Isaac | ExportFormat::Bam => {}
        }
    }
    Ok(())
}

/// Writes a file, and its torques next to it.
fn write(export: &Export, path: &Path) -> Result<(), Box<dyn Error>> {
    fs::write(path, &export.text)?;
    let mut torques_file = path.file_name().unwrap_or_default().to_owned();
    torques_file.push(".json");
    Ok(fs::write(path.with_file_name(torques_file), torques(export).to_string())?)
}

/// Generated Python of the derivatives of the links' torques.
fn derivatives(export: &Export) -> Result<String, Box<dyn Error>> {
    let request = Request {
        values: Some(export.parameters().to_vec()),
        drives: DriveTorques::None,
        ..Request::new(ModelKind::InverseDynamicsDerivatives, ParameterSet::Standard)
    };
    Ok(Language::Python.code(&Function::new(export.robot(), &request)?, Some("robot"))?)
}

/// A-priori parameters, with motor inertia and friction where there are none.
fn parameters(robot: &Robot) -> Vec<f64> {
    let mut parameters = completed_a_priori(robot, None);
    for (value, parameter) in parameters.iter_mut().zip(robot.parameter_table().iter()) {
        let joint = parameter.number as f64;
        if *value != 0.0 {
            continue;
        }
        if let Quantity::Motor(_) = parameter.quantity {
            // Less than the joints that it turns with have.
            *value = 0.01;
            continue;
        }
        match parameter.quantity.role() {
            Role::Inertial | Role::Load => {}
            Role::MotorInertia => *value = 0.2 + 0.01 * joint,
            Role::ViscousFriction => *value = 0.3 + 0.02 * joint,
            Role::CoulombFriction => *value = 0.5 + 0.03 * joint,
        }
    }
    parameters
}

/// Random states of the coordinates with their torques, and how each joint follows its coordinate.
fn torques(export: &Export) -> serde_json::Value {
    let robot = export.robot();
    let model = Model::new(robot);
    let parameters = DynamicParameters::sorted(&model, export.parameters());
    let without = |(p, v): (&Parameter, &f64)| if p.quantity.is_friction() { 0.0 } else { *v };
    let frictionless: Vec<f64> = robot.parameter_table().iter().zip(export.parameters()).map(without).collect();
    let frictionless = DynamicParameters::sorted(&model, &frictionless);
    let mut workspace = Workspace::new(&model);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let n = robot.coordinate_count();
    let mut all: BTreeMap<&str, Vec<Vec<f64>>> = BTreeMap::new();
    for _ in 0..STATES {
        let [q, dq, ddq] = [3.0, 3.0, 10.0].map(|r| (0..n).map(|_| rng.random_range(-r..r)).collect::<Vec<f64>>());
        let [tau, without_friction] = [&parameters, &frictionless].map(|parameters| {
            let mut tau = vec![0.0; n];
            model.inverse_dynamics(parameters, State::new(&q, &dq), &ddq, Sign::Exact, &mut workspace, &mut tau);
            tau
        });
        for (key, values) in [("q", q), ("dq", dq), ("ddq", ddq), ("tau", tau), ("frictionless_tau", without_friction)]
        {
            all.entry(key).or_default().push(values);
        }
    }
    let joints = robot.joints.iter().enumerate().map(|(j, joint)| {
        let moved_by = model.coordinate_of(j);
        json!({ "name": joint.name, "coordinate": moved_by.coordinate, "ratio": moved_by.ratio, "offset": moved_by.offset })
    });
    json!({ "gravity": robot.gravity, "joints": joints.collect::<Vec<_>>(), "states": all })
}
