//! The loop linearised in a state: by the state, exactly, and by what it is sensitive to.

use pulp::{Simd, WithSimd};

use super::{
    closed_loop::Job,
    columns::{ColumnBlocks, add_product},
    controller_slopes::ControllerSlopes,
    held_slopes::{HeldSlopes, add_joint_torques},
    sensitive_to::{Motors, SensitiveTo},
    system::Loop,
};
use crate::{
    dynamics::{Jacobian, JacobianWorkspace, State, Workspace},
    regressor::Regressor,
};

/// The torques of the drives and the accelerations as linear functions of the sensitivities S of the state (positions, then
/// velocities):
///
/// `d tau/dp = tau_p - K S_q - D S_dq` and `M d ddq/dp = tau_p - phi_p - A S_q - B S_dq`, with `A = K + d ID/dq` and
/// `B = D + d ID/d dq`.
pub(super) struct LoopSlopes {
    /// Where each entry of phi goes, and its factor: that of a biased friction.
    phi_places: Vec<(usize, usize, f64)>,
    regressor: Regressor,
    phi: Vec<f64>,
    workspace: Workspace,
    jacobian: Jacobian,
    jacobian_workspace: JacobianWorkspace,
    controller: ControllerSlopes,
    drive_gains: Vec<(usize, Motors)>,
    gear_ratio: Vec<usize>,
    /// K and D, row by row; then A and B.
    by_position: Vec<f64>,
    by_velocity: Vec<f64>,
    /// `tau_p`; then `tau_p - phi_p`.
    explicit: ColumnBlocks,
    /// Scratch: derivatives of the drive signals.
    signals: ColumnBlocks,
}

impl LoopSlopes {
    pub(super) fn new(job: &Job<'_>, to: &[SensitiveTo], inertia_slopes: Option<&[Vec<f64>]>) -> Self {
        let setup = &job.closed_loop;
        let n = setup.model.coordinate_count();
        let parameter = |(column, to): (usize, &SensitiveTo)| match to {
            SensitiveTo::Parameter(index) => Some((column, *index)),
            SensitiveTo::PositionGain(_)
            | SensitiveTo::VelocityGain(_)
            | SensitiveTo::DriveGain(_)
            | SensitiveTo::GearRatio
            | SensitiveTo::Delay => None,
        };
        let (columns, indices): (Vec<usize>, Vec<usize>) = to.iter().enumerate().filter_map(parameter).unzip();
        let regressor = Regressor::new(setup.model, &indices);
        let factor = |column: usize| {
            let is_friction = setup.model.parameter_table().get(indices[column]).quantity.is_friction();
            if is_friction { setup.bias.friction } else { 1.0 }
        };
        let place = |entry: &crate::regressor::Entry| (entry.joint, columns[entry.column], factor(entry.column));
        let drive_gain = |(column, to): (usize, &SensitiveTo)| match to {
            SensitiveTo::DriveGain(motors) => Some((column, *motors)),
            SensitiveTo::PositionGain(_)
            | SensitiveTo::VelocityGain(_)
            | SensitiveTo::Parameter(_)
            | SensitiveTo::GearRatio
            | SensitiveTo::Delay => None,
        };
        let gear_ratio = to.iter().enumerate().filter(|(_, to)| **to == SensitiveTo::GearRatio);
        Self {
            phi_places: regressor.entries().iter().map(place).collect(),
            phi: vec![0.0; regressor.entries().len()],
            regressor,
            workspace: Workspace::new(setup.model),
            jacobian: Jacobian::zeros(n),
            jacobian_workspace: JacobianWorkspace::new(setup.model),
            controller: ControllerSlopes::new(job, to, inertia_slopes),
            drive_gains: to.iter().enumerate().filter_map(drive_gain).collect(),
            gear_ratio: gear_ratio.map(|(column, _)| column).collect(),
            by_position: vec![0.0; n * n],
            by_velocity: vec![0.0; n * n],
            explicit: ColumnBlocks::zeros(n, to.len()),
            signals: ColumnBlocks::zeros(n, to.len()),
        }
    }

    pub(super) fn controller_mut(&mut self) -> &mut ControllerSlopes {
        &mut self.controller
    }

    /// Linearises the torques of the drives at time `t` and state `x`: `tau_p`, K and D. A sampled controller has its held
    /// signals.
    pub(super) fn linearise_torques(&mut self, system: &mut Loop<'_>, held: Option<&HeldSlopes>, t: f64, x: &[f64]) {
        system.apply_torques(t, x);
        self.by_position.fill(0.0);
        self.by_velocity.fill(0.0);
        self.explicit.fill_with_zeros();
        if let Some(held) = held {
            add_joint_torques(system, &held.acting, &mut self.explicit);
        } else {
            system.add_drive_slopes(&mut self.by_position, &mut self.by_velocity);
            if !self.controller.is_empty() {
                self.controller.write(system, &mut self.signals);
                add_joint_torques(system, &self.signals, &mut self.explicit);
            }
        }
        for &column in &self.gear_ratio {
            system.plant.tau.iter().enumerate().for_each(|(j, tau)| self.explicit.add(j, column, *tau));
        }
        for &(column, motors) in &self.drive_gains {
            for &(i, j, w) in system.plant.coupling.entries().iter().filter(|(i, ..)| motors.contains(*i)) {
                self.explicit.add(j, column, w * system.plant.drive[i] * system.u[i]);
            }
        }
    }

