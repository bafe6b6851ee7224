//! The closed loops of all recordings as a function of the parameters: instruments Z, and errors against the recording.

use std::{borrow::Cow, collections::BTreeMap};

use super::branches::{BranchLoops, ResolvedBranch, branches_of};
use crate::preparation::{
    Case, FilteredRecording, Gains, LoopParameters, LoopParts, Problem, RecordedReference, Setup,
};
use thetahat_estimation::{
    control::ControllerDescription,
    identification::{Assembly, Method, Needs, Response},
    signal::Motion,
    simulation::{
        ClosedLoop, Job, OutputGrid, Reference, SimulatedMotion, SimulationError, SimulatorBias, Solver, simulate_all,
    },
};
use thetahat_ground::{linear_algebra::Matrix, series::Series};
use thetahat_model::{
    dynamics::{Model, Sign},
    robot::Robot,
};

/// The closed loop of a robot under the simulator's options along a reference.
pub(crate) fn closed_loop<'a>(
    setup: Setup<'a>,
    model: &'a Model,
    controller: &'a ControllerDescription,
    reference: &'a Reference,
    added_signal: Option<(&'a Series, f64)>,
    bias: SimulatorBias,
) -> ClosedLoop<'a> {
    ClosedLoop {
        model,
        transmission: &setup.robot.transmission,
        controller,
        reference,
        added_signal,
        channels: None,
        bias,
        solver: setup.settings.simulation.solver,
        sign_velocity_scale: setup.settings.simulation.sign_velocity_scale,
    }
}

/// What is asked of a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Output {
    /// Z.
    Instruments,
    /// The motion of each recording at every so many samples of its window, the first included.
    Motion { step: usize },
    /// The response in the rows of y and its sensitivities.
    Sensitivities(Response),
}

impl Output {
    pub(super) fn step(self) -> usize {
        if let Self::Motion { step } = self { step.max(1) } else { 1 }
    }
}

/// Parameters to simulate with.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Parameters {
    /// The estimated base parameters, zeros elsewhere.
    Estimated(Vec<f64>),
    /// The same, simulated with tolerances [`FINE`] times as large: the response itself is compared with the recording, and an
    /// error is to fall with every step.
    Fitted { theta: Vec<f64>, tolerance: f64 },
    /// All standard parameters, simulated with tolerances so many times as large as those of the settings.
    Standard { theta: Vec<f64>, tolerance: f64 },
}

/// Parameters as a simulation takes them.
pub(super) struct Resolved<'a> {
    parts: LoopParts<'a>,
    /// All standard parameters.
    standard: Vec<f64>,
    /// The inertia that each motor sees for the gains of its controller.
    inertia: Vec<f64>,
    solver: Solver,
    /// The parts of the robot, where they are simulated apart.
    pub(super) branches: Vec<ResolvedBranch<'a>>,
}

/// Factor of the tolerances of a simulation whose own errors must not show: of links of little mass with friction near
/// zero, they change the estimates by more than an iteration is to settle to.
pub(super) const FINE: f64 = 0.01;

/// Simulates the loops of all recordings for one case.
pub(crate) struct Simulator<'a> {
    setup: Setup<'a>,
    pub(super) problem: &'a Problem,
    controller: &'a ControllerDescription,
    bias: SimulatorBias,
    pub(super) loops: Vec<RecordedLoop<'a>>,
    pub(super) kept_inertia: Option<Vec<f64>>,
    /// What of the loop is estimated after the robot's parameters.
    pub(super) loop_parameters: LoopParameters,
    /// The parts of the robot that are simulated apart by methods that fit the response.
    pub(super) branches: Vec<BranchLoops>,
    /// The robot with the case's friction model.
    robot: Robot,
}

/// The loop of one recording.
pub(super) struct RecordedLoop<'a> {
    pub(super) filtered: &'a FilteredRecording,
    pub(super) assembly: Assembly<'a>,
    pub(super) closed_loop: ClosedLoop<'a>,
}

