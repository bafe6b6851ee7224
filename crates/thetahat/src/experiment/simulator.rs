//! The closed loop of an experiment as a function of the parameters: instruments Z, and errors against the record.

use std::collections::BTreeMap;

use super::{
    Experiment, ExperimentError, Gains, Start,
    chain::{FilteredRecord, Problem},
    wishes::Output,
};
use crate::{
    control::ControllerDescription,
    dynamics::Sign,
    identification::Assembly,
    linear_algebra::{Matrix, norm},
    series::Series,
    simulation::{
        ClosedLoop, Job, OutputGrid, Reference, SampledReference, SimulatedMotion, SimulationError, SimulatorBias,
        simulate_all,
    },
    trajectory::reconstruct,
};

/// The reference that a record's simulations follow, and where it comes from.
pub(crate) struct RecordReference {
    pub(super) reference: Reference,
    pub(super) origin: &'static str,
}

impl Experiment {
    /// The recorded or planned reference; without one, it is reconstructed from the motion.
    pub(crate) fn reference(&self, filtered: &FilteredRecord) -> Result<RecordReference, ExperimentError> {
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

/// Simulates the loops of all recordings for one case.
pub(crate) struct Simulator<'a> {
    experiment: &'a Experiment,
    problem: &'a Problem,
    loops: Vec<RecordedLoop<'a>>,
    kept_inertia: Option<Vec<f64>>,
}

/// The loop of one recording.
struct RecordedLoop<'a> {
    filtered: &'a FilteredRecord,
    assembly: Assembly<'a>,
    closed_loop: ClosedLoop<'a>,
}

impl<'a> Simulator<'a> {
    /// The simulator of the recordings from which `problem` was made, each with its reference.
    pub(crate) fn new(
        experiment: &'a Experiment,
        problem: &'a Problem,
        recordings: &[(&'a FilteredRecord, &'a RecordReference)],
        controller: &'a ControllerDescription,
        bias: SimulatorBias,
    ) -> Self {
        let loop_of = |(number, (filtered, reference)): (usize, &(&'a FilteredRecord, &'a RecordReference))| {
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
            RecordedLoop { filtered, assembly: problem.assembly(number), closed_loop }
        };
        let loops = recordings.iter().enumerate().map(loop_of).collect();
        let mut simulator = Self { experiment, problem, loops, kept_inertia: None };
        if experiment.file.estimation.gains == Gains::Kept {
            let start = simulator.problem.estimated.to_standard(&simulator.start());
            simulator.kept_inertia = Some(simulator.inertia(&start));
        }
        simulator
    }

    /// The start values of an iteration.
    pub(crate) fn start(&self) -> Vec<f64> {
        let mut theta = self.experiment.robot.a_priori_parameters_for(self.problem.model.parameter_table());
        if self.experiment.file.estimation.start == Start::MotorInertias {
            let table = self.problem.model.parameter_table().iter();
            theta.iter_mut().zip(table).filter(|(_, p)| !p.quantity.is_motor_inertia()).for_each(|(t, _)| *t = 0.0);
        }
        self.problem.estimated.from_standard(&theta)
    }

    /// The simulated motion of each recording in its window.
    pub(super) fn simulate(&self, theta: &[f64]) -> Result<Vec<SimulatedMotion>, SimulationError> {
        simulate_all(&self.jobs(&self.resolve(theta), Output::Motion { step: 1 })).into_iter().collect()
    }

