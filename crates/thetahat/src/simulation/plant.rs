//! The simulated robot seen from its motors, and the reference in the motors' coordinates.

use super::{ClosedLoop, Reference, SimulatorBias};
use crate::{
    dynamics::{DynamicParameters, DynamicsError, Model, Sign, State, Workspace},
    linear_algebra::Matrix,
    robot::Transmission,
    series::Series,
};

/// The entries of a coupling matrix that are not zero: of the joints, most move one motor only.
struct Coupling {
    entries: Vec<(usize, usize, f64)>,
}

impl Coupling {
    fn new(n: &Matrix, factor: f64) -> Self {
        let all = (0..n.columns()).flat_map(|j| (0..n.rows()).map(move |i| (i, j)));
        let entries = all.map(|(i, j)| (i, j, factor * n.at(i, j))).filter(|(_, _, w)| *w != 0.0).collect();
        Self { entries }
    }

    /// `motors = n joints`.
    #[inline]
    fn to_motors(&self, joints: &[f64], motors: &mut [f64]) {
        motors.fill(0.0);
        self.entries.iter().for_each(|&(i, j, w)| motors[i] += w * joints[j]);
    }

    /// `joints = n^T motors`.
    #[inline]
    fn transpose_to_joints(&self, motors: &[f64], joints: &mut [f64]) {
        joints.fill(0.0);
        self.entries.iter().for_each(|&(i, j, w)| joints[j] += w * motors[i]);
    }
}

/// The simulated robot: `p = n_s (q - offset)`, `tau = n_s^T (d_s u)`.
pub(super) struct Plant<'a> {
    model: &'a Model,
    pub(super) parameters: DynamicParameters,
    pub(super) sign: Sign,
    workspace: Workspace,
    /// `n_s`: motors per joints, in the true joint units.
    coupling: Coupling,
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
    /// Scratch: joint positions less the offset, and motor torques in joint units.
    scratch: Vec<f64>,
}

impl<'a> Plant<'a> {
    pub(super) fn new(setup: &ClosedLoop<'a>, theta: &[f64]) -> Self {
        let n = setup.model.coordinate_count();
        let ratio = setup.bias.gear_ratio;
        let joints_per_motor = setup.transmission.joints_per_motor();
        let drive = setup.transmission.drive_to_joint_units();
        Self {
            parameters: DynamicParameters::new(setup.model, &with_friction(setup, theta)),
            sign: Sign::Smooth { scale: setup.sign_velocity_scale },
            workspace: Workspace::new(setup.model),
            coupling: Coupling::new(&setup.transmission.motor_in_joint_units(), ratio),
            joints_per_motor: Matrix::from_fn(n, n, |i, j| joints_per_motor.at(i, j) / ratio),
            offset: setup.transmission.offset(),
            drive: drive.iter().map(|d| setup.bias.drive_gain * d).collect(),
            model: setup.model,
            p: vec![0.0; n],
            v: vec![0.0; n],
            tau: vec![0.0; n],
            scratch: vec![0.0; n],
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
        self.scratch.iter_mut().zip(q.iter().zip(self.offset)).for_each(|(s, (q, o))| *s = q - o);
        self.coupling.to_motors(&self.scratch, &mut self.p);
        self.coupling.to_motors(dq, &mut self.v);
    }

    /// Leaves the joint torques of drive signals `u` in `tau`.
    #[inline]
    pub(super) fn drive(&mut self, u: &[f64]) {
        self.scratch.iter_mut().zip(u.iter().zip(&self.drive)).for_each(|(s, (u, d))| *s = d * u);
        self.coupling.transpose_to_joints(&self.scratch, &mut self.tau);
    }

    /// The joint accelerations over a motion; the error is that of the first sample, from zero, that has none.
    pub(super) fn accelerations_of(&self, motion: [&Series; 3]) -> Result<Series, (usize, DynamicsError)> {
        self.model.forward_dynamics_series(&self.parameters, motion, self.sign)
    }

    /// The joint accelerations that the torques last applied give in a state.
    #[inline]
    pub(super) fn accelerations(&mut self, x: &[f64], ddq: &mut [f64]) -> Result<(), DynamicsError> {
        let (q, dq) = x.split_at(self.p.len());
        self.model.forward_dynamics(&self.parameters, State { q, dq }, &self.tau, self.sign, &mut self.workspace, ddq)
    }
}

/// Standard parameters with the friction of a biased simulator.
fn with_friction(setup: &ClosedLoop<'_>, theta: &[f64]) -> Vec<f64> {
    let factor = |friction: bool| if friction { setup.bias.friction } else { 1.0 };
    let table = setup.model.parameter_table().iter();
    theta.iter().zip(table).map(|(t, p)| t * factor(p.quantity.is_friction())).collect()
}

/// The reference in the motors' coordinates, `p_ref = n (q_ref - offset)`, with the true transmission and the biases of a
/// simulator: `q_0 + scale (q - q_0) + offset`, later by a delay.
pub(super) struct MotorReference {
    reference: Reference,
    delay_s: f64,
    /// The time last evaluated: the last stages of a step, and the first of the next, share one.
    time_s: f64,
    /// Position of each motor in joint units at the time last evaluated.
    pub(super) p: Vec<f64>,
    /// Its velocity.
    pub(super) dp: Vec<f64>,
    /// Its acceleration.
    pub(super) ddp: Vec<f64>,
}

impl MotorReference {
    /// The reference with its own biases; `delay_s` moves it in time.
    pub(super) fn new(reference: &Reference, transmission: &Transmission, bias: &SimulatorBias, delay_s: f64) -> Self {
        let coupling = Coupling::new(&transmission.motor_in_joint_units(), 1.0);
        let to_motors = |joints: &[f64]| {
            let mut motors = vec![0.0; joints.len()];
            coupling.to_motors(joints, &mut motors);
            motors
        };
        let zeros = || vec![0.0; transmission.joints()];
        let [mut start, mut dq, mut ddq] = [zeros(), zeros(), zeros()];
        reference.evaluate(0.0, &mut start, &mut dq, &mut ddq);
        let (scale, offset) = (bias.reference_scale, bias.reference_offset);
        let biased = |q: f64, start: f64| if scale == 1.0 { q + offset } else { start + scale * (q - start) + offset };
        let position = |q: &[f64]| {
            let each = q.iter().zip(start.iter().zip(transmission.offset()));
            to_motors(&each.map(|(q, (start, zero))| biased(*q, *start) - zero).collect::<Vec<_>>())
        };
        let rate = |dq: &[f64]| to_motors(&dq.iter().map(|v| scale * v).collect::<Vec<_>>());
        let reference = reference.mapped(&position, &rate);
        Self { reference, delay_s, time_s: f64::NAN, p: zeros(), dp: zeros(), ddp: zeros() }
    }

    #[inline]
    pub(super) fn evaluate(&mut self, t: f64) {
        if t != self.time_s {
            self.time_s = t;
            self.reference.evaluate(t - self.delay_s, &mut self.p, &mut self.dp, &mut self.ddp);
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
