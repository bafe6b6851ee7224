//! A simulation under way.

use std::collections::VecDeque;

use super::{
    ClosedLoop, Integrator, Job, Next, OutputGrid, SimulatedMotion, SimulationError, Solver, StepTooSmall, StepView,
    WorkCounts,
    plant::{MotorReference, Plant},
};
use crate::{
    control::{Controller, VelocityEstimate},
    dynamics::DynamicParameters,
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

/// A simulation that can be left and taken up again: it goes on until an acceleration is wanted.
pub(super) struct Running<'a> {
    integrator: Integrator,
    system: Loop<'a>,
    /// None for a continuous controller.
    sampling: Option<Sampling>,
    /// Up to where the intervals of the integrator reach.
    time: f64,
}

impl<'a> Running<'a> {
    pub(super) fn new(job: &'a Job<'a>) -> Result<Self, SimulationError> {
        let mut system = Loop::new(job);
        system.check_work()?;
        let start = system.start();
        let sampling = system.controller.is_sampled().then(|| Sampling::new(&mut system, &start));
        Ok(Self { integrator: Integrator::new(job.closed_loop.solver, start), system, sampling, time: 0.0 })
    }

    /// Goes on until an acceleration is wanted; false at the end.
    pub(super) fn advance(&mut self) -> Result<bool, SimulationError> {
        loop {
            let next = self.integrator.proceed();
            match next.map_err(|StepTooSmall(time_s)| SimulationError::StepTooSmall { time_s })? {
                Next::Slope => {
                    let (t, x, dx) = self.integrator.wanted();
                    if self.system.prepare(t, x, dx) {
                        return Ok(true);
                    }
                }
                Next::Step(mut step) => self.system.accept(&mut step)?,
                Next::End => {
                    if !self.begin_interval() {
                        return Ok(false);
                    }
                }
            }
        }
    }

    /// Begins the next interval in which the drive signals are continuous; false at the end.
    fn begin_interval(&mut self) -> bool {
        let (t, end) = (self.time, self.system.end());
        if t >= end {
            return false;
        }
        let state = self.integrator.state();
        self.time = self.sampling.as_mut().map_or(end, |s| s.hold(&mut self.system, t, state).min(end));
        if self.system.is_due(t) {
            self.system.record(t, state);
        }
        self.integrator.begin(t, self.time);
        true
    }

    /// Positions, velocities and torques of the joints of which the accelerations are wanted.
    pub(super) fn wanted(&mut self) -> [&[f64]; 3] {
        let (_, x, _) = self.integrator.wanted();
        let (q, dq) = x.split_at(x.len() / 2);
        [q, dq, &self.system.plant.tau]
    }

    /// Where the accelerations go.
    pub(super) fn accelerations_mut(&mut self) -> &mut [f64] {
        let (_, x, dx) = self.integrator.wanted();
        &mut dx[x.len() / 2..]
    }

    /// Computes the accelerations that are wanted.
    pub(super) fn accelerate(&mut self) -> Result<(), SimulationError> {
        let (time_s, x, dx) = self.integrator.wanted();
        let accelerations = &mut dx[x.len() / 2..];
        self.system.plant.accelerations(x, accelerations).map_err(|source| SimulationError::Dynamics { time_s, source })
    }

    /// From an acceleration that is wanted to the end.
    pub(super) fn run(&mut self) -> Result<(), SimulationError> {
        self.accelerate()?;
        while self.advance()? {
            self.accelerate()?;
        }
        Ok(())
    }

    pub(super) fn parameters(&self) -> &DynamicParameters {
        &self.system.plant.parameters
    }

    pub(super) fn finish(mut self) -> Result<SimulatedMotion, SimulationError> {
        self.system.add_accelerations()?;
        Ok(SimulatedMotion { counts: self.integrator.counts(), ..self.system.motion })
    }
}

/// The loop as a system of first order, and what is recorded of it.
struct Loop<'a> {
    setup: &'a ClosedLoop<'a>,
    controller: Controller,
    plant: Plant<'a>,
    reference: MotorReference,
    /// Drive signals: held between samples, or those of the last evaluation.
    u: Vec<f64>,
    grid: OutputGrid,
    next_output: usize,
    motion: SimulatedMotion,
    runaway: f64,
    steps: f64,
}

impl<'a> Loop<'a> {
    fn new(job: &'a Job<'a>) -> Self {
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

    /// Writes the velocities to the slope of a state and finds the torques there; false where the slope is known
    /// without accelerations.
    fn prepare(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> bool {
        if !x.iter().all(|v| v.is_finite()) {
            // A trial step that is far too long: without a slope it has no error estimate, and is halved.
            dx.fill(f64::NAN);
            return false;
        }
        self.drive_continuously(t, x);
        self.plant.drive(&self.u);
        let n = self.u.len();
        dx[..n].copy_from_slice(&x[n..]);
        true
    }

    /// Takes note of an accepted step.
    fn accept(&mut self, step: &mut StepView<'_>) -> Result<(), SimulationError> {
        while self.is_due_before(step.end_s) {
            let t = self.grid.time(self.next_output);
            self.record(t, step.at(t));
        }
        let end = step.end_s;
        self.check_stiffness(end)?;
        self.check_runaway(end, step.at(end))
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

fn command(controller: &Controller, reference: &MotorReference, plant: &Plant<'_>, u: &mut [f64]) {
    for (i, u) in u.iter_mut().enumerate() {
        *u = controller.command(i, reference.p[i] - plant.p[i], plant.v[i], reference.dp[i], reference.ddp[i]);
    }
}

/// A sampled controller: each drive signal acts after the delay, and is held until the next.
struct Sampling {
    positions: PositionHistory,
    /// Signals on their way, and when they act.
    waiting: VecDeque<(f64, Vec<f64>)>,
    commanded: Vec<f64>,
    samples: usize,
}

impl Sampling {
    fn new(system: &mut Loop<'_>, start: &[f64]) -> Self {
        system.plant.observe(start);
        let p = &system.plant.p;
        Self {
            positions: PositionHistory { one_before: p.clone(), two_before: p.clone() },
            waiting: VecDeque::new(),
            commanded: vec![0.0; p.len()],
            samples: 0,
        }
    }

    /// Leaves the drive signals from `t` on in the system; until when they hold.
    fn hold(&mut self, system: &mut Loop<'_>, t: f64, state: &[f64]) -> f64 {
        let period = system.controller.sample_time_s;
        if t >= (self.samples as f64 - SAME_TIME) * period {
            let u = self.sample(system, t, state);
            self.waiting.push_back((t + system.controller.delay_s, u));
            self.samples += 1;
        }
        while self.waiting.front().is_some_and(|(due, _)| t >= due - SAME_TIME * period) {
            self.commanded = self.waiting.pop_front().map_or_else(Vec::new, |(_, u)| u);
        }
        system.u.copy_from_slice(&self.commanded);
        system.add_recorded_signal(t);
        let due = self.waiting.front().map_or(f64::INFINITY, |(due, _)| *due);
        (self.samples as f64 * period).min(due)
    }

    fn sample(&mut self, system: &mut Loop<'_>, t: f64, state: &[f64]) -> Vec<f64> {
        let Loop { reference, plant, controller, .. } = system;
        reference.evaluate(t);
        plant.observe(state);
        if controller.velocity == VelocityEstimate::AveragedDifference {
            self.positions.averaged_velocity(controller.sample_time_s, &plant.p, &mut plant.v);
        }
        self.positions.push(&plant.p);
        let mut u = vec![0.0; self.commanded.len()];
        command(controller, reference, plant, &mut u);
        u
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
