//! A simulation with its sensitivities, sample by sample.

use super::{
    columns::{ColumnBlocks, ZEROS, solve_columns},
    explicit,
    loop_slopes::LoopSlopes,
    sensitive_to::SensitiveTo,
    stages::{StageDynamics, StageSlopes},
};
use crate::simulation::{
    closed_loop::{ClosedLoop, Job},
    error::SimulationError,
    integrator::Integrator,
    motion::SimulatedMotion,
    rosenbrock_w,
    running::{Event, Running},
    step_control::slope_weights,
};

/// A simulation in progress with its exact sensitivities: the derivatives (14) of torques and positions with respect to parameters, gains,
/// gear ratios and delay. The sampled derivatives of the torques are `Psi` of equation (13), which the approximation (15) to (17) replaces
/// by the observation matrix.
///
/// The variational equations of the loop, the controller included, are integrated with the states. With
/// `S = d (q, dq)/dp`, the inverse dynamics ID and the column `phi_p` of the observation matrix,
///
/// `M d ddq/dp = d tau/dp - phi_p - (d ID/dq) S_q - (d ID/d dq) S_dq`.
///
/// A drive signal at its limit does not vary. Steps are chosen by the error of the state alone: the motion equals that of
/// [`ClosedLoop::simulate`] bit for bit. With the explicit method the sensitivities are the derivatives of the discrete solution with its
/// steps fixed; with the linearly implicit method they converge to the derivatives of the solution as the state does.
///
/// Only the motion is stored per sample.
pub struct Sensitivities<'a> {
    running: Running<'a>,
    slopes: LoopSlopes,
    stages: Vec<StageDynamics>,
    stage_slopes: StageSlopes,
    /// The sensitivities of the state where the step starts.
    start: ColumnBlocks,
    /// The sensitivities where it ends.
    end: ColumnBlocks,
    output: Output,
    /// The columns of a sampled controller's delay.
    delay: Vec<usize>,
    /// Whether the next step is the first of an interval.
    first: bool,
    /// Whether a step is followed and not yet passed on.
    followed: bool,
    /// Samples delivered.
    delivered: usize,
}

/// Buffer for one output.
struct Output {
    x: Vec<f64>,
    state: ColumnBlocks,
    torques: ColumnBlocks,
    q_slopes: Vec<f64>,
    tau_slopes: Vec<f64>,
}

/// One output of a simulation with sensitivities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensitivitySample<'a> {
    /// Joint positions, rad or m.
    pub q: &'a [f64],
    /// Joint torques that the drives apply, N m or N.
    pub tau: &'a [f64],
    /// `d q/dp`: joint after joint, and for each joint all parameters in the requested order.
    pub q_slopes: &'a [f64],
    /// `d tau/dp`, in the same order.
    pub tau_slopes: &'a [f64],
}

impl<'a> Sensitivities<'a> {
    /// A simulation with its sensitivities to `to`.
    ///
    /// Where the gains follow from an inertia that is updated with the parameters, `inertia_slopes` are the derivatives of
    /// [`Job::motor_inertia`]: for each of `to` one value per motor, as [`ClosedLoop::motor_inertia_slopes`] gives them.
    /// Without them the gains are kept.
    ///
    /// # Errors
    /// [`SimulationError::TooManySteps`].
    ///
    /// # Panics
    /// If a parameter is not in the model's table.
    pub fn new(
        job: &'a Job<'a>,
        to: &[SensitiveTo],
        inertia_slopes: Option<&[Vec<f64>]>,
    ) -> Result<Self, SimulationError> {
        let mut running = Running::new(job)?;
        let start = start_of(&running, to);
        let slopes = LoopSlopes::new(job, &mut running, to, inertia_slopes, &start);
        let n = start.rows() / 2;
        let channels = running.system.plant.channels.len();
        let stages = match running.integrator {
            Integrator::Explicit(_) => explicit::STAGES,
            Integrator::Implicit(_) => rosenbrock_w::STAGES,
        };
        let delay = if running.sampling.is_some() { SensitiveTo::Delay.columns_of(to) } else { Vec::new() };
        Ok(Self {
            running,
            slopes,
            stages: StageDynamics::of_stages(stages, n),
            stage_slopes: StageSlopes::new(stages, &start, channels),
            end: start.clone(),
            output: Output::new(n, to.len()),
            start,
            delay,
            first: true,
            followed: false,
            delivered: 0,
        })
    }

