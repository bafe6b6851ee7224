use super::{Job, Reference, SimulatorBias, Solver, WorkCounts, running::Running};
use crate::{
    control::ControllerDescription,
    dynamics::{DynamicParameters, DynamicsError, Model, Workspace},
    linear_algebra::Matrix,
    robot::Transmission,
    series::Series,
};

/// Why a simulation has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A joint ran away from its reference, or became infinite.
    #[error(
        "the simulated loop diverged: joint {joint} reached {velocity:.3e} at {time_s:.4} s; lower the bandwidth or check the start values"
    )]
    Diverged {
        /// The joint, from one.
        joint: usize,
        /// The time.
        time_s: f64,
        /// Its velocity there, rad/s or m/s; it may be NaN.
        velocity: f64,
    },
    /// The parameters have no accelerations.
    #[error("at {time_s:.4} s of the simulation: {source}")]
    Dynamics {
        /// The time.
        time_s: f64,
        /// Why.
        source: DynamicsError,
    },
    /// The integrator's step vanished.
    #[error(
        "the integration stopped at {time_s:.4} s: its step fell below the spacing of numbers; loosen the tolerance or widen sign_velocity_scale"
    )]
    StepTooSmall {
        /// The time.
        time_s: f64,
    },
    /// The simulated motion is too short for the filters of the record.
    #[error("the simulated motion is too short for the filters; take a longer window")]
    TooShortToFilter,
    /// Adaptive steps so short that they would take more work than any record needs.
    #[error(
        "the simulation took {steps:.1e} steps up to {time_s:.4} s: the loop is too stiff; lower the bandwidth, loosen the tolerance or widen sign_velocity_scale"
    )]
    TooStiff {
        /// Steps taken.
        steps: f64,
        /// The time reached.
        time_s: f64,
    },
    /// Fixed steps or a sample time that would take more work than any record needs.
    #[error("the simulation would take {steps:.1e} steps of {step_s} s; use a longer step")]
    TooManySteps {
        /// Steps it would take.
        steps: f64,
        /// Their size.
        step_s: f64,
    },
}

/// Equally spaced times of output, the first at `start_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputGrid {
    /// The first time, s; the simulation itself starts at zero.
    pub start_s: f64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Number of samples.
    pub samples: usize,
}

impl OutputGrid {
    /// Time of sample `k`.
    pub(super) fn time(&self, k: usize) -> f64 {
        self.start_s + k as f64 / self.sample_rate_hz
    }
}

/// What a simulation gives at the times of its grid.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedMotion {
    /// Joint positions, rad or m.
    pub q: Series,
    /// Joint velocities.
    pub dq: Series,
    /// Joint accelerations, by the direct dynamic model and not by differences.
    pub ddq: Series,
    /// Joint torques.
    pub tau: Series,
    /// Work done.
    pub counts: WorkCounts,
}

/// A closed loop to simulate: everything but the dynamic parameters.
#[derive(Debug, Clone, Copy)]
pub struct ClosedLoop<'a> {
    /// The robot's dynamics.
    pub model: &'a Model,
    /// The true transmission.
    pub transmission: &'a Transmission,
    /// The controller.
    pub controller: &'a ControllerDescription,
    /// What it follows.
    pub reference: &'a Reference,
    /// A recorded signal added to the drive signals behind the saturation, held from sample to sample at its rate.
    pub added_signal: Option<(&'a Series, f64)>,
    /// How the simulated robot and controller differ from the true ones.
    pub bias: SimulatorBias,
    /// How to integrate.
    pub solver: Solver,
    /// Velocity scale of the regularised sign, rad/s or m/s.
    pub sign_velocity_scale: f64,
}

/// Times at which the inertia seen by the motors is averaged along the reference.
const INERTIA_SAMPLES: usize = 50;

impl ClosedLoop<'_> {
    /// Inertia of each motor with the others held, as drive signal per acceleration in joint units: the diagonal of
    /// `n^-T M n^-1`, averaged along the reference up to `duration_s`.
    #[must_use]
    pub fn motor_inertia(&self, theta: &[f64], duration_s: f64) -> Vec<f64> {
        let joints = self.model.coordinate_count();
        let parameters = DynamicParameters::new(self.model, theta);
        let mut workspace = Workspace::new(self.model);
        let [mut q, mut dq, mut ddq] = [(); 3].map(|()| vec![0.0; joints]);
        let mut m = vec![0.0; joints * joints];
        let mut mean = Matrix::zeros(joints, joints);
        for k in 0..INERTIA_SAMPLES {
            let t = duration_s * k as f64 / (INERTIA_SAMPLES - 1) as f64;
            self.reference.evaluate(t, &mut q, &mut dq, &mut ddq);
            self.model.mass_matrix(&parameters, &q, &mut workspace, &mut m);
            for i in 0..joints {
                (0..joints).for_each(|j| *mean.at_mut(i, j) += m[i * joints + j] / INERTIA_SAMPLES as f64);
            }
        }
        let to_joints = self.transmission.joints_per_motor();
        let seen = to_joints.transpose().times_matrix(&mean).times_matrix(&to_joints);
        self.transmission.drive_to_joint_units().iter().enumerate().map(|(i, d)| seen.at(i, i) / d).collect()
    }

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
        let job = Job { closed_loop: *self, theta, motor_inertia, grid: *grid };
        let mut running = Running::new(&job)?;
        if running.advance()? {
            running.run()?;
        }
        running.finish()
    }
}
