//! How the torques of the drives change with the state and with the sensitivity parameters.

use super::{
    columns::{ColumnBlocks, add_product},
    controller_slopes::ControllerSlopes,
    held_slopes::HeldSlopes,
    linear_terms::LinearTerms,
    sensitive_to::{Motors, SensitiveTo},
};
use crate::simulation::{closed_loop::Job, running::Running, system::Loop};

/// The derivatives of the joint torques `n_s^T (d_s u)`.
pub(super) struct TorqueSlopes {
    controller: ControllerSlopes,
    /// None for a continuous controller.
    held: Option<HeldSlopes>,
    /// The columns of drive gains.
    drive_gains: Vec<(usize, Motors)>,
    /// The columns of the gear ratio.
    gear_ratio: Vec<usize>,
    /// Scratch: derivatives of the drive signals of a continuous controller.
    signals: ColumnBlocks,
}

impl TorqueSlopes {
    pub(super) fn new(
        job: &Job<'_>,
        running: &mut Running<'_>,
        to: &[SensitiveTo],
        inertia_slopes: Option<&[Vec<f64>]>,
        start: &ColumnBlocks,
    ) -> Self {
        let columns = to.iter().enumerate();
        Self {
            controller: ControllerSlopes::new(job, to, inertia_slopes),
            held: running.sampling.is_some().then(|| HeldSlopes::new(running, to, start)),
            drive_gains: columns.filter_map(|(column, to)| to.drive_gain().map(|motors| (column, motors))).collect(),
            gear_ratio: SensitiveTo::GearRatio.columns_of(to),
            signals: ColumnBlocks::zeros(job.motor_inertia.len(), to.len()),
        }
    }

    pub(super) fn follow_interval(&mut self, running: &mut Running<'_>, state: &ColumnBlocks) {
        if let Some(held) = &mut self.held {
            held.follow(running, &mut self.controller, state);
        }
    }

    pub(super) fn torque_drop(&self) -> Option<&[f64]> {
        self.held.as_ref().map(|held| &held.torque_drop[..])
    }

    /// `tau_p`, K and D at time `t` and state `x`; the signals of a sampled controller are the held ones.
    pub(super) fn linearise(&mut self, system: &mut Loop<'_>, t: f64, x: &[f64], out: &mut LinearTerms) {
        out.fill_with_zeros();
        system.apply_torques(t, x);
        if let Some(held) = &self.held {
            add_joint_torques(system, &held.acting, &mut out.explicit);
        } else {
            system.add_drive_slopes(&mut out.by_position, &mut out.by_velocity);
            if !self.controller.is_empty() {
                self.controller.write(system, &mut self.signals);
                add_joint_torques(system, &self.signals, &mut out.explicit);
            }
        }
        let plant = &system.plant;
        for &column in &self.gear_ratio {
            out.explicit.add_column(column, plant.tau.iter().copied());
        }
        for &(column, motors) in &self.drive_gains {
            for &(i, j, w) in plant.coupling.entries().iter().filter(|(i, ..)| motors.contains(*i)) {
                out.explicit.add(j, column, w * plant.drive[i] * system.u[i]);
            }
        }
    }
}

/// Adds the joint torques of drive signals, `n_s^T (d_s u)`, for each column.
fn add_joint_torques(system: &Loop<'_>, signals: &ColumnBlocks, joints: &mut ColumnBlocks) {
    for block in 0..signals.blocks() {
        for &(i, j, w) in system.plant.coupling.entries() {
            add_product(&mut joints.block_mut(block)[j], w * system.plant.drive[i], &signals.block(block)[i]);
        }
    }
}
