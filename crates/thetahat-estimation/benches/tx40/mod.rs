//! The TX40 for benchmarks and instruction counts: one state, and a motion of many samples.

#![allow(dead_code, reason = "each program uses a part")]

use std::{error::Error, path::Path};

use thetahat_ground::series::Series;
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    regressor::Regressor,
    robot::Robot,
};

/// The robot of `robots/tx40.toml`.
pub fn robot() -> Result<Robot, Box<dyn Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/tx40.toml");
    Ok(Robot::read(&path)?)
}

/// Joint positions of one state, rad.
pub const Q: [f64; 6] = [0.3, -1.1, 0.7, 1.9, -0.4, 2.2];
/// Its joint velocities, rad/s.
pub const DQ: [f64; 6] = [1.3, -2.1, 0.9, 0.2, -3.0, 1.1];
/// Its joint accelerations, rad/s^2, or torques.
pub const DDQ: [f64; 6] = [5.0, 2.0, -8.0, 1.0, 3.0, -4.0];
/// The sign of a simulation.
pub const SIGN: Sign = Sign::smooth(0.002);

/// The robot, its parameters and scratch.
pub struct Tx40 {
    pub model: Model,
    pub parameters: DynamicParameters,
    pub workspace: Workspace,
    /// The paper's 60 base columns.
    pub regressor: Regressor,
}

impl Tx40 {
    /// With its a-priori parameters.
    pub fn new() -> Result<Self, Box<dyn Error>> {
        let robot = robot()?;
        let model = Model::new(&robot);
        let base = BaseParameters::of(&model, &["iam6".to_owned()])?;
        Ok(Self {
            parameters: DynamicParameters::sorted(&model, &robot.a_priori_parameters()),
            workspace: Workspace::new(&model),
            regressor: Regressor::new(&model, &base.columns()),
            model,
        })
    }
}

/// The state, hidden from the compiler.
pub fn state() -> State<'static> {
    State::new(std::hint::black_box(&Q), &DQ)
}

/// Positions, velocities and accelerations of a motion through the state.
pub fn motion(samples: usize) -> [Series; 3] {
    [Q, DQ, DDQ].map(|state| {
        let sample = |k: usize| state.map(|x| x + (0.37 * k as f64).sin());
        Series::shaped(6, (0..samples).flat_map(sample).collect())
    })
}
