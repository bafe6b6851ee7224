//! The closed loop, simulated.

use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use thetahat::{
    ControllerDescription,
    preparation::SimulationOptions,
    series::Series,
    simulation::{ClosedLoop, OutputGrid, Reference, SampledReference, SimulatedMotion, SimulatorBias},
};

use crate::{
    arrays::{array_of, series_of},
    interruptible,
    raised::Raised,
    robot::Robot,
    values,
};

/// Simulates a robot under control along a sampled reference: positions, velocities, accelerations and joint torques at its
/// samples.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the arguments of the package, which names them")]
pub fn simulate<'py>(
    py: Python<'py>,
    robot: &Robot,
    reference: PyReadonlyArray2<'py, f64>,
    sample_rate_hz: f64,
    controller: &Bound<'py, PyAny>,
    theta: Vec<f64>,
    options: &Bound<'py, PyAny>,
    bias: &Bound<'py, PyAny>,
) -> PyResult<[Bound<'py, PyArray2<f64>>; 4]> {
    let simulation = Simulation {
        robot: robot.clone(),
        reference: series_of(reference.as_array()),
        sample_rate_hz,
        controller: values::read(controller)?,
        theta,
        options: values::read(options)?,
        bias: values::read(bias)?,
    };
    let motion = interruptible::run(py, None, move |_| simulation.run())?;
    let SimulatedMotion { q, dq, ddq, tau, .. } = motion;
    Ok([array_of(py, q)?, array_of(py, dq)?, array_of(py, ddq)?, array_of(py, tau)?])
}

struct Simulation {
    robot: Robot,
    reference: Series,
    sample_rate_hz: f64,
    controller: ControllerDescription,
    theta: Vec<f64>,
    options: SimulationOptions,
    bias: SimulatorBias,
}

impl Simulation {
    fn run(self) -> Result<SimulatedMotion, Raised> {
        let samples = self.reference.len();
        let motors = self.robot.robot.coordinate_count();
        self.controller.validate(motors).map_err(|e| Raised::new("SettingsError", e))?;
        let reference = Reference::Sampled(SampledReference::new(self.reference, self.sample_rate_hz));
        let closed_loop = ClosedLoop {
            model: self.robot.model(),
            transmission: &self.robot.robot.transmission,
            controller: &self.controller,
            reference: &reference,
            added_signal: None,
            channels: None,
            bias: self.bias,
            solver: self.options.solver,
            sign_velocity_scale: self.options.sign_velocity_scale,
        };
        let inertia = closed_loop.motor_inertia(&self.theta, samples as f64 / self.sample_rate_hz);
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: self.sample_rate_hz, samples };
        Ok(closed_loop.simulate(&self.theta, &inertia, &grid)?)
    }
}