impl<'a> Simulator<'a> {
    /// The simulator of a case for the recordings from which `problem` was made, each with its reference.
    pub(crate) fn new(
        setup: Setup<'a>,
        problem: &'a Problem,
        recordings: &[(&'a FilteredRecording, &'a RecordedReference)],
        controller: &'a ControllerDescription,
        case: &Case,
    ) -> Self {
        let loop_of = |(number, (filtered, reference)): (usize, &(&'a FilteredRecording, &'a RecordedReference))| {
            let recording = &filtered.recording;
            let played = reference.drive_signals.as_ref();
            let added = played.or(recording.added_signal.as_ref()).map(|s| (s, recording.sample_rate_hz));
            let channels = filtered.channels.as_ref().map(|s| (s, recording.sample_rate_hz));
            let of_settings =
                closed_loop(setup, &problem.model, controller, &reference.reference, added, case.simulator);
            let sign_velocity_scale = case.sign_velocity_scale.unwrap_or(of_settings.sign_velocity_scale);
            let closed_loop = ClosedLoop { sign_velocity_scale, channels, ..of_settings };
            let assembly = problem.assembly(number).with_channels(filtered.channels_in_window());
            RecordedLoop { filtered, assembly, closed_loop }
        };
        let loops = recordings.iter().enumerate().map(loop_of).collect();
        let motors = problem.model.coordinate_count();
        let loop_parameters = LoopParameters::new(&setup.settings.estimation.loop_parameters, motors);
        let simulator = Self {
            setup,
            problem,
            controller,
            bias: case.simulator,
            loops,
            kept_inertia: None,
            loop_parameters,
            branches: Vec::new(),
            robot: setup.robot_for(case),
        };
        match setup.settings.estimation.gains {
            Gains::Updated => simulator,
            Gains::Kept => simulator.with_kept_gains(),
        }
    }

    /// The same for a method. Gains that follow the estimate leave positions as they are where all parameters grow alike:
    /// methods that fit positions, or gains themselves, keep those of the start values.
    pub(super) fn of_method(self, method: Method) -> Self {
        let simulator = if self.keeps_gains_for(method) { self.with_kept_gains() } else { self };
        match method.needs() {
            Needs::Sensitivities => {
                let loops: Vec<ClosedLoop<'_>> = simulator.loops.iter().map(|l| l.closed_loop).collect();
                let branches = branches_of(&simulator.robot, &loops);
                Self { branches, ..simulator }
            }
            Needs::Measurement | Needs::Instruments => simulator,
        }
    }

    /// Whether a method needs gains that stay, where a bandwidth gives them.
    pub(super) fn keeps_gains_for(&self, method: Method) -> bool {
        let fits = method.needs() == Needs::Sensitivities;
        let is_free = method.response() == Response::Position || !self.loop_parameters.is_empty();
        fits && is_free && !self.controller.bandwidth_hz.is_empty()
    }

    /// The same with gains that stay those of the start values.
    fn with_kept_gains(self) -> Self {
        Self { kept_inertia: Some(self.inertia(&self.parameters_of_kept_gains())), ..self }
    }

    /// The start values, or the completed a-priori ones where those are no robot's: its gains would be zero or negative.
    fn parameters_of_kept_gains(&self) -> Vec<f64> {
        let start = self.problem.estimated.to_standard(&self.start());
        if self.has_mass_matrix_above(&start, 0.0, &start) {
            return start;
        }
        self.problem.consistent_set(self.setup).map_or(start, |set| set.a_priori().to_vec())
    }

    /// What of the loop is estimated after the robot's parameters.
    pub(crate) fn loop_parameters(&self) -> &LoopParameters {
        &self.loop_parameters
    }

    /// The start values of an iteration.
    pub(crate) fn start(&self) -> Vec<f64> {
        self.problem.estimated.from_standard(&self.setup.start(self.problem.model.parameter_table()))
    }

    /// The simulated motion of each recording in its window.
    pub(crate) fn simulate(&self, theta: &[f64]) -> Result<Vec<SimulatedMotion>, SimulationError> {
        simulate_all(&self.jobs(&self.resolve(&Parameters::Estimated(theta.to_vec())), Output::Motion { step: 1 }))
            .into_iter()
            .collect()
    }

