//! A simulation in progress.

use super::{
    closed_loop::{ClosedLoop, Job},
    dormand_prince::DormandPrince,
    error::SimulationError,
    integrator::Integrator,
    motion::{OutputGrid, SimulatedMotion},
    rosenbrock_w::RosenbrockW,
    sampling::Sampling,
    solver::Solver,
    step_control::{Next, StepTooSmall},
    system::Loop,
};
use thetahat_model::dynamics::DynamicParameters;

/// A simulation that can be suspended and resumed: it runs until it needs an acceleration.
pub(super) struct Running<'a> {
    pub(super) integrator: Integrator,
    pub(super) system: Loop<'a>,
    /// None for a continuous controller.
    pub(super) sampling: Option<Sampling>,
    /// The factors of the mass matrix where the step starts, for a linearly implicit method.
    mass: Vec<f64>,
    /// End of the integrator's last interval.
    time: f64,
}

/// Where a simulation stops for its caller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Event {
    /// An acceleration is requested.
    Acceleration,
    /// A step is accepted, and the outputs within it are recorded.
    Step,
    /// An interval is begun, with its drive signals.
    Interval,
    /// Nothing is left.
    End,
}

impl<'a> Running<'a> {
    pub(super) fn new(job: &'a Job<'a>) -> Result<Self, SimulationError> {
        let mut system = Loop::new(job);
        system.check_work()?;
        let start = system.start();
        let sampling = system.controller.is_sampled().then(|| Sampling::new(&mut system, &start));
        let joints = start.len() / 2;
        let integrator = integrator(job, start);
        Ok(Self { integrator, system, sampling, mass: vec![0.0; joints * joints], time: 0.0 })
    }

    /// Advances until an acceleration is requested; false at the end.
    pub(super) fn advance(&mut self) -> Result<bool, SimulationError> {
        loop {
            match self.go_on()? {
                Event::Acceleration => return Ok(true),
                Event::Step | Event::Interval => {}
                Event::End => return Ok(false),
            }
        }
    }

    /// Advances to the next event.
    pub(super) fn go_on(&mut self) -> Result<Event, SimulationError> {
        loop {
            let next = self.integrator.proceed();
            match next.map_err(|StepTooSmall(time_s)| SimulationError::StepTooSmall { time_s })? {
                Next::Slope => {
                    let (t, x, dx) = self.integrator.wanted();
                    if self.system.prepare(t, x, dx) {
                        return Ok(Event::Acceleration);
                    }
                }
                Next::Linearisation => {
                    if let Some((t, x, step, out)) = self.integrator.wanted_linearisation() {
                        self.system.linearise(t, x, step, &self.mass, out);
                    }
                }
                Next::Step(mut step) => {
                    self.system.accept(&mut step)?;
                    return Ok(Event::Step);
                }
                Next::End => return Ok(if self.begin_interval() { Event::Interval } else { Event::End }),
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

    /// Positions, velocities and torques of the joints for the requested accelerations, and the recorded channels.
    pub(super) fn wanted(&mut self) -> [&[f64]; 4] {
        let (_, x, _) = self.integrator.wanted();
        let (q, dq) = x.split_at(x.len() / 2);
        [q, dq, &self.system.plant.tau, &self.system.plant.channels]
    }

    /// Where to write the accelerations.
    pub(super) fn accelerations_mut(&mut self) -> &mut [f64] {
        let (_, x, dx) = self.integrator.wanted();
        &mut dx[x.len() / 2..]
    }

    /// Computes the requested accelerations.
    pub(super) fn accelerate(&mut self) -> Result<(), SimulationError> {
        let (time_s, x, dx) = self.integrator.wanted();
        let accelerations = &mut dx[x.len() / 2..];
        let found = self.system.plant.accelerations(x, accelerations);
        found.map_err(|source| SimulationError::Dynamics { time_s, source })?;
        if self.integrator.needs_mass_matrix() {
            self.mass.copy_from_slice(self.system.plant.factored_mass_matrix());
        }
        Ok(())
    }

    /// Where to write the factors of the mass matrix at the requested acceleration, if they are requested too.
    pub(super) fn mass_mut(&mut self) -> Option<&mut [f64]> {
        self.integrator.needs_mass_matrix().then_some(&mut self.mass)
    }

    /// Runs from a requested acceleration to the end.
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

/// If the implicit method is chosen automatically, its tolerances are tighter than requested by this factor. Stability keeps the explicit
/// method's steps below those that the tolerance allows, and its result is more accurate by as much.
const TIGHTER: f64 = 10.0;

fn integrator(job: &Job<'_>, start: Vec<f64>) -> Integrator {
    match job.closed_loop.solver {
        Solver::Automatic { relative_tolerance: relative, absolute_tolerance: absolute } => {
            if job.closed_loop.is_costly_explicitly(job.theta, job.grid.time(job.grid.samples)) {
                Integrator::Implicit(RosenbrockW::new(relative / TIGHTER, absolute / TIGHTER, start))
            } else {
                Integrator::Explicit(DormandPrince::adaptive(relative, absolute, start))
            }
        }
        Solver::Adaptive { relative_tolerance, absolute_tolerance } => {
            Integrator::Explicit(DormandPrince::adaptive(relative_tolerance, absolute_tolerance, start))
        }
        Solver::Implicit { relative_tolerance, absolute_tolerance } => {
            Integrator::Implicit(RosenbrockW::new(relative_tolerance, absolute_tolerance, start))
        }
        Solver::Fixed { step_s } => Integrator::Explicit(DormandPrince::fixed(step_s, start)),
    }
}

impl ClosedLoop<'_> {
    /// Simulates the loop with standard parameters `theta`; the gains of a controller given by its bandwidth are those
    /// for the inertia `motor_inertia`.
    ///
    /// The robot starts at rest with zero tracking error at time zero.
    ///
    /// # Errors
    /// [`SimulationError`] with joint and time.
    pub fn simulate(
        &self,
        theta: &[f64],
        motor_inertia: &[f64],
        grid: &OutputGrid,
    ) -> Result<SimulatedMotion, SimulationError> {
        self.simulate_within(theta, motor_inertia, grid, f64::INFINITY)
    }

    /// The same, given up after so many adaptive steps, where another result will do.
    ///
    /// # Errors
    /// [`SimulationError`] with joint and time.
    #[doc(hidden)]
    pub fn simulate_within(
        &self,
        theta: &[f64],
        motor_inertia: &[f64],
        grid: &OutputGrid,
        most_steps: f64,
    ) -> Result<SimulatedMotion, SimulationError> {
        let job = Job { closed_loop: *self, theta, motor_inertia, grid: *grid };
        let mut running = Running::new(&job)?;
        running.system.most_steps = running.system.most_steps.min(most_steps);
        if running.advance()? {
            running.run()?;
        }
        running.finish()
    }
}
