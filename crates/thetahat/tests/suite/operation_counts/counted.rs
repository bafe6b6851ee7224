//! Counts of the operations of generated models: what the gate and the table share.

use std::path::PathBuf;

use thetahat::{
    Robot,
    symbolic::{DriveTorques, Function, ModelKind, ParameterSet, Request},
};
use thetahat_symbolic::symbolic::OperationCount;

/// Robots by name, with their files from the root of the checkout.
pub const ROBOTS: [(&str, &str); 9] = [
    ("tx40", "robots/tx40.toml"),
    ("lwr4", "crates/thetahat/tests/suite/operation_counts/lwr4.toml"),
    ("rx90", "crates/thetahat/tests/suite/operation_counts/rx90.toml"),
    ("puma_560", "crates/thetahat/tests/suite/operation_counts/puma_560.toml"),
    ("two_joint", "robots/two_joint.toml"),
    ("scara", "robots/scara.toml"),
    ("ur10", "robots/ur10.toml"),
    ("branching", "robots/branching.urdf"),
    ("seven_axes", "robots/seven_axes.urdf"),
];

/// The models that are counted.
pub const MODELS: [(&str, ModelKind); 4] = [
    ("idm", ModelKind::InverseDynamics),
    ("mass-matrix", ModelKind::MassMatrix),
    ("ddm", ModelKind::ForwardDynamics),
    ("regressor", ModelKind::Regressor),
];

/// The operations of a model with base parameters: of the links alone, without motors and friction.
pub fn count(file: &str, model: ModelKind) -> OperationCount {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let robot = Robot::read(&root.join(file)).unwrap();
    let request = Request {
        model,
        parameters: ParameterSet::Base,
        values: None,
        drives: DriveTorques::None,
        about: Vec::new(),
        friction_transition: None,
    };
    Function::new(&robot, &request).unwrap().program.count()
}
