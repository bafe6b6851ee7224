//! A simulation under way: the loop as a system of first order, and what is recorded of it.

use std::collections::VecDeque;

use super::{
    ClosedLoop, IntegrationError, Integrator, OutputGrid, SimulatedMotion, SimulationError, Solver, WorkCounts,
    dormand_prince::{StepView, System},
    plant::{MotorReference, Plant},
};
use crate::{
    control::{Controller, VelocityEstimate},
    series::Series,
};

/// A joint faster than this many times the fastest reference (or 1 rad/s, whichever is more) has run away.
const RUNAWAY: f64 = 100.0;
/// More steps than any use of a simulation needs: an hour at 100 kHz.
const STEP_LIMIT: f64 = 3.6e8;
/// Adaptive steps per second of motion, on average, beyond which a loop is too stiff: ten times what chattering friction
/// takes.
const ADAPTIVE_STEPS_PER_S: f64 = 2e5;
/// Times closer than this part of a period are the same: `k T` is not exact.
const SAME_TIME: f64 = 1e-6;

pub(super) fn simulate(
    setup: &ClosedLoop<'_>,
    theta: &[f64],
    motor_inertia: &[f64],
    grid: &OutputGrid,
) -> Result<SimulatedMotion, SimulationError> {
    let mut running = Running::new(setup, theta, motor_inertia, grid);
    running.check_work()?;
    let mut integrator = Integrator::new(setup.solver, 2 * setup.model.joint_count());
    let mut state = running.start();
    if running.controller.is_sampled() {
        running.run_sampled(&mut integrator, &mut state)?;
    } else {
        let end = running.end();
        running.advance(&mut integrator, 0.0, end, &mut state)?;
    }
    running.add_accelerations()?;
    Ok(SimulatedMotion { counts: integrator.counts(), ..running.motion })
}

struct Running<'a> {
    setup: &'a ClosedLoop<'a>,
    controller: Controller,
    plant: Plant<'a>,
    reference: MotorReference<'a>,
    /// Drive signals: held between samples, or those of the last evaluation.
    u: Vec<f64>,
    grid: OutputGrid,
    next_output: usize,
    motion: SimulatedMotion,
    runaway: f64,
    steps: f64,
}

