//! The loop as a system of first order.

use super::{
    closed_loop::{ClosedLoop, Job},
    error::SimulationError,
    motion::{OutputGrid, SimulatedMotion},
    motor_reference::MotorReference,
    plant::{Plant, interpolate},
    rosenbrock_w::Linearisation,
    solver::{Solver, WorkCounts},
    step_control::StepView,
};
use crate::control::Controller;
use thetahat_ground::series::Series;
use thetahat_model::dynamics::multiply_factors;

/// A joint faster than this many times the fastest reference (or 1 rad/s, whichever is more) has diverged.
const RUNAWAY: f64 = 100.0;
/// More steps than any use of a simulation needs: an hour at 100 kHz.
const STEP_LIMIT: f64 = 3.6e8;
/// Adaptive steps per second of motion, on average, beyond which a loop is too stiff: ten times the steps of chattering friction.
const ADAPTIVE_STEPS_PER_S: f64 = 2e5;
/// Times closer than this fraction of a period count as equal: `k T` is not exact.
pub(super) const SAME_TIME: f64 = 1e-6;

/// The loop as a system of first order, and its recorded outputs.
pub(super) struct Loop<'a> {
    pub(super) setup: &'a ClosedLoop<'a>,
    pub(super) controller: Controller,
    pub(super) plant: Plant<'a>,
    pub(super) reference: MotorReference,
    /// Drive signals: held between samples, or from the last evaluation.
    pub(super) u: Vec<f64>,
    /// Scratch: negated derivatives of a motor's drive signal with respect to its position and velocity.
    slopes: [Vec<f64>; 2],
    pub(super) grid: OutputGrid,
    pub(super) next_output: usize,
    pub(super) motion: SimulatedMotion,
    runaway: f64,
    steps: f64,
    /// Adaptive steps after which the simulation is given up.
    pub(super) most_steps: f64,
}

impl<'a> Loop<'a> {
    pub(super) fn new(job: &'a Job<'a>) -> Self {
        let Job { closed_loop: setup, theta, motor_inertia, grid } = job;
        let n = setup.model.coordinate_count();
        let mut controller = setup.controller.resolve(motor_inertia, setup.bias.controller_gain);
        let reference_delay_s = if controller.is_sampled() { 0.0 } else { setup.bias.delay_s };
        controller.delay_s += setup.bias.delay_s;
        let mut reference = MotorReference::new(setup.reference, setup.transmission, &setup.bias, reference_delay_s);
        let [q, dq, ddq, tau] = [(); 4].map(|()| Series::zeros(grid.samples, n));
        Self {
            runaway: RUNAWAY * reference.fastest(grid.time(grid.samples)).max(1.0),
            plant: Plant::new(setup, theta),
            motion: SimulatedMotion { q, dq, ddq, tau, counts: WorkCounts::default() },
            u: vec![0.0; n],
            slopes: [vec![0.0; n], vec![0.0; n]],
            grid: *grid,
            next_output: 0,
            steps: 0.0,
            most_steps: ADAPTIVE_STEPS_PER_S * grid.time(grid.samples).max(1.0),
            setup,
            controller,
            reference,
        }
    }

    pub(super) fn check_work(&self) -> Result<(), SimulationError> {
        let sample_time = if self.controller.is_sampled() { self.controller.sample_time_s } else { f64::INFINITY };
        let step_s = match self.setup.solver {
            Solver::Fixed { step_s } => step_s.min(sample_time),
            Solver::Automatic { .. } | Solver::Adaptive { .. } | Solver::Implicit { .. } => sample_time,
        };
        let steps = self.end() / step_s;
        if steps > STEP_LIMIT { Err(SimulationError::TooManySteps { steps, step_s }) } else { Ok(()) }
    }

    /// The state with every motor at its reference: at rest, or in an open loop as fast as the reference.
    pub(super) fn start(&mut self) -> Vec<f64> {
        self.reference.evaluate(0.0);
        let mut state = self.plant.joint_positions(&self.reference.p);
        if self.setup.controller.is_open_loop() {
            state.extend(self.plant.joint_velocities(&self.reference.dp));
        } else {
            state.resize(2 * state.len(), 0.0);
        }
        state
    }

