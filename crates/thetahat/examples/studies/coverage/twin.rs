//! A robot with known parameters: its true motion, what the program makes of it, and what an exact simulator gives.

use std::{error::Error, ops::Range, path::Path, sync::Arc};

use super::stage::Stage;

use thetahat::{
    Experiment, Matrix, Method, Series,
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    experiment::TwinMotion,
    identification::{Assembly, Outcome},
    regression::{Regression, RowLayout},
    signal::{Decimator, SignalError},
    simulation::{ClosedLoop, OutputGrid, Reference, Sensors, SimulatedMotion, SimulationError, SimulatorBias},
    trajectory::Moves,
};
use thetahat_estimation::{
    identification::{IterationOptions, RowMask, iterate},
    signal::moving_samples,
};

const EMPS: &str = include_str!("../../../../../experiments/emps_twin.toml");
const EMPS_ROBOT: &str = include_str!("../../../../../robots/emps.toml");

/// A joint moves above this part of its peak velocity, and above this velocity.
const MOVING: (f64, f64) = (0.01, 1e-3);

pub struct Twin {
    pub name: &'static str,
    pub experiment: Experiment,
    pub model: Model,
    pub base: BaseParameters,
    /// True base parameters.
    pub theta: Vec<f64>,
    pub motion: SimulatedMotion,
    pub window: Range<usize>,
    pub sample_rate_hz: f64,
    /// Part of a step for which the controller holds a torque.
    pub held_part_of_step: f64,
    /// Standard deviation of the white noise on the positions at the high level, rad or m.
    pub position_noise: f64,
    /// X of the true motion: with `theta`, the true torques. It is also Z of an exact simulator.
    pub x_true: Matrix,
    /// The decimated true torques.
    pub y_true: Vec<f64>,
    reference: Reference,
    inertia: Vec<f64>,
    decimator: Decimator,
}

impl Twin {
    /// The robot of the demonstration. Its position noise is a thousandth of a degree.
    pub fn tx40() -> Result<Self, Box<dyn Error>> {
        Self::new("TX40", Experiment::demo()?, 1e-3_f64.to_radians())
    }

    /// EMPS with its cascaded controller on a planned reference. Its position noise is two micrometres.
    pub fn emps() -> Result<Self, Box<dyn Error>> {
        let path = Path::new("experiments/emps_twin.toml");
        Self::new("EMPS", Experiment::from_texts(path, EMPS.to_owned(), EMPS_ROBOT.to_owned())?, 2e-6)
    }

    fn new(name: &'static str, experiment: Experiment, position_noise: f64) -> Result<Self, Box<dyn Error>> {
        let description = experiment.file.twin.clone().ok_or("no twin")?;
        let TwinMotion { motion, reference, parameters } = experiment.twin_motion(&description)?;
        let moves = reference.moves().ok_or("the twin follows no moves")?.clone();
        let model = Model::new(&experiment.robot);
        let base = BaseParameters::of(&model, &experiment.settings.parameters.exclude)?;
        let rate = description.sample_rate_hz;
        let window = moving_samples(&motion.dq, MOVING.0, MOVING.1)?;
        let signal = experiment.settings.signal;
        let mut twin = Self {
            name,
            theta: base.from_standard(&parameters),
            window: window.clone(),
            sample_rate_hz: rate,
            held_part_of_step: experiment
                .settings
                .controller
                .as_ref()
                .map_or(0.0, |c| (c.sample_time_s * rate).clamp(0.0, 1.0)),
            position_noise,
            x_true: Matrix::zeros(0, 0),
            y_true: Vec::new(),
            inertia: motor_inertia(&experiment, &model, &moves, &parameters)?,
            reference: Reference::Moves(moves),
            decimator: Decimator::new(signal.decimation, window.len())?,
            experiment,
            model,
            base,
            motion,
        };
        let [q, dq, ddq] = twin.cut_motion();
        twin.x_true = twin.assembly(None).observation_matrix(&q, &dq, &ddq, twin.smooth_sign())?;
        twin.y_true = twin.decimate(&twin.motion.tau.window(window))?;
        Ok(twin)
    }

    pub fn sensors(&self) -> &Sensors {
        // Checked in `new`: there is a twin.
        match &self.experiment.file.twin {
            Some(twin) => &twin.sensors,
            None => unreachable!("a twin is made from its description"),
        }
    }

    /// The regression of y on a matrix with its rows, every sample used.
    pub fn regression(&self, x: &Matrix, y: &[f64]) -> Regression {
        Regression::new(x.clone(), y.to_vec(), self.layout())
    }

    /// The rows without a mask.
    pub fn layout(&self) -> RowLayout {
        RowLayout::new(self.model.coordinate_count(), &[self.decimator.rows()])
    }

    /// Whether the tables show a parameter.
    pub fn shown(&self, name: &str) -> bool {
        let show = &self.experiment.settings.parameters.show;
        show.is_empty() || show.iter().any(|s| s == name)
    }

