//! The simulated robot in motor coordinates.

use super::{closed_loop::ClosedLoop, coupling::Coupling, motion::OutputGrid};
use thetahat_ground::{linear_algebra::Matrix, series::Series};
use thetahat_model::dynamics::{DampingWorkspace, DynamicParameters, DynamicsError, Model, Sign, State, Workspace};

/// The simulated robot: `p = n_s (q - offset)`, `tau = n_s^T (d_s u)`.
pub(super) struct Plant<'a> {
    pub(super) model: &'a Model,
    pub(super) parameters: DynamicParameters,
    pub(super) sign: Sign,
    workspace: Workspace,
    damping: DampingWorkspace,
    /// `n_s`: motors per joints, in the true joint units.
    pub(super) coupling: Coupling,
    joints_per_motor: Matrix,
    pub(super) offset: &'a [f64],
    /// `d_s`: torque in joint units per drive signal.
    pub(super) drive: Vec<f64>,
    /// Motor positions in joint units, as last observed.
    pub(super) p: Vec<f64>,
    /// Motor velocities in joint units, as last observed.
    pub(super) v: Vec<f64>,
    /// Joint torques, as last applied.
    pub(super) tau: Vec<f64>,
    /// The recorded channels, as last observed.
    pub(super) channels: Vec<f64>,
    recorded: Option<(&'a Series, f64)>,
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
            parameters: DynamicParameters::sorted(setup.model, &with_friction(setup, theta)),
            sign: Sign::smooth(setup.sign_velocity_scale),
            workspace: Workspace::new(setup.model),
            damping: DampingWorkspace::default(),
            coupling: Coupling::new(&setup.transmission.motor_in_joint_units(), ratio),
            joints_per_motor: Matrix::from_fn(n, n, |i, j| joints_per_motor.at(i, j) / ratio),
            offset: setup.transmission.offset(),
            drive: drive.iter().map(|d| setup.bias.drive_gain * d).collect(),
            model: setup.model,
            p: vec![0.0; n],
            v: vec![0.0; n],
            tau: vec![0.0; n],
            channels: setup.channels.map_or_else(Vec::new, |(series, _)| vec![0.0; series.channels()]),
            recorded: setup.channels,
            scratch: vec![0.0; n],
        }
    }

    /// `q = n_s^-1 p + offset`.
    pub(super) fn joint_positions(&self, p: &[f64]) -> Vec<f64> {
        self.joints_per_motor.times(p).iter().zip(self.offset).map(|(q, o)| q + o).collect()
    }

    /// `dq = n_s^-1 dp`.
    pub(super) fn joint_velocities(&self, dp: &[f64]) -> Vec<f64> {
        self.joints_per_motor.times(dp)
    }

    /// Writes the motor positions and velocities of a state to `p` and `v`.
    #[inline]
    pub(super) fn observe(&mut self, x: &[f64]) {
        let (q, dq) = x.split_at(self.p.len());
        self.scratch.iter_mut().zip(q.iter().zip(self.offset)).for_each(|(s, (q, o))| *s = q - o);
        self.coupling.to_motors(&self.scratch, &mut self.p);
        self.coupling.to_motors(dq, &mut self.v);
    }

    /// Writes the joint torques of drive signals `u` to `tau`.
    #[inline]
    pub(super) fn drive(&mut self, u: &[f64]) {
        self.scratch.iter_mut().zip(u.iter().zip(&self.drive)).for_each(|(s, (u, d))| *s = d * u);
        self.coupling.transpose_to_joints(&self.scratch, &mut self.tau);
    }

    /// Writes the recorded channels at a time to `channels`.
    #[inline]
    pub(super) fn observe_channels(&mut self, t: f64) {
        if let Some((series, rate)) = self.recorded {
            interpolate(series, t * rate, &mut self.channels);
        }
    }

    /// The joint accelerations over a motion on a grid of times; the error names the first sample, from zero, without a solution.
    pub(super) fn accelerations_of(
        &self,
        motion: [&Series; 3],
        grid: &OutputGrid,
    ) -> Result<Series, (usize, DynamicsError)> {
        let at_grid = |(series, rate): (&Series, f64)| {
            let mut channels = Series::zeros(motion[0].len(), series.channels());
            (0..channels.len()).for_each(|k| interpolate(series, grid.time(k) * rate, channels.sample_mut(k)));
            channels
        };
        let channels = self.recorded.map(at_grid);
        self.model.forward_dynamics_with_channels(&self.parameters, motion, channels.as_ref(), self.sign)
    }

    /// The damping of the friction in a state.
    pub(super) fn friction_damping(&mut self, x: &[f64], d: &mut [f64]) {
        let (q, dq) = x.split_at(self.p.len());
        let state = State::new(q, dq).with_channels(&self.channels);
        self.model.damping_into(&self.parameters, state, self.sign, &mut self.damping, d);
    }

    /// Adds the joint stiffness or damping of drive signals that fall by `slopes` per motor position or velocity.
    pub(super) fn add_drive_slopes(&self, slopes: &[f64], matrix: &mut [f64]) {
        self.coupling.add_quadratic(|i| self.drive[i] * slopes[i], self.p.len(), matrix);
    }

    /// The mass matrix of the last accelerations, as `L` with `1/D` on its diagonal.
    pub(super) fn factored_mass_matrix(&self) -> &[f64] {
        self.workspace.factored_mass_matrix()
    }

    /// The joint accelerations that the torques last applied give in a state.
    #[inline]
    pub(super) fn accelerations(&mut self, x: &[f64], ddq: &mut [f64]) -> Result<(), DynamicsError> {
        let (q, dq) = x.split_at(self.p.len());
        let state = State::new(q, dq).with_channels(&self.channels);
        self.model.forward_dynamics(&self.parameters, state, &self.tau, self.sign, &mut self.workspace, ddq)
    }
}

/// The value of a series at a fractional sample index; the first and last sample beyond the ends.
pub(super) fn interpolate(series: &Series, place: f64, out: &mut [f64]) {
    let last = series.len() - 1;
    let place = place.clamp(0.0, last as f64);
    let before = (place as usize).min(last.saturating_sub(1));
    let part = place - before as f64;
    let (from, to) = (series.sample(before), series.sample((before + 1).min(last)));
    out.iter_mut().zip(from.iter().zip(to)).for_each(|(out, (from, to))| *out = from + part * (to - from));
}

/// Standard parameters with the friction of a biased simulator.
fn with_friction(setup: &ClosedLoop<'_>, theta: &[f64]) -> Vec<f64> {
    let factor = |friction: bool| if friction { setup.bias.friction } else { 1.0 };
    let table = setup.model.parameter_table().iter();
    theta.iter().zip(table).map(|(t, p)| t * factor(p.quantity.is_friction())).collect()
}
