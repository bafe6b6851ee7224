//! A simulation with its sensitivities, sample by sample.

use super::{
    closed_loop::{ClosedLoop, Job},
    columns::ColumnBlocks,
    error::SimulationError,
    explicit_sensitivities::ExplicitSensitivities,
    held_slopes::HeldSlopes,
    implicit_sensitivities::ImplicitSensitivities,
    integrator::Integrator,
    loop_slopes::{LoopSlopes, solve_block},
    motion::SimulatedMotion,
    running::{Event, Running},
    sensitive_to::SensitiveTo,
    stage_record::StageRecord,
    step_control::slope_weights,
};

/// A simulation under way with its exact sensitivities: the derivatives of torques and positions by parameters, gains, gear
/// ratio and delay, as prediction-error methods need them (the matrix Psi of equation (13), whose entries (14), (15) leave
/// to be found).
///
/// The variational equations of the loop, the controller included, are integrated beside the states:
///
/// `M d ddq/dp = d tau/dp - phi_p - (d ID/dq) S_q - (d ID/d dq) S_dq` with `S = d (q, dq)/dp`, ID the inverse dynamics and
/// `phi_p` the column of the observation matrix of a standard parameter. Steps are chosen by the error of the states alone:
/// the motion is that of [`ClosedLoop::simulate`], bit for bit. Of the explicit method the sensitivities are the derivatives
/// of the discrete solution with its steps kept; of the linearly implicit one they are those of the continuous solution, to
/// its order.
pub struct Sensitivities<'a> {
    running: Running<'a>,
    linear: LoopSlopes,
    /// None for a continuous controller.
    held: Option<HeldSlopes>,
    method: Method,
    stages: Vec<StageRecord>,
    /// The sensitivities of the state: where the step starts, where it ends, and at an output.
    start: ColumnBlocks,
    end: ColumnBlocks,
    output: ColumnBlocks,
    /// Those of the torques at an output.
    torques: ColumnBlocks,
    delay: Vec<usize>,
    /// Whether the next step is the first of an interval.
    first: bool,
    /// Whether a step is followed and not yet taken.
    followed: bool,
    delivered: usize,
    tau_slopes: Vec<f64>,
    q_slopes: Vec<f64>,
}

enum Method {
    Explicit(ExplicitSensitivities),
    Implicit(ImplicitSensitivities),
}

/// One output of a simulation with sensitivities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<'a> {
    /// Joint positions, rad or m.
    pub q: &'a [f64],
    /// Joint torques, N m or N.
    pub tau: &'a [f64],
    /// `d q/dp`: joint after joint, for each joint all parameters.
    pub q_slopes: &'a [f64],
    /// `d tau/dp` of equations (13) to (15): joint after joint, for each joint all parameters.
    pub tau_slopes: &'a [f64],
}

impl<'a> Sensitivities<'a> {
    /// A simulation that is to find the sensitivities to `to`. Where gains follow from an inertia that itself follows from
    /// the parameters, `inertia_slopes` are the derivatives of `motor_inertia`: for each of `to` one value per motor
    /// ([`ClosedLoop::motor_inertia_slopes`]). Without them the gains are kept.
    ///
    /// # Errors
    /// [`SimulationError::TooManySteps`].
    pub fn new(
        job: &'a Job<'a>,
        to: &[SensitiveTo],
        inertia_slopes: Option<&[Vec<f64>]>,
    ) -> Result<Self, SimulationError> {
        let mut running = Running::new(job)?;
        let x = running.integrator.state().to_vec();
        let (rows, columns) = (x.len(), to.len());
        let zeros = || ColumnBlocks::zeros(rows, columns);
        let start = start_of(&running, to, &x);
        let held = running.sampling.is_some().then(|| HeldSlopes::new(&mut running, to, &x, &start));
        let (method, stages) = match running.integrator {
            Integrator::Explicit(_) => (Method::Explicit(ExplicitSensitivities::new(rows, columns)), 7),
            Integrator::Implicit(_) => (Method::Implicit(ImplicitSensitivities::new(rows, columns)), 4),
        };
        let n = rows / 2;
        let record = || StageRecord { mass: vec![0.0; n * n], accelerations: vec![0.0; n] };
        let delay = to.iter().enumerate().filter(|(_, to)| **to == SensitiveTo::Delay && held.is_some());
        Ok(Self {
            linear: LoopSlopes::new(job, to, inertia_slopes),
            method,
            stages: (0..stages).map(|_| record()).collect(),
            end: zeros(),
            output: zeros(),
            torques: ColumnBlocks::zeros(n, columns),
            delay: delay.map(|(column, _)| column).collect(),
            first: true,
            followed: false,
            delivered: 0,
            tau_slopes: vec![0.0; n * columns],
            q_slopes: vec![0.0; n * columns],
            held,
            start,
            running,
        })
    }