    /// The simulations of all recordings.
    pub(super) fn jobs<'j>(&'j self, resolved: &'j Resolved<'_>, output: Output) -> Vec<Job<'j>> {
        let whole = output == Output::Instruments && self.setup.settings.simulation.band_pass;
        let job = |l: &RecordedLoop<'a>| Job {
            closed_loop: ClosedLoop {
                solver: resolved.solver,
                controller: &resolved.parts.controller,
                transmission: &resolved.parts.transmission,
                bias: resolved.parts.bias,
                sign_velocity_scale: resolved.parts.sign_velocity_factor * l.closed_loop.sign_velocity_scale,
                ..l.closed_loop
            },
            theta: &resolved.standard,
            motor_inertia: &resolved.inertia,
            grid: if whole { l.grid_of_recording() } else { l.grid_of_window(output.step()) },
        };
        self.loops.iter().map(job).collect()
    }

    /// Z of the motions simulated for it.
    pub(super) fn instruments_of(&self, motions: &[SimulatedMotion]) -> Result<Matrix, SimulationError> {
        let of_loop = |(l, motion): (&RecordedLoop<'_>, &SimulatedMotion)| l.instruments(self.setup, motion);
        let matrices = self.loops.iter().zip(motions).map(of_loop).collect::<Result<Vec<_>, _>>()?;
        Ok(self.problem.regression.layout.stack_matrices(matrices))
    }

    /// Number of recordings.
    pub(super) fn recordings(&self) -> usize {
        self.loops.len()
    }

    /// Whether both give the same motion for the same parameters.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let scale = |s: &Self| s.loops.first().map(|l| l.closed_loop.sign_velocity_scale);
        std::ptr::eq(self.setup.robot, other.setup.robot)
            && std::ptr::eq(self.setup.settings, other.setup.settings)
            && std::ptr::eq(self.problem, other.problem)
            && (self.bias, scale(self)) == (other.bias, scale(other))
            && self.kept_inertia == other.kept_inertia
    }

    pub(super) fn setup(&self) -> Setup<'a> {
        self.setup
    }

    pub(super) fn problem(&self) -> &'a Problem {
        self.problem
    }

    /// Whether the mass matrix of standard parameters exceeds a part of the one of others along all references.
    pub(super) fn has_mass_matrix_above(&self, standard: &[f64], part: f64, least: &[f64]) -> bool {
        self.loops.iter().all(|l| l.closed_loop.has_mass_matrix_above(standard, part, least, l.duration_s()))
    }

    /// What a simulation with parameters takes.
    pub(super) fn resolve(&self, parameters: &Parameters) -> Resolved<'_> {
        let solver = self.setup.settings.simulation.solver;
        let split = |theta: &'_ [f64]| {
            let (of_robot, of_loop) = theta.split_at(self.problem.estimated.len());
            (self.problem.estimated.to_standard(of_robot), of_loop.to_vec())
        };
        let ((standard, of_loop), solver) = match parameters {
            Parameters::Estimated(theta) => (split(theta), solver),
            Parameters::Fitted { theta, tolerance } => {
                (split(theta), solver.for_sensitivities().with_tolerances_times(FINE * tolerance))
            }
            Parameters::Standard { theta, tolerance } => {
                ((theta.clone(), Vec::new()), solver.with_tolerances_times(*tolerance))
            }
        };
        let inertia = self.kept_inertia.clone().unwrap_or_else(|| self.inertia(&standard));
        let parts = self.loop_parameters.apply(&of_loop, self.described_parts(), &inertia);
        let branches = match parameters {
            Parameters::Fitted { .. } => {
                let described = (&*parts.controller, &*parts.transmission);
                ResolvedBranch::of_all(&self.branches, described, (&standard, &inertia)).unwrap_or_default()
            }
            Parameters::Estimated(_) | Parameters::Standard { .. } => Vec::new(),
        };
        Resolved { parts, standard, inertia, solver, branches }
    }

    /// The controller, transmission and bias as they are described.
    fn described_parts(&self) -> LoopParts<'a> {
        LoopParts {
            controller: Cow::Borrowed(self.controller),
            transmission: Cow::Borrowed(&self.setup.robot.transmission),
            bias: self.bias,
            sign_velocity_factor: 1.0,
        }
    }

    /// The inertia that each motor sees, on average over the recordings: the gains are those of one controller.
    fn inertia(&self, standard: &[f64]) -> Vec<f64> {
        let of_loops: Vec<Vec<f64>> = self.loops.iter().map(|l| l.inertia(standard)).collect();
        let mean = |motor: usize| of_loops.iter().map(|i| i[motor]).sum::<f64>() / of_loops.len() as f64;
        (0..self.problem.model.coordinate_count()).map(mean).collect()
    }

    /// `100 |measured - simulated| / |measured|` in the windows: band-passed position, velocity and acceleration and raw
    /// torque of the recordings, against the simulations as they are.
    pub(crate) fn errors(&self, motions: &[SimulatedMotion]) -> BTreeMap<String, f64> {
        let mut squares: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
        for (l, motion) in self.loops.iter().zip(motions) {
            let torque = l.filtered.torque();
            let measured = &l.filtered.motion;
            for (name, measured, simulated) in [
                ("position", &measured.q, &motion.q),
                ("velocity", &measured.dq, &motion.dq),
                ("acceleration", &measured.ddq, &motion.ddq),
                ("torque", &torque, &motion.tau),
            ] {
                if name == "torque" && l.filtered.recording.torque.is_none() {
                    continue;
                }
                let [difference, size] = squares.entry(name).or_default();
                for k in l.filtered.used_samples() {
                    *difference += squared_difference(measured.sample(k), simulated.sample(k));
                    *size += measured.sample(k).iter().map(|v| v * v).sum::<f64>();
                }
            }
        }
        squares.into_iter().map(|(name, [d, m])| (name.to_owned(), 100.0 * (d / m).sqrt())).collect()
    }
}

