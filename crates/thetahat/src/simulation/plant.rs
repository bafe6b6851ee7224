//! The simulated robot seen from its motors, and the reference in the motors' coordinates.

use super::{ClosedLoop, Reference};
use crate::{
    dynamics::{DynamicParameters, DynamicsError, Model, Sign, Workspace},
    linear_algebra::Matrix,
    robot::Transmission,
};

/// The simulated robot: `p = n_s (q - offset)`, `tau = n_s^T (d_s u)`.
pub(super) struct Plant<'a> {
    model: &'a Model,
    parameters: DynamicParameters,
    sign: Sign,
    workspace: Workspace,
    /// `n_s`: motors per joints, in the true joint units.
    motors_per_joint: Matrix,
    joints_per_motor: Matrix,
    offset: &'a [f64],
    /// `d_s`: torque in joint units per drive signal.
    drive: Vec<f64>,
    /// Motor positions in joint units, as last observed.
    pub(super) p: Vec<f64>,
    /// Motor velocities in joint units, as last observed.
    pub(super) v: Vec<f64>,
    /// Joint torques, as last applied.
    pub(super) tau: Vec<f64>,
}

impl<'a> Plant<'a> {
    pub(super) fn new(setup: &ClosedLoop<'a>, theta: &[f64]) -> Self {
        let n = setup.model.joint_count();
        let ratio = setup.bias.gear_ratio;
        let motors_per_joint = setup.transmission.motor_in_joint_units();
        let joints_per_motor = setup.transmission.joints_per_motor();
        let scaled = |m: &Matrix, s: f64| Matrix::from_fn(n, n, |i, j| s * m.at(i, j));
        let drive = setup.transmission.drive_to_joint_units();
        Self {
            parameters: DynamicParameters::new(setup.model.parameter_table(), n, theta),
            sign: Sign::Smooth { scale: setup.sign_velocity_scale },
            workspace: Workspace::new(setup.model),
            motors_per_joint: scaled(&motors_per_joint, ratio),
            joints_per_motor: scaled(&joints_per_motor, 1.0 / ratio),
            offset: setup.transmission.offset(),
            drive: drive.iter().map(|d| setup.bias.drive_gain * d).collect(),
            model: setup.model,
            p: vec![0.0; n],
            v: vec![0.0; n],
            tau: vec![0.0; n],
        }
    }

    /// `q = n_s^-1 p + offset`.
    pub(super) fn joint_positions(&self, p: &[f64]) -> Vec<f64> {
        self.joints_per_motor.times(p).iter().zip(self.offset).map(|(q, o)| q + o).collect()
    }

    /// Leaves the motor positions and velocities of a state in `p` and `v`.
    #[inline]
    pub(super) fn observe(&mut self, x: &[f64]) {
        let (q, dq) = x.split_at(self.p.len());
        self.p.fill(0.0);
        self.v.fill(0.0);
        for j in 0..q.len() {
            let column = self.motors_per_joint.column(j);
            let (q, dq) = (q[j] - self.offset[j], dq[j]);
            for (i, n) in column.iter().enumerate() {
                self.p[i] += n * q;
                self.v[i] += n * dq;
            }
        }
    }

    /// The joint accelerations that drive signals `u` give in a state; leaves the joint torques in `tau`.
    #[inline]
    pub(super) fn accelerations(&mut self, x: &[f64], u: &[f64], ddq: &mut [f64]) -> Result<(), DynamicsError> {
        let (q, dq) = x.split_at(self.p.len());
        for (j, tau) in self.tau.iter_mut().enumerate() {
            let motors = self.motors_per_joint.column(j).iter();
            *tau = motors.zip(u.iter().zip(&self.drive)).map(|(n, (u, d))| n * d * u).sum();
        }
        self.model.forward_dynamics(&self.parameters, q, dq, &self.tau, self.sign, &mut self.workspace, ddq)
    }
}

/// The reference in the motors' coordinates, `p_ref = n (q_ref - offset)`, with the true transmission.
pub(super) struct MotorReference<'a> {
    reference: &'a Reference,
    motors_per_joint: Matrix,
    offset: &'a [f64],
    joint: [Vec<f64>; 3],
    /// Position of each motor in joint units at the time last evaluated.
    pub(super) p: Vec<f64>,
    /// Its velocity.
    pub(super) dp: Vec<f64>,
    /// Its acceleration.
    pub(super) ddp: Vec<f64>,
}

impl<'a> MotorReference<'a> {
    pub(super) fn new(reference: &'a Reference, transmission: &'a Transmission) -> Self {
        let zeros = || vec![0.0; transmission.joints()];
        Self {
            reference,
            motors_per_joint: transmission.motor_in_joint_units(),
            offset: transmission.offset(),
            joint: [zeros(), zeros(), zeros()],
            p: zeros(),
            dp: zeros(),
            ddp: zeros(),
        }
    }

    #[inline]
    pub(super) fn evaluate(&mut self, t: f64) {
        let [q, dq, ddq] = &mut self.joint;
        self.reference.evaluate(t, q, dq, ddq);
        q.iter_mut().zip(self.offset).for_each(|(q, o)| *q -= o);
        for (motor, joint) in [(&mut self.p, &*q), (&mut self.dp, &*dq), (&mut self.ddp, &*ddq)] {
            motor.fill(0.0);
            for (j, value) in joint.iter().enumerate() {
                let column = self.motors_per_joint.column(j);
                motor.iter_mut().zip(column).for_each(|(m, n)| *m += n * value);
            }
        }
    }

    /// The largest motor velocity in joint units up to `end` s, at a thousand times.
    pub(super) fn fastest(&mut self, end: f64) -> f64 {
        let mut fastest: f64 = 0.0;
        for k in 0..=1000 {
            self.evaluate(end * f64::from(k) / 1000.0);
            fastest = self.dp.iter().fold(fastest, |a, v| a.max(v.abs()));
        }
        fastest
    }
}