    /// The next sample of the job's grid; none after the last.
    ///
    /// # Errors
    /// As [`ClosedLoop::simulate`].
    pub fn next_sample(&mut self) -> Result<Option<SensitivitySample<'_>>, SimulationError> {
        while self.delivered == self.running.system.next_output {
            if !self.go_on()? {
                return Ok(None);
            }
        }
        Ok(Some(self.deliver()))
    }

    /// Runs the simulation to its end and returns its motion.
    ///
    /// # Errors
    /// As [`ClosedLoop::simulate`].
    pub fn into_motion(mut self) -> Result<SimulatedMotion, SimulationError> {
        if self.running.advance()? {
            self.running.run()?;
        }
        self.running.finish()
    }

    /// Advances to the next event of the simulation; false at the end.
    fn go_on(&mut self) -> Result<bool, SimulationError> {
        if self.followed {
            std::mem::swap(&mut self.start, &mut self.end);
            self.followed = false;
        }
        match self.running.go_on()? {
            Event::Acceleration => self.accelerate()?,
            Event::Step => self.follow_step(),
            Event::Interval => {
                self.first = true;
                self.slopes.follow_interval(&mut self.running, &self.start);
            }
            Event::End => return Ok(false),
        }
        Ok(true)
    }

    /// Computes the requested accelerations, and stores what the sensitivities of their stage need.
    fn accelerate(&mut self) -> Result<(), SimulationError> {
        self.running.accelerate()?;
        let dynamics = &mut self.stages[self.running.integrator.stage()];
        dynamics.mass.copy_from_slice(self.running.system.plant.factored_mass_matrix());
        dynamics.accelerations.copy_from_slice(self.running.accelerations_mut());
        Ok(())
    }

    fn follow_step(&mut self) {
        if self.first {
            self.jump();
        }
        let Self { running, slopes, stages, stage_slopes, start, end, .. } = self;
        let Running { integrator, system, .. } = running;
        let step = integrator.accepted();
        match &*integrator {
            Integrator::Explicit(_) => {
                stage_slopes.follow_explicitly((system, slopes), &step, stages, self.first, start, end);
            }
            Integrator::Implicit(method) => {
                stage_slopes.follow_implicitly((system, slopes), &step, stages, method.solved(), start, end);
            }
        }
        (self.first, self.followed) = (false, true);
    }

    /// The drive signals of the previous interval act for as long as the delay grows: the velocities change by `M^-1 (tau_before -
    /// tau_now)` per second of delay.
    fn jump(&mut self) {
        let (Some(drop), false) = (self.slopes.torque_drop(), self.delay.is_empty()) else { return };
        let mut jump = vec![ZEROS; drop.len()];
        jump.iter_mut().zip(drop).for_each(|(jump, drop)| jump[0] = *drop);
        solve_columns(&self.stages[0].mass, &mut jump);
        for column in &self.delay {
            jump.iter().enumerate().for_each(|(j, jump)| self.start.add(drop.len() + j, *column, jump[0]));
        }
    }

    /// The oldest recorded output that is not yet delivered.
    fn deliver(&mut self) -> SensitivitySample<'_> {
        let k = self.delivered;
        self.delivered += 1;
        let Self { running: Running { integrator, system, .. }, slopes, stage_slopes, start, output, .. } = self;
        let t = system.grid.time(k);
        if self.followed {
            let step = integrator.accepted();
            let weights = slope_weights(step.interpolant, step.step, (t - step.start_s) / step.step);
            stage_slopes.within(&weights, start, &mut output.state);
        } else {
            output.state.copy_from(start);
        }
        let n = system.u.len();
        output.x[..n].copy_from_slice(system.motion.q.sample(k));
        output.x[n..].copy_from_slice(system.motion.dq.sample(k));
        slopes.torques(system, t, &output.x, &output.state, &mut output.torques);
        output.state.write_rows(n, &mut output.q_slopes);
        output.torques.write_rows(n, &mut output.tau_slopes);
        let (q, tau) = (system.motion.q.sample(k), system.motion.tau.sample(k));
        SensitivitySample { q, tau, q_slopes: &output.q_slopes, tau_slopes: &output.tau_slopes }
    }
}

impl Output {
    fn new(n: usize, columns: usize) -> Self {
        Self {
            x: vec![0.0; 2 * n],
            state: ColumnBlocks::zeros(2 * n, columns),
            torques: ColumnBlocks::zeros(n, columns),
            q_slopes: vec![0.0; n * columns],
            tau_slopes: vec![0.0; n * columns],
        }
    }
}

/// The sensitivities of the initial state: every motor at its reference, `q = n_s^-1 p + offset`, and its velocity `n_s^-1 dp`, zero in
/// a closed loop.
fn start_of(running: &Running<'_>, to: &[SensitiveTo]) -> ColumnBlocks {
    let x = running.integrator.state();
    let mut start = ColumnBlocks::zeros(x.len(), to.len());
    for column in SensitiveTo::GearRatio.columns_of(to) {
        let zeros = running.system.plant.offset.iter().chain(std::iter::repeat(&0.0));
        start.add_column(column, x.iter().zip(zeros).map(|(x, zero)| zero - x));
    }
    start
}

impl ClosedLoop<'_> {
    /// The derivatives of [`Self::motor_inertia`], which is linear in the standard parameters: for each of `to` one value
    /// per motor, zeros for what is not a parameter.
    #[must_use]
    pub fn motor_inertia_slopes(&self, to: &[SensitiveTo], duration_s: f64) -> Vec<Vec<f64>> {
        let mut unit = vec![0.0; self.model.parameter_table().len()];
        let slopes = |to: &SensitiveTo| match to.parameter() {
            Some(index) => {
                unit[index] = 1.0;
                let slopes = self.motor_inertia(&unit, duration_s);
                unit[index] = 0.0;
                slopes
            }
            None => vec![0.0; self.model.coordinate_count()],
        };
        to.iter().map(slopes).collect()
    }
}