    /// Linearises the accelerations, `M d ddq/dp`, where they are `ddq`.
    pub(super) fn linearise_accelerations(
        &mut self,
        system: &mut Loop<'_>,
        held: Option<&HeldSlopes>,
        t: f64,
        x: &[f64],
        ddq: &[f64],
    ) {
        self.linearise_torques(system, held, t, x);
        let plant = &system.plant;
        let (q, dq) = x.split_at(ddq.len());
        let state = State { q, dq };
        let Self { jacobian, jacobian_workspace, .. } = self;
        plant.model.inverse_dynamics_jacobian(&plant.parameters, state, ddq, plant.sign, jacobian_workspace, jacobian);
        self.by_position.iter_mut().zip(&jacobian.by_position).for_each(|(a, j)| *a += j);
        self.by_velocity.iter_mut().zip(&jacobian.by_velocity).for_each(|(b, j)| *b += j);
        self.regressor.evaluate(plant.model, state, ddq, plant.sign, &mut self.workspace, &mut self.phi);
        for (&(row, column, factor), value) in self.phi_places.iter().zip(&self.phi) {
            self.explicit.add(row, column, -factor * value);
        }
    }

    /// The torque derivatives of sensitivities `state`, as linearised by [`Self::linearise_torques`].
    pub(super) fn torques(&self, state: &ColumnBlocks, out: &mut ColumnBlocks) {
        pulp::Arch::new().dispatch(RightSides { slopes: self, state, out });
    }

    /// The slopes of sensitivities `state`, as linearised by [`Self::linearise_accelerations`]; `mass` are the factors of the
    /// mass matrix there.
    pub(super) fn slopes(&self, state: &ColumnBlocks, mass: &[f64], out: &mut ColumnBlocks) {
        pulp::Arch::new().dispatch(Slopes { slopes: self, state, mass, out });
    }

    /// Row `i` of a block of `explicit - A S_q - B S_dq`.
    #[inline(always)]
    fn right_side(&self, i: usize, block: usize, state: &[[f64; 8]]) -> [f64; 8] {
        let n = state.len() / 2;
        let (q, dq) = state.split_at(n);
        let mut right = self.explicit.block(block)[i];
        let row = i * n..(i + 1) * n;
        for (a, s) in self.by_position[row.clone()].iter().zip(q) {
            add_product(&mut right, -a, s);
        }
        for (b, s) in self.by_velocity[row].iter().zip(dq) {
            add_product(&mut right, -b, s);
        }
        right
    }
}

struct RightSides<'a> {
    slopes: &'a LoopSlopes,
    state: &'a ColumnBlocks,
    out: &'a mut ColumnBlocks,
}

impl WithSimd for RightSides<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for block in 0..self.state.blocks() {
            let state = self.state.block(block);
            for (i, out) in self.out.block_mut(block).iter_mut().enumerate() {
                *out = self.slopes.right_side(i, block, state);
            }
        }
    }
}

struct Slopes<'a> {
    slopes: &'a LoopSlopes,
    state: &'a ColumnBlocks,
    mass: &'a [f64],
    out: &'a mut ColumnBlocks,
}

impl WithSimd for Slopes<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for block in 0..self.state.blocks() {
            let state = self.state.block(block);
            let (velocities, accelerations) = self.out.block_mut(block).split_at_mut(state.len() / 2);
            velocities.copy_from_slice(&state[velocities.len()..]);
            for (i, out) in accelerations.iter_mut().enumerate() {
                *out = self.slopes.right_side(i, block, state);
            }
            solve_block(self.mass, accelerations);
        }
    }
}

/// Solves `L D L^T x = b` in place for the columns of a block, with `1/D` on the diagonal of the factors.
#[inline(always)]
pub(super) fn solve_block(factors: &[f64], b: &mut [[f64; 8]]) {
    let n = b.len();
    for i in 1..n {
        let (before, rest) = b.split_at_mut(i);
        for (l, x) in factors[i * n..].iter().zip(&*before) {
            add_product(&mut rest[0], -l, x);
        }
    }
    for i in (0..n).rev() {
        let (before, behind) = b.split_at_mut(i + 1);
        let inverse = factors[i * n + i];
        before[i].iter_mut().for_each(|x| *x *= inverse);
        for (k, x) in behind.iter().enumerate() {
            add_product(&mut before[i], -factors[(i + 1 + k) * n + i], x);
        }
    }
}
