//! The closed loop of an experiment as a function of the parameters: instruments Z, and errors against the record.

use std::collections::BTreeMap;

use super::{
    Experiment, ExperimentError, Gains, Start,
    chain::{FilteredRecord, Problem},
};
use crate::{
    control::ControllerDescription,
    dynamics::Sign,
    identification::Assembly,
    linear_algebra::{Matrix, norm},
    series::Series,
    simulation::{
        ClosedLoop, OutputGrid, Reference, SampledReference, SimulatedMotion, SimulationError, SimulatorBias,
    },
    trajectory::reconstruct,
};

/// The reference that a record's simulations follow, and where it comes from.
pub(super) struct RecordReference {
    pub(super) reference: Reference,
    pub(super) origin: &'static str,
}

impl Experiment {
    /// The recorded or planned reference; without one, it is reconstructed from the motion.
    pub(super) fn reference(&self, filtered: &FilteredRecord) -> Result<RecordReference, ExperimentError> {
        let record = &filtered.record;
        let rate = record.sample_rate_hz;
        if let Some(recorded) = &record.reference {
            let reference = Reference::Sampled(SampledReference::new(recorded.clone(), rate));
            return Ok(RecordReference { reference, origin: "recorded" });
        }
        if let Some(planned) = &record.planned {
            return Ok(RecordReference { reference: Reference::Moves(planned.clone()), origin: "planned" });
        }
        let refuse = |source| ExperimentError::Signal { path: self.path.clone(), source };
        let (_, velocity, _) = self.band_pass(&record.position, rate).map_err(refuse)?;
        let found = reconstruct(&record.position, &velocity, rate)
            .map_err(|source| ExperimentError::Trajectory { path: self.path.clone(), source })?;
        Ok(RecordReference { reference: Reference::Moves(found.moves), origin: "reconstructed" })
    }
}

/// Simulates one record's loop for one case.
pub(super) struct Simulator<'a> {
    experiment: &'a Experiment,
    problem: &'a Problem,
    filtered: &'a FilteredRecord,
    assembly: Assembly<'a>,
    closed_loop: ClosedLoop<'a>,
    kept_inertia: Option<Vec<f64>>,
}

impl<'a> Simulator<'a> {
    pub(super) fn new(
        experiment: &'a Experiment,
        problem: &'a Problem,
        filtered: &'a FilteredRecord,
        (controller, reference): (&'a ControllerDescription, &'a RecordReference),
        bias: SimulatorBias,
    ) -> Self {
        let closed_loop = ClosedLoop {
            model: &problem.model,
            transmission: &experiment.robot.transmission,
            controller,
            reference: &reference.reference,
            added_signal: filtered.record.added_signal.as_ref().map(|s| (s, filtered.record.sample_rate_hz)),
            bias,
            solver: experiment.file.simulation.solver,
            sign_velocity_scale: experiment.file.simulation.sign_velocity_scale,
        };
        let mut simulator =
            Self { experiment, problem, filtered, assembly: problem.assembly(), closed_loop, kept_inertia: None };
        if experiment.file.estimation.gains == Gains::Kept {
            let start = simulator.standard(&simulator.start());
            simulator.kept_inertia = Some(simulator.inertia(&start));
        }
        simulator
    }

    /// The start values of an iteration.
    pub(super) fn start(&self) -> Vec<f64> {
        let mut theta = self.experiment.robot.a_priori_parameters_for(self.problem.model.parameter_table());
        if self.experiment.file.estimation.start == Start::MotorInertias {
            let table = self.problem.model.parameter_table().iter();
            theta.iter_mut().zip(table).filter(|(_, p)| !p.quantity.is_motor_inertia()).for_each(|(t, _)| *t = 0.0);
        }
        self.problem.estimated.from_standard(&theta)
    }

    /// Z of the loop simulated with base parameters `theta`.
    pub(super) fn instruments(&self, theta: &[f64]) -> Result<Matrix, SimulationError> {
        let (motion, window) = self.simulate_where_needed(theta)?;
        let sign = Sign::Smooth { scale: self.closed_loop.sign_velocity_scale };
        let unfiltered = |_| SimulationError::TooShortToFilter;
        if !self.experiment.file.simulation.band_pass {
            return self.assembly.observation_matrix(&motion.q, &motion.dq, &motion.ddq, sign).map_err(unfiltered);
        }
        let rate = self.filtered.record.sample_rate_hz;
        let (q, dq, ddq) = self.experiment.band_pass(&motion.q, rate).map_err(unfiltered)?;
        let cut = |series: &Series| series.window(window.clone());
        self.assembly.observation_matrix(&cut(&q), &cut(&dq), &cut(&ddq), sign).map_err(unfiltered)
    }

    /// The simulated motion in the window.
    pub(super) fn simulate(&self, theta: &[f64]) -> Result<SimulatedMotion, SimulationError> {
        self.run(theta, self.filtered.window.start, self.filtered.window.len())
    }

    /// The motion in the window, or in the whole record where it is to be filtered as the record is; and where the
    /// window is in it.
    fn simulate_where_needed(
        &self,
        theta: &[f64],
    ) -> Result<(SimulatedMotion, std::ops::Range<usize>), SimulationError> {
        if self.experiment.file.simulation.band_pass {
            let whole = self.run(theta, 0, self.filtered.record.position.len())?;
            Ok((whole, self.filtered.window.clone()))
        } else {
            Ok((self.simulate(theta)?, 0..self.filtered.window.len()))
        }
    }

    fn run(&self, theta: &[f64], first: usize, samples: usize) -> Result<SimulatedMotion, SimulationError> {
        let rate = self.filtered.record.sample_rate_hz;
        let grid = OutputGrid { start_s: first as f64 / rate, sample_rate_hz: rate, samples };
        let theta = self.standard(theta);
        match &self.kept_inertia {
            Some(inertia) => self.closed_loop.simulate(&theta, inertia, &grid),
            None => self.closed_loop.simulate(&theta, &self.inertia(&theta), &grid),
        }
    }

    fn standard(&self, theta: &[f64]) -> Vec<f64> {
        self.problem.estimated.to_standard(theta)
    }

    fn inertia(&self, standard: &[f64]) -> Vec<f64> {
        let duration_s = self.filtered.record.position.len() as f64 / self.filtered.record.sample_rate_hz;
        self.closed_loop.motor_inertia(standard, duration_s)
    }

    /// `100 |measured - simulated| / |measured|` in the window: band-passed position, velocity and acceleration and raw
    /// torque of the record, against the simulation as it is.
    pub(super) fn errors(&self, motion: &SimulatedMotion) -> BTreeMap<String, f64> {
        let torque = self.filtered.record.torque.window(self.filtered.window.clone());
        [
            ("position", &self.filtered.q, &motion.q),
            ("velocity", &self.filtered.dq, &motion.dq),
            ("acceleration", &self.filtered.ddq, &motion.ddq),
            ("torque", &torque, &motion.tau),
        ]
        .into_iter()
        .map(|(name, measured, simulated)| (name.to_owned(), relative_error(measured, simulated)))
        .collect()
    }
}

fn relative_error(measured: &Series, simulated: &Series) -> f64 {
    let difference: Vec<f64> = measured.values().iter().zip(simulated.values()).map(|(m, s)| m - s).collect();
    100.0 * norm(&difference) / norm(measured.values())
}