    /// The next sample of the job's grid; none behind the last.
    ///
    /// # Errors
    /// As [`ClosedLoop::simulate`].
    pub fn next_sample(&mut self) -> Result<Option<Sample<'_>>, SimulationError> {
        while self.delivered == self.running.system.next_output {
            if !self.go_on()? {
                return Ok(None);
            }
        }
        Ok(Some(self.deliver()))
    }

    /// The motion simulated, once every sample is taken.
    ///
    /// # Errors
    /// As [`ClosedLoop::simulate`].
    pub fn into_motion(mut self) -> Result<SimulatedMotion, SimulationError> {
        while self.go_on()? {}
        self.running.finish()
    }

    /// Goes on to the next event of the simulation; false at the end.
    fn go_on(&mut self) -> Result<bool, SimulationError> {
        if self.followed {
            std::mem::swap(&mut self.start, &mut self.end);
            self.followed = false;
        }
        match self.running.go_on()? {
            Event::Acceleration => self.accelerate()?,
            Event::Step => self.follow_step(),
            Event::Interval => self.begin_interval(),
            Event::End => return Ok(false),
        }
        Ok(true)
    }

    /// Computes the accelerations that are wanted, and keeps what the sensitivities of their stage need.
    fn accelerate(&mut self) -> Result<(), SimulationError> {
        self.running.accelerate()?;
        let record = &mut self.stages[self.running.integrator.stage()];
        record.mass.copy_from_slice(self.running.system.plant.factored_mass_matrix());
        record.accelerations.copy_from_slice(self.running.accelerations_mut());
        Ok(())
    }

    fn begin_interval(&mut self) {
        self.first = true;
        if let Some(held) = &mut self.held {
            held.follow(&mut self.running, self.linear.controller_mut(), &self.start);
        }
    }

    fn follow_step(&mut self) {
        if self.first {
            self.jump();
        }
        let Running { integrator, system, .. } = &mut self.running;
        let step = integrator.accepted();
        let parts = (system, &mut self.linear, self.held.as_ref());
        match (&mut self.method, &*integrator) {
            (Method::Explicit(method), _) => {
                method.follow(parts, &step, &self.stages, self.first, &self.start, &mut self.end);
            }
            (Method::Implicit(method), Integrator::Implicit(integrator)) => {
                method.follow(parts, &step, &self.stages, integrator.solved(), &self.start, &mut self.end);
            }
            (Method::Implicit(_), Integrator::Explicit(_)) => {}
        }
        (self.first, self.followed) = (false, true);
    }

    /// A later change of the drive signals, by the time `dt`, leaves the accelerations before it in place for as long.
    fn jump(&mut self) {
        let (Some(held), false) = (&self.held, self.delay.is_empty()) else { return };
        let mut jump: Vec<[f64; 8]> = held.torque_drop.iter().map(|drop| [*drop; 8]).collect();
        solve_block(&self.stages[0].mass, &mut jump);
        for column in &self.delay {
            jump.iter().enumerate().for_each(|(j, jump)| self.start.add(held.torque_drop.len() + j, *column, jump[0]));
        }
    }

    /// The sensitivities of the oldest output that is recorded and not yet delivered.
    fn deliver(&mut self) -> Sample<'_> {
        let k = self.delivered;
        self.delivered += 1;
        let Running { integrator, system, .. } = &mut self.running;
        let t = system.grid.time(k);
        if self.followed {
            let step = integrator.accepted();
            let weights = slope_weights(step.interpolant, step.step, (t - step.start_s) / step.step);
            match &self.method {
                Method::Explicit(method) => method.within(&weights, &self.start, &mut self.output),
                Method::Implicit(method) => method.within(&weights, &self.start, &mut self.output),
            }
        } else {
            self.output.copy_from(&self.start);
        }
        let x = [system.motion.q.sample(k), system.motion.dq.sample(k)].concat();
        self.linear.linearise_torques(system, self.held.as_ref(), t, &x);
        self.linear.torques(&self.output, &mut self.torques);
        let n = x.len() / 2;
        self.output.write_rows(n, &mut self.q_slopes);
        self.torques.write_rows(n, &mut self.tau_slopes);
        let motion = &self.running.system.motion;
        Sample {
            q: motion.q.sample(k),
            tau: motion.tau.sample(k),
            q_slopes: &self.q_slopes,
            tau_slopes: &self.tau_slopes,
        }
    }
}

/// Every motor starts at its reference, `q = n^-1 p / factor + offset`, at rest.
fn start_of(running: &Running<'_>, to: &[SensitiveTo], x: &[f64]) -> ColumnBlocks {
    let mut start = ColumnBlocks::zeros(x.len(), to.len());
    for (column, _) in to.iter().enumerate().filter(|(_, to)| **to == SensitiveTo::GearRatio) {
        let positions = x.iter().zip(running.system.plant.offset).enumerate();
        positions.for_each(|(j, (q, offset))| start.add(j, column, offset - q));
    }
    start
}

impl ClosedLoop<'_> {
    /// The derivatives of [`Self::motor_inertia`], which is linear in the standard parameters: for each of `to` one value
    /// per motor, zeros for what is not a parameter.
    #[must_use]
    pub fn motor_inertia_slopes(&self, to: &[SensitiveTo], duration_s: f64) -> Vec<Vec<f64>> {
        let mut unit = vec![0.0; self.model.parameter_table().len()];
        let slopes = |to: &SensitiveTo| match to {
            SensitiveTo::Parameter(index) => {
                unit[*index] = 1.0;
                let slopes = self.motor_inertia(&unit, duration_s);
                unit[*index] = 0.0;
                slopes
            }
            SensitiveTo::PositionGain(_)
            | SensitiveTo::VelocityGain(_)
            | SensitiveTo::DriveGain(_)
            | SensitiveTo::GearRatio
            | SensitiveTo::Delay => vec![0.0; self.model.coordinate_count()],
        };
        to.iter().map(slopes).collect()
    }
}
