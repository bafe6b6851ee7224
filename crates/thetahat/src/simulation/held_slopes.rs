//! The derivatives of a sampled controller's drive signals, held as the signals are.

use std::collections::VecDeque;

use super::{
    columns::{ColumnBlocks, add_product},
    controller_slopes::{ControllerSlopes, add_to_motors, gains},
    running::Running,
    sensitive_to::SensitiveTo,
    system::Loop,
};
use crate::control::VelocityEstimate;

/// The derivatives of the signals of a sampled controller, motors by columns: of the one that acts and of those on their way.
pub(super) struct HeldSlopes {
    /// `du/dp` of the signal that acts.
    pub(super) acting: ColumnBlocks,
    waiting: VecDeque<ColumnBlocks>,
    /// Samples followed.
    samples: usize,
    /// `dp/dp` of the motors' positions at the two samples before.
    before: [ColumnBlocks; 2],
    gear_ratio: Vec<usize>,
    /// The signal that acts, without a recorded one.
    signal: Vec<f64>,
    /// What the last change of the signal took away from the joint torques, for a derivative by the delay.
    pub(super) torque_drop: Vec<f64>,
}

impl HeldSlopes {
    /// Those of a controller at rest; `state` are the derivatives of the initial state.
    pub(super) fn new(running: &mut Running<'_>, to: &[SensitiveTo], start: &[f64], state: &ColumnBlocks) -> Self {
        let system = &mut running.system;
        let n = system.u.len();
        let zeros = || ColumnBlocks::zeros(n, to.len());
        let columns = to.iter().enumerate().filter(|(_, to)| **to == SensitiveTo::GearRatio);
        let gear_ratio: Vec<usize> = columns.map(|(column, _)| column).collect();
        system.plant.observe(start);
        let mut positions = zeros();
        write_motors(system, &gear_ratio, state, 0, &mut positions);
        Self {
            acting: zeros(),
            waiting: VecDeque::new(),
            samples: 0,
            before: [positions.clone(), positions],
            gear_ratio,
            signal: vec![0.0; n],
            torque_drop: vec![0.0; n],
        }
    }

    /// Follows the controller into the interval just begun, where the state has the derivatives `state`.
    pub(super) fn follow(&mut self, running: &mut Running<'_>, slopes: &mut ControllerSlopes, state: &ColumnBlocks) {
        let Running { system, sampling: Some(sampling), .. } = running else { return };
        if sampling.samples > self.samples {
            self.samples = sampling.samples;
            let sampled = self.sample(system, slopes, state);
            self.waiting.push_back(sampled);
        }
        while self.waiting.len() > sampling.waiting() {
            if let Some(next) = self.waiting.pop_front() {
                self.acting = next;
            }
        }
        let drop = self.signal.iter().zip(&sampling.commanded).zip(&system.plant.drive);
        let of_motors: Vec<f64> = drop.map(|((before, now), drive)| drive * (before - now)).collect();
        system.plant.coupling.transpose_to_joints(&of_motors, &mut self.torque_drop);
        self.signal.copy_from_slice(&sampling.commanded);
    }

    /// `du/dp` of the sample just taken.
    fn sample(&mut self, system: &mut Loop<'_>, slopes: &mut ControllerSlopes, state: &ColumnBlocks) -> ColumnBlocks {
        let n = system.u.len();
        let mut signal = self.acting.clone();
        slopes.write(system, &mut signal);
        let [mut positions, mut velocities] = [(); 2].map(|()| self.acting.clone());
        match system.controller.velocity {
            VelocityEstimate::Exact => {
                write_motors(system, &self.gear_ratio, state, n, &mut velocities);
                write_motors(system, &self.gear_ratio, state, 0, &mut positions);
            }
            VelocityEstimate::AveragedDifference => {
                write_motors(system, &self.gear_ratio, state, 0, &mut positions);
                let rate = 1.0 / (2.0 * system.controller.sample_time_s);
                velocities.fill_with_zeros();
                (0..n).for_each(|i| velocities.add_row(i, rate, &positions, i));
                (0..n).for_each(|i| velocities.add_row(i, -rate, &self.before[1], i));
            }
        }
        for i in 0..n {
            let [position, velocity] = gains(system, i);
            signal.add_row(i, -position, &positions, i);
            signal.add_row(i, -velocity, &velocities, i);
        }
        self.before.swap(0, 1);
        self.before[0] = positions;
        signal
    }
}

/// Writes the derivatives of the motors' positions (rows of `state` from 0) or velocities (from n) in the state last observed.
fn write_motors(system: &Loop<'_>, gear_ratio: &[usize], state: &ColumnBlocks, first: usize, out: &mut ColumnBlocks) {
    out.fill_with_zeros();
    add_to_motors(system, state, first, out);
    let own = if first == 0 { &system.plant.p } else { &system.plant.v };
    for column in gear_ratio {
        own.iter().enumerate().for_each(|(i, value)| out.add(i, *column, *value));
    }
}

/// `to += sum_i w_ij d_i of_motor_i`: the joint torques of drive signals.
pub(super) fn add_joint_torques(system: &Loop<'_>, signals: &ColumnBlocks, joints: &mut ColumnBlocks) {
    for block in 0..signals.blocks() {
        for &(i, j, w) in system.plant.coupling.entries() {
            add_product(&mut joints.block_mut(block)[j], w * system.plant.drive[i], &signals.block(block)[i]);
        }
    }
}