    /// Half a sample after the last output.
    pub(super) fn end(&self) -> f64 {
        self.grid.time(self.grid.samples) - 0.5 / self.grid.sample_rate_hz
    }

    /// Writes the velocities to the slope of a state and computes the torques there; false if the slope needs no accelerations.
    pub(super) fn prepare(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> bool {
        if !x.iter().all(|v| v.is_finite()) {
            // A trial step that is far too long: without a slope it has no error estimate, and is halved.
            dx.fill(f64::NAN);
            return false;
        }
        self.apply_torques(t, x);
        self.plant.observe_channels(t);
        let n = self.u.len();
        dx[..n].copy_from_slice(&x[n..]);
        true
    }

    /// Linearises controller, drive and friction: exactly with respect to the state, and in time by the difference over the step. The rigid
    /// bodies enter through the mass matrix, whose factors are `mass`.
    pub(super) fn linearise(&mut self, t: f64, x: &[f64], step: f64, mass: &[f64], out: &mut Linearisation) {
        let n = self.u.len();
        multiply_factors(mass, n, &mut out.mass);
        self.plant.observe_channels(t);
        self.plant.friction_damping(x, &mut out.damping);
        out.stiffness.fill(0.0);
        out.rate.fill(0.0);
        if self.controller.is_sampled() {
            return;
        }
        self.plant.observe(x);
        self.torques_at(t + step);
        out.rate.copy_from_slice(&self.plant.tau);
        self.torques_at(t);
        out.rate.iter_mut().zip(&self.plant.tau).for_each(|(rate, now)| *rate = (*rate - now) / step);
        self.add_drive_slopes(&mut out.stiffness, &mut out.damping);
    }

    /// Adds the joint stiffness and damping of a continuous controller, n by n each, in the state last observed.
    pub(super) fn add_drive_slopes(&mut self, stiffness: &mut [f64], damping: &mut [f64]) {
        let [position, velocity] = &mut self.slopes;
        slopes(&self.controller, &self.reference, &self.plant, [position, velocity]);
        self.plant.add_drive_slopes(position, stiffness);
        self.plant.add_drive_slopes(velocity, damping);
    }

    /// Writes the torques of a continuous controller to the plant, at a time and in the state last observed.
    fn torques_at(&mut self, t: f64) {
        self.reference.evaluate(t);
        command(&self.controller, &self.reference, &self.plant, &mut self.u);
        self.plant.drive(&self.u);
    }

    /// Processes an accepted step: outputs and limits.
    pub(super) fn accept(&mut self, step: &mut StepView<'_>) -> Result<(), SimulationError> {
        while self.is_due_before(step.end_s) {
            let t = self.grid.time(self.next_output);
            self.record(t, step.at(t));
        }
        let end = step.end_s;
        self.check_stiffness(end)?;
        self.check_runaway(end, step.at(end))
    }

    /// Whether an output is due at or before `t`.
    pub(super) fn is_due(&self, t: f64) -> bool {
        self.next_output < self.grid.samples
            && self.grid.time(self.next_output) <= t + SAME_TIME / self.grid.sample_rate_hz
    }

    /// Whether an output is due strictly before `t`: one at `t` itself is left to the next interval.
    fn is_due_before(&self, t: f64) -> bool {
        self.is_due(t - 2.0 * SAME_TIME / self.grid.sample_rate_hz)
    }

    /// Records all but the accelerations, which are computed together at the end.
    pub(super) fn record(&mut self, t: f64, x: &[f64]) {
        let n = self.u.len();
        self.apply_torques(t, x);
        let k = self.next_output;
        self.motion.q.sample_mut(k).copy_from_slice(&x[..n]);
        self.motion.dq.sample_mut(k).copy_from_slice(&x[n..]);
        self.motion.tau.sample_mut(k).copy_from_slice(&self.plant.tau);
        self.next_output += 1;
    }

    /// The accelerations of all outputs.
    pub(super) fn add_accelerations(&mut self) -> Result<(), SimulationError> {
        let SimulatedMotion { q, dq, tau, .. } = &self.motion;
        let error = |(k, source)| SimulationError::Dynamics { time_s: self.grid.time(k), source };
        self.motion.ddq = self.plant.accelerations_of([q, dq, tau], &self.grid).map_err(error)?;
        Ok(())
    }

    /// Writes the joint torques in a state, and the observations of a continuous controller, to the plant.
    #[inline]
    pub(super) fn apply_torques(&mut self, t: f64, x: &[f64]) {
        self.drive_continuously(t, x);
        self.plant.drive(&self.u);
    }

    /// Writes the joint torques that the controller asks for in a state to the plant, as if it acted at once.
    fn command_at(&mut self, t: f64, x: &[f64]) {
        self.reference.evaluate(t);
        self.plant.observe(x);
        command(&self.controller, &self.reference, &self.plant, &mut self.u);
        self.add_recorded_signal(t);
        self.plant.drive(&self.u);
    }

    /// The drive signals of a continuous controller; a sampled one holds its own.
    fn drive_continuously(&mut self, t: f64, x: &[f64]) {
        if !self.controller.is_sampled() {
            self.reference.evaluate(t);
            self.plant.observe(x);
            command(&self.controller, &self.reference, &self.plant, &mut self.u);
            self.add_recorded_signal(t);
        }
    }

    pub(super) fn add_recorded_signal(&mut self, t: f64) {
        let Some((signal, rate)) = self.setup.added_signal else { return };
        if self.setup.controller.is_open_loop() && !self.controller.is_sampled() {
            interpolate(signal, t * rate, &mut self.u);
        } else {
            let k = ((t * rate + SAME_TIME) as usize).min(signal.len() - 1);
            self.u.iter_mut().zip(signal.sample(k)).for_each(|(u, s)| *u += s);
        }
    }

    /// Counts an adaptive step and refuses a loop that takes too many.
    fn check_stiffness(&mut self, t: f64) -> Result<(), SimulationError> {
        self.steps += 1.0;
        let adaptive = match self.setup.solver {
            Solver::Automatic { .. } | Solver::Adaptive { .. } | Solver::Implicit { .. } => true,
            Solver::Fixed { .. } => false,
        };
        if adaptive && self.steps > self.most_steps {
            return Err(SimulationError::TooStiff { steps: self.steps, time_s: t });
        }
        Ok(())
    }

    fn check_runaway(&self, t: f64, x: &[f64]) -> Result<(), SimulationError> {
        let velocities = &x[self.u.len()..];
        match velocities.iter().position(|v| v.is_nan() || v.abs() > self.runaway) {
            Some(j) => Err(SimulationError::Diverged { joint: j + 1, time_s: t, velocity: velocities[j] }),
            None => Ok(()),
        }
    }
}

impl Job<'_> {
    /// The joint torques that the controller asks for at each time of the grid in the states of a measured motion, as if it acted
    /// at once on what was measured: all that is known of the torques where none were recorded.
    #[doc(hidden)]
    #[must_use]
    pub fn commanded_torques(&self, q: &Series, dq: &Series) -> Series {
        let mut system = Loop::new(self);
        let mut torques = Series::zeros(q.len(), q.channels());
        for k in 0..q.len() {
            let x = [q.sample(k), dq.sample(k)].concat();
            system.command_at(self.grid.time(k), &x);
            torques.sample_mut(k).copy_from_slice(&system.plant.tau);
        }
        torques
    }
}

pub(super) fn command(controller: &Controller, reference: &MotorReference, plant: &Plant<'_>, u: &mut [f64]) {
    for (i, u) in u.iter_mut().enumerate() {
        *u = controller.command(i, reference.p[i] - plant.p[i], plant.v[i], reference.dp[i], reference.ddp[i]);
    }
}

fn slopes(
    controller: &Controller,
    reference: &MotorReference,
    plant: &Plant<'_>,
    [of_position, of_velocity]: [&mut [f64]; 2],
) {
    for (i, (position, velocity)) in of_position.iter_mut().zip(of_velocity).enumerate() {
        let error = reference.p[i] - plant.p[i];
        [*position, *velocity] = controller.slopes(i, error, plant.v[i], reference.dp[i], reference.ddp[i]);
    }
}