impl Simulator<'_> {
    /// How far simulated positions are from those recorded, rms over joints and samples, rad or m.
    pub(crate) fn deviation_of_positions(&self, motions: &[SimulatedMotion]) -> f64 {
        let (mut squares, mut count) = (0.0, 0);
        for (l, motion) in self.loops.iter().zip(motions) {
            for k in l.filtered.used_samples() {
                squares += squared_difference(l.filtered.motion.q.sample(k), motion.q.sample(k));
                count += motion.q.channels();
            }
        }
        (squares / f64::from(u32::try_from(count).unwrap_or(u32::MAX)).max(1.0)).sqrt()
    }
}

impl RecordedLoop<'_> {
    fn instruments(&self, setup: Setup<'_>, motion: &SimulatedMotion) -> Result<Matrix, SimulationError> {
        let sign = Sign::smooth(self.closed_loop.sign_velocity_scale);
        let unfiltered = |_| SimulationError::TooShortToFilter;
        if !setup.settings.simulation.band_pass {
            let assembly = self.assembly.clone().of_held_torques(self.held_part_of_step());
            return assembly.observation_matrix(&motion.q, &motion.dq, &motion.ddq, sign).map_err(unfiltered);
        }
        // Filtered as the recording is: the whole of it, then cut to the window.
        let rate = self.filtered.recording.sample_rate_hz;
        let Motion { q, dq, ddq } = setup.band_pass(&motion.q, rate).map_err(unfiltered)?;
        let cut = |series: &Series| series.window(self.filtered.window.clone());
        self.assembly.observation_matrix(&cut(&q), &cut(&dq), &cut(&ddq), sign).map_err(unfiltered)
    }

    fn grid_of_recording(&self) -> OutputGrid {
        let recording = &self.filtered.recording;
        OutputGrid { start_s: 0.0, sample_rate_hz: recording.sample_rate_hz, samples: recording.position.len() }
    }

    /// Every so many samples of the window, the first included.
    fn grid_of_window(&self, step: usize) -> OutputGrid {
        let (window, rate) = (&self.filtered.window, self.filtered.recording.sample_rate_hz);
        OutputGrid {
            start_s: window.start as f64 / rate,
            sample_rate_hz: rate / step as f64,
            samples: window.len().div_ceil(step),
        }
    }

    fn inertia(&self, standard: &[f64]) -> Vec<f64> {
        self.closed_loop.motor_inertia(standard, self.duration_s())
    }

    pub(super) fn duration_s(&self) -> f64 {
        self.filtered.recording.position.len() as f64 / self.filtered.recording.sample_rate_hz
    }
}

fn squared_difference(measured: &[f64], simulated: &[f64]) -> f64 {
    measured.iter().zip(simulated).map(|(m, s)| (m - s).powi(2)).sum()
}
