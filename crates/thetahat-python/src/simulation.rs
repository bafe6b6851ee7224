//! The closed loop, simulated.

use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use serde::Deserialize;
use thetahat::{
    ControllerDescription, Series,
    preparation::SimulationOptions,
    simulation::{ClosedLoop, OutputGrid, Reference, SampledReference, SimulatedMotion, SimulatorBias},
};

use crate::{
    arrays::{array_of, series_of},
    interruptible,
    python_error::PythonError,
    robot::Robot,
    values,
};

/// Simulates a robot under control along a sampled reference: positions, velocities, accelerations and joint torques at its
/// samples.
#[pyfunction]
pub fn simulate<'py>(
    py: Python<'py>,
    robot: &Robot,
    reference: PyReadonlyArray2<'py, f64>,
    sample_rate_hz: f64,
    theta: Vec<f64>,
    settings: &Bound<'py, PyAny>,
) -> PyResult<[Bound<'py, PyArray2<f64>>; 4]> {
    let simulation = Simulation {
        robot: robot.clone(),
        reference: series_of(reference.as_array()),
        sample_rate_hz,
        theta,
        settings: values::read(settings)?,
    };
    let motion = interruptible::run(py, None, move |_| simulation.run())?;
    let SimulatedMotion { q, dq, ddq, tau, .. } = motion;
    Ok([array_of(py, q)?, array_of(py, dq)?, array_of(py, ddq)?, array_of(py, tau)?])
}

struct Simulation {
    robot: Robot,
    reference: Series,
    sample_rate_hz: f64,
    theta: Vec<f64>,
    settings: LoopSettings,
}

/// The simulated loop except the robot.
#[derive(Deserialize)]
struct LoopSettings {
    controller: ControllerDescription,
    #[serde(default)]
    simulation: SimulationOptions,
    #[serde(default)]
    bias: SimulatorBias,
}

impl Simulation {
    fn run(self) -> Result<SimulatedMotion, PythonError> {
        let LoopSettings { controller, simulation, bias } = self.settings;
        let samples = self.reference.len();
        let motors = self.robot.robot.coordinate_count();
        controller.validate(motors).map_err(|e| PythonError::new("SettingsError", e))?;
        let reference = Reference::Sampled(SampledReference::new(self.reference, self.sample_rate_hz));
        let closed_loop = ClosedLoop {
            model: self.robot.model(),
            transmission: &self.robot.robot.transmission,
            controller: &controller,
            reference: &reference,
            added_signal: None,
            channels: None,
            bias,
            solver: simulation.solver,
            sign_velocity_scale: simulation.sign_velocity_scale,
        };
        let inertia = closed_loop.motor_inertia(&self.theta, samples as f64 / self.sample_rate_hz);
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: self.sample_rate_hz, samples };
        Ok(closed_loop.simulate(&self.theta, &inertia, &grid)?)
    }
}
