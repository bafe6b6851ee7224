use super::{bias::SimulatorBias, motion::OutputGrid, reference::Reference, solver::Solver};
use crate::control::ControllerDescription;
use thetahat_ground::{linear_algebra::Matrix, series::Series};
use thetahat_model::{
    dynamics::{DynamicParameters, Model, Workspace},
    robot::Transmission,
};

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
    /// A recorded signal added to the drive signals after the saturation, held from sample to sample at its rate. In an open loop it is the
    /// drive signals: held where the controller is sampled, else linear between samples.
    pub added_signal: Option<(&'a Series, f64)>,
    /// The recorded channels that the robot's torque terms use, as in [`State::channels`](thetahat_model::dynamics::State::channels), from
    /// time zero at their rate; linear between samples.
    pub channels: Option<(&'a Series, f64)>,
    /// How the simulated robot and controller differ from the true ones.
    pub bias: SimulatorBias,
    /// How to integrate.
    pub solver: Solver,
    /// Velocity scale of the regularised sign, rad/s or m/s.
    pub sign_velocity_scale: f64,
}

/// A simulation to run: a loop with its parameters and outputs.
#[derive(Debug, Clone, Copy)]
pub struct Job<'a> {
    /// The loop.
    pub closed_loop: ClosedLoop<'a>,
    /// Standard parameters.
    pub theta: &'a [f64],
    /// The inertia for the gains of a controller that is given by its bandwidth.
    pub motor_inertia: &'a [f64],
    /// The output times.
    pub grid: OutputGrid,
}

/// Times at which the inertia seen by the motors is averaged along the reference.
const INERTIA_SAMPLES: usize = 50;

impl ClosedLoop<'_> {
    /// Inertia of each motor with the others held, as drive signal per acceleration in joint units: the diagonal of
    /// `n^-T M n^-1`, averaged along the reference up to `duration_s`.
    #[must_use]
    pub fn motor_inertia(&self, theta: &[f64], duration_s: f64) -> Vec<f64> {
        let joints = self.model.coordinate_count();
        let parameters = DynamicParameters::sorted(self.model, theta);
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
}