impl<'a> Running<'a> {
    fn new(setup: &'a ClosedLoop<'a>, theta: &[f64], motor_inertia: &[f64], grid: &OutputGrid) -> Self {
        let n = setup.model.joint_count();
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
            grid: *grid,
            next_output: 0,
            steps: 0.0,
            setup,
            controller,
            reference,
        }
    }

    fn check_work(&self) -> Result<(), SimulationError> {
        let sample_time = if self.controller.is_sampled() { self.controller.sample_time_s } else { f64::INFINITY };
        let step_s = match self.setup.solver {
            Solver::Fixed { step_s } => step_s.min(sample_time),
            Solver::Adaptive { .. } => sample_time,
        };
        let steps = self.end() / step_s;
        if steps > STEP_LIMIT { Err(SimulationError::TooManySteps { steps, step_s }) } else { Ok(()) }
    }

    /// Rest, with every motor at its reference.
    fn start(&mut self) -> Vec<f64> {
        self.reference.evaluate(0.0);
        let mut state = self.plant.joint_positions(&self.reference.p);
        state.resize(2 * state.len(), 0.0);
        state
    }

    /// Half a sample behind the last output.
    fn end(&self) -> f64 {
        self.grid.time(self.grid.samples) - 0.5 / self.grid.sample_rate_hz
    }

    /// Samples the controller, lets each drive signal act after the delay, and integrates between.
    fn run_sampled(&mut self, integrator: &mut Integrator, state: &mut [f64]) -> Result<(), SimulationError> {
        let period = self.controller.sample_time_s;
        let end = self.end();
        self.plant.observe(state);
        let mut positions = PositionHistory { one_before: self.plant.p.clone(), two_before: self.plant.p.clone() };
        let mut waiting: VecDeque<(f64, Vec<f64>)> = VecDeque::new();
        let mut commanded = vec![0.0; self.u.len()];
        let (mut t, mut sample) = (0.0, 0_usize);
        while t < end {
            if t >= (sample as f64 - SAME_TIME) * period {
                waiting.push_back((t + self.controller.delay_s, self.sample_controller(t, state, &mut positions)));
                sample += 1;
            }
            while waiting.front().is_some_and(|(due, _)| t >= due - SAME_TIME * period) {
                commanded = waiting.pop_front().map_or(commanded, |(_, u)| u);
            }
            self.u.copy_from_slice(&commanded);
            self.add_recorded_signal(t);
            let due = waiting.front().map_or(f64::INFINITY, |(due, _)| *due);
            let until = (sample as f64 * period).min(due).min(end);
            self.advance(integrator, t, until, state)?;
            t = until;
        }
        Ok(())
    }

    fn sample_controller(&mut self, t: f64, state: &[f64], positions: &mut PositionHistory) -> Vec<f64> {
        self.reference.evaluate(t);
        self.plant.observe(state);
        if self.controller.velocity == VelocityEstimate::AveragedDifference {
            positions.averaged_velocity(self.controller.sample_time_s, &self.plant.p, &mut self.plant.v);
        }
        positions.push(&self.plant.p);
        let mut u = vec![0.0; self.u.len()];
        command(&self.controller, &self.reference, &self.plant, &mut u);
        u
    }

    /// Integrates from `t0` to `t1` and records the outputs in `[t0, t1)`.
    fn advance(
        &mut self,
        integrator: &mut Integrator,
        t0: f64,
        t1: f64,
        state: &mut [f64],
    ) -> Result<(), SimulationError> {
        if self.is_due(t0) {
            self.record(t0, state);
        }
        integrator.integrate(t0, t1, state, self).map_err(|e| match e {
            IntegrationError::Stopped(error) => error,
            IntegrationError::StepTooSmall(time_s) => SimulationError::StepTooSmall { time_s },
        })
    }

    /// Whether an output is due at a time up to and including `t`.
    fn is_due(&self, t: f64) -> bool {
        self.next_output < self.grid.samples
            && self.grid.time(self.next_output) <= t + SAME_TIME / self.grid.sample_rate_hz
    }

    /// Whether an output is due before `t`, so that one at `t` itself is left to the next interval.
    fn is_due_before(&self, t: f64) -> bool {
        self.is_due(t - 2.0 * SAME_TIME / self.grid.sample_rate_hz)
    }

    /// Records all but the accelerations, which are computed together at the end.
    fn record(&mut self, t: f64, x: &[f64]) {
        let n = self.u.len();
        self.drive_continuously(t, x);
        self.plant.drive(&self.u);
        let k = self.next_output;
        self.motion.q.sample_mut(k).copy_from_slice(&x[..n]);
        self.motion.dq.sample_mut(k).copy_from_slice(&x[n..]);
        self.motion.tau.sample_mut(k).copy_from_slice(&self.plant.tau);
        self.next_output += 1;
    }

    /// The accelerations of all outputs.
    fn add_accelerations(&mut self) -> Result<(), SimulationError> {
        let SimulatedMotion { q, dq, tau, .. } = &self.motion;
        let error = |(k, source)| SimulationError::Dynamics { time_s: self.grid.time(k), source };
        self.motion.ddq = self.plant.accelerations_of([q, dq, tau]).map_err(error)?;
        Ok(())
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

    fn add_recorded_signal(&mut self, t: f64) {
        if let Some((signal, rate)) = self.setup.added_signal {
            let k = ((t * rate + SAME_TIME) as usize).min(signal.len() - 1);
            self.u.iter_mut().zip(signal.sample(k)).for_each(|(u, s)| *u += s);
        }
    }

    /// Counts an adaptive step; a loop that takes too many would take hours.
    fn check_stiffness(&mut self, t: f64) -> Result<(), SimulationError> {
        self.steps += 1.0;
        let adaptive = matches!(self.setup.solver, Solver::Adaptive { .. });
        if adaptive && self.steps > ADAPTIVE_STEPS_PER_S * self.end().max(1.0) {
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

impl System for Running<'_> {
    type Error = SimulationError;

    fn slope(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), SimulationError> {
        let n = self.u.len();
        if !x.iter().all(|v| v.is_finite()) {
            // A trial step that is far too long: without a slope it has no error estimate, and is halved.
            dx.fill(f64::NAN);
            return Ok(());
        }
        self.drive_continuously(t, x);
        let (velocities, accelerations) = dx.split_at_mut(n);
        velocities.copy_from_slice(&x[n..]);
        self.plant
            .accelerations(x, &self.u, accelerations)
            .map_err(|source| SimulationError::Dynamics { time_s: t, source })
    }

    fn accept(&mut self, step: &mut StepView<'_>) -> Result<(), SimulationError> {
        while self.is_due_before(step.end_s) {
            let t = self.grid.time(self.next_output);
            self.record(t, step.at(t));
        }
        let end = step.end_s;
        self.check_stiffness(end)?;
        self.check_runaway(end, step.at(end))
    }
}

fn command(controller: &Controller, reference: &MotorReference<'_>, plant: &Plant<'_>, u: &mut [f64]) {
    for (i, u) in u.iter_mut().enumerate() {
        *u = controller.command(i, reference.p[i] - plant.p[i], plant.v[i], reference.dp[i], reference.ddp[i]);
    }
}

/// The motor positions at the two samples before.
struct PositionHistory {
    one_before: Vec<f64>,
    two_before: Vec<f64>,
}

impl PositionHistory {
    fn averaged_velocity(&self, period: f64, p: &[f64], v: &mut [f64]) {
        for (v, (now, before)) in v.iter_mut().zip(p.iter().zip(&self.two_before)) {
            *v = (now - before) / (2.0 * period);
        }
    }

    fn push(&mut self, p: &[f64]) {
        std::mem::swap(&mut self.one_before, &mut self.two_before);
        self.one_before.copy_from_slice(p);
    }
}