    /// The torques of the whole motion with noise in the window.
    pub fn torque_with(&self, noise: &Series) -> Series {
        let mut torque = self.motion.tau.clone();
        for (k, sample) in self.window.clone().enumerate() {
            torque.sample_mut(sample).iter_mut().zip(noise.sample(k)).for_each(|(tau, e)| *tau += e);
        }
        torque
    }

    /// Rows of y from torques in the window, every sample used.
    pub fn decimate(&self, torque: &Series) -> Result<Vec<f64>, SignalError> {
        self.assembly(None).measurement_vector(torque)
    }

    /// X of the true motion with the errors of recorded positions, and these zero on average: half the difference of what
    /// the filters make of positions with the errors added, and with the errors taken away.
    pub fn matrix_with_errors(&self, positions: &Series) -> Result<Matrix, Box<dyn Error>> {
        let mut mirrored = self.motion.q.clone();
        mirrored.values_mut().iter_mut().zip(positions.values()).for_each(|(q, p)| *q = 2.0 * *q - p);
        let plain = |positions: &Series| Stage::Recorded.measured(self, positions)?.matrix(Sign::Exact);
        let [with, without] = [plain(positions)?, plain(&mirrored)?];
        let entry = |k, i| self.x_true.at(k, i) + 0.5 * (with.at(k, i) - without.at(k, i));
        Ok(Matrix::from_fn(with.rows(), with.columns(), entry))
    }

    /// DIDIM, iterated from the true parameters with an exact simulator, on the rows that a mask leaves.
    pub fn iterate_didim(&self, regression: &Regression, mask: Option<&Arc<RowMask>>) -> Outcome {
        let options = IterationOptions::default();
        iterate(Method::DIDIM, regression, options, &self.theta, &mut |theta| self.instruments(theta, mask))
    }

    fn instruments(&self, theta: &[f64], mask: Option<&Arc<RowMask>>) -> Result<Matrix, SimulationError> {
        let rate = self.sample_rate_hz;
        let grid =
            OutputGrid { start_s: self.window.start as f64 / rate, sample_rate_hz: rate, samples: self.window.len() };
        let missing = SimulationError::TooShortToFilter;
        let closed_loop = closed_loop(&self.experiment, &self.model, &self.reference).ok_or(missing.clone())?;
        let m = closed_loop.simulate(&self.base.to_standard(theta), &self.inertia, &grid)?;
        let assembly = self.assembly(mask.cloned()).of_held_torques(self.held_part_of_step);
        assembly.observation_matrix(&m.q, &m.dq, &m.ddq, self.smooth_sign()).map_err(|_| missing)
    }

    pub fn smooth_sign(&self) -> Sign {
        Sign::smooth(self.experiment.settings.simulation.sign_velocity_scale)
    }

    /// The true motion in the window.
    pub fn cut_motion(&self) -> [Series; 3] {
        [&self.motion.q, &self.motion.dq, &self.motion.ddq].map(|s| s.window(self.window.clone()))
    }

    /// What makes rows of the samples that a mask leaves.
    pub fn assembly(&self, mask: Option<Arc<RowMask>>) -> Assembly<'_> {
        Assembly::new(&self.model, &self.base.columns(), self.decimator(mask.is_some())).masked(mask)
    }

    /// With a mask, what lies beyond the window makes no rows either.
    fn decimator(&self, is_masked: bool) -> Decimator {
        if is_masked { self.decimator.clone().with_zero_padding() } else { self.decimator.clone() }
    }

    /// The parts of rows that a mask leaves.
    pub fn masked_layout(&self, mask: Option<&Arc<RowMask>>) -> Result<RowLayout, SignalError> {
        let shares = mask.map(|mask| mask.shares(&self.decimator(true))).transpose()?;
        Ok(self.layout().with_shares(shares))
    }
}

fn closed_loop<'a>(experiment: &'a Experiment, model: &'a Model, reference: &'a Reference) -> Option<ClosedLoop<'a>> {
    Some(ClosedLoop {
        model,
        transmission: &experiment.robot.transmission,
        controller: experiment.settings.controller.as_ref()?,
        reference,
        added_signal: None,
        channels: None,
        bias: SimulatorBias::NONE,
        solver: experiment.settings.simulation.solver,
        sign_velocity_scale: experiment.settings.simulation.sign_velocity_scale,
    })
}

fn motor_inertia(
    experiment: &Experiment,
    model: &Model,
    moves: &Moves,
    parameters: &[f64],
) -> Result<Vec<f64>, Box<dyn Error>> {
    let reference = Reference::Moves(moves.clone());
    let closed_loop = closed_loop(experiment, model, &reference).ok_or("no controller")?;
    Ok(closed_loop.motor_inertia(parameters, moves.end_s()))
}