    /// The simulations of all recordings.
    pub(super) fn jobs<'j>(&'j self, (theta, inertia): &'j (Vec<f64>, Vec<f64>), output: Output) -> Vec<Job<'j>> {
        let whole = output == Output::Instruments && self.experiment.file.simulation.band_pass;
        let job = |l: &RecordedLoop<'a>| Job {
            closed_loop: l.closed_loop,
            theta,
            motor_inertia: inertia,
            grid: if whole { l.grid_of_record() } else { l.grid_of_window(output.step()) },
        };
        self.loops.iter().map(job).collect()
    }

    /// Z of the motions simulated for it.
    pub(super) fn instruments_of(&self, motions: &[SimulatedMotion]) -> Result<Matrix, SimulationError> {
        let of_loop = |(l, motion): (&RecordedLoop<'_>, &SimulatedMotion)| l.instruments(self.experiment, motion);
        let matrices = self.loops.iter().zip(motions).map(of_loop).collect::<Result<Vec<_>, _>>()?;
        Ok(self.problem.rows.stack_matrices(matrices))
    }

    /// Number of recordings.
    pub(super) fn recordings(&self) -> usize {
        self.loops.len()
    }

    /// Whether both give the same motion for the same parameters.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let bias = |s: &Self| s.loops.first().map(|l| l.closed_loop.bias);
        std::ptr::eq(self.experiment, other.experiment)
            && std::ptr::eq(self.problem, other.problem)
            && bias(self) == bias(other)
    }

    /// Standard parameters of base parameters, and the inertia that each motor sees for the gains of its controller.
    pub(super) fn resolve(&self, theta: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let standard = self.problem.estimated.to_standard(theta);
        let inertia = self.kept_inertia.clone().unwrap_or_else(|| self.inertia(&standard));
        (standard, inertia)
    }

    /// The inertia that each motor sees, on average over the recordings: the gains are those of one controller.
    fn inertia(&self, standard: &[f64]) -> Vec<f64> {
        let of_loops: Vec<Vec<f64>> = self.loops.iter().map(|l| l.inertia(standard)).collect();
        let mean = |motor: usize| of_loops.iter().map(|i| i[motor]).sum::<f64>() / of_loops.len() as f64;
        (0..self.problem.joints()).map(mean).collect()
    }

    /// `100 |measured - simulated| / |measured|` in the windows: band-passed position, velocity and acceleration and raw
    /// torque of the records, against the simulations as they are.
    pub(super) fn errors(&self, motions: &[SimulatedMotion]) -> BTreeMap<String, f64> {
        let mut squares: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
        for (l, motion) in self.loops.iter().zip(motions) {
            let torque = l.filtered.record.torque.window(l.filtered.window.clone());
            for (name, measured, simulated) in [
                ("position", &l.filtered.q, &motion.q),
                ("velocity", &l.filtered.dq, &motion.dq),
                ("acceleration", &l.filtered.ddq, &motion.ddq),
                ("torque", &torque, &motion.tau),
            ] {
                let [difference, size] = squares.entry(name).or_default();
                *difference += squared_difference(measured, simulated);
                *size += norm(measured.values()).powi(2);
            }
        }
        squares.into_iter().map(|(name, [d, m])| (name.to_owned(), 100.0 * (d / m).sqrt())).collect()
    }
}

impl RecordedLoop<'_> {
    fn instruments(&self, experiment: &Experiment, motion: &SimulatedMotion) -> Result<Matrix, SimulationError> {
        let sign = Sign::Smooth { scale: self.closed_loop.sign_velocity_scale };
        let unfiltered = |_| SimulationError::TooShortToFilter;
        if !experiment.file.simulation.band_pass {
            return self.assembly.observation_matrix(&motion.q, &motion.dq, &motion.ddq, sign).map_err(unfiltered);
        }
        // Filtered as the record is: the whole of it, then cut to the window.
        let rate = self.filtered.record.sample_rate_hz;
        let (q, dq, ddq) = experiment.band_pass(&motion.q, rate).map_err(unfiltered)?;
        let cut = |series: &Series| series.window(self.filtered.window.clone());
        self.assembly.observation_matrix(&cut(&q), &cut(&dq), &cut(&ddq), sign).map_err(unfiltered)
    }

    fn grid_of_record(&self) -> OutputGrid {
        let record = &self.filtered.record;
        OutputGrid { start_s: 0.0, sample_rate_hz: record.sample_rate_hz, samples: record.position.len() }
    }

    /// Every so many samples of the window, the first included.
    fn grid_of_window(&self, step: usize) -> OutputGrid {
        let (window, rate) = (&self.filtered.window, self.filtered.record.sample_rate_hz);
        OutputGrid {
            start_s: window.start as f64 / rate,
            sample_rate_hz: rate / step as f64,
            samples: window.len().div_ceil(step),
        }
    }

    fn inertia(&self, standard: &[f64]) -> Vec<f64> {
        let duration_s = self.filtered.record.position.len() as f64 / self.filtered.record.sample_rate_hz;
        self.closed_loop.motor_inertia(standard, duration_s)
    }
}

fn squared_difference(measured: &Series, simulated: &Series) -> f64 {
    measured.values().iter().zip(simulated.values()).map(|(m, s)| (m - s).powi(2)).sum()
}
