//! The derivatives of a sampled controller's drive signals, held like the signals.

use std::collections::VecDeque;

use super::{
    columns::{ColumnBlocks, add_product},
    controller_slopes::{ControllerSlopes, gains},
    sensitive_to::SensitiveTo,
};
use crate::{
    control::VelocityEstimate,
    simulation::{running::Running, system::Loop},
};

/// The derivatives of the signals of a sampled controller, motors by columns: of the acting signal and of the delayed ones.
pub(super) struct HeldSlopes {
    /// `du/dp` of the acting signal.
    pub(super) acting: ColumnBlocks,
    waiting: VecDeque<ColumnBlocks>,
    /// Samples followed.
    samples: usize,
    /// The derivatives of the motors' positions at the two previous samples, the later one first.
    before: [ColumnBlocks; 2],
    gear_ratio: Vec<usize>,
    /// The acting signal, without a recorded one.
    signal: Vec<f64>,
    /// The fall of the joint torques at the last change of the signal.
    pub(super) torque_drop: Vec<f64>,
}

impl HeldSlopes {
    /// The slopes of a controller at rest in the initial state, whose sensitivities are `start`.
    pub(super) fn new(running: &mut Running<'_>, to: &[SensitiveTo], start: &ColumnBlocks) -> Self {
        let Running { system, integrator, .. } = running;
        let n = system.u.len();
        let gear_ratio = SensitiveTo::GearRatio.columns_of(to);
        system.plant.observe(integrator.state());
        let positions = of_motors(&gear_ratio, system, start, Rate::Position);
        Self {
            acting: ColumnBlocks::zeros(n, to.len()),
            waiting: VecDeque::new(),
            samples: 0,
            before: [positions.clone(), positions],
            gear_ratio,
            signal: vec![0.0; n],
            torque_drop: vec![0.0; n],
        }
    }

    /// Follows the controller into the interval just begun, where the state has the sensitivities `state`.
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
        let changes = self.signal.iter().zip(&sampling.commanded).zip(&system.plant.drive);
        let drop: Vec<f64> = changes.map(|((before, now), drive)| drive * (before - now)).collect();
        system.plant.coupling.transpose_to_joints(&drop, &mut self.torque_drop);
        self.signal.copy_from_slice(&sampling.commanded);
    }

    /// `du/dp` of the sample just taken.
    fn sample(&mut self, system: &mut Loop<'_>, slopes: &mut ControllerSlopes, state: &ColumnBlocks) -> ColumnBlocks {
        let mut signal = self.acting.clone();
        slopes.write(system, &mut signal);
        let positions = of_motors(&self.gear_ratio, system, state, Rate::Position);
        let velocities = match system.controller.velocity {
            VelocityEstimate::Exact => of_motors(&self.gear_ratio, system, state, Rate::Velocity),
            VelocityEstimate::AveragedDifference => self.averaged_velocities(system, &positions),
        };
        for motor in 0..system.u.len() {
            let [position, velocity] = gains(system, motor);
            signal.add_row(motor, -position, &positions, motor);
            signal.add_row(motor, -velocity, &velocities, motor);
        }
        self.before.swap(0, 1);
        self.before[0] = positions;
        signal
    }

    /// `(p_k - p_{k-2}) / (2 T)`, differentiated.
    fn averaged_velocities(&self, system: &Loop<'_>, positions: &ColumnBlocks) -> ColumnBlocks {
        let rate = 1.0 / (2.0 * system.controller.sample_time_s);
        let mut velocities = positions.with_rows(positions.rows());
        for motor in 0..positions.rows() {
            velocities.add_row(motor, rate, positions, motor);
            velocities.add_row(motor, -rate, &self.before[1], motor);
        }
        velocities
    }
}

/// Which half of the state.
#[derive(Clone, Copy)]
enum Rate {
    Position,
    Velocity,
}

/// The derivatives of the motors' positions or velocities, in the state last observed: `p = n_s (q - offset)`, and the gear
/// ratio is a factor of `n_s`.
fn of_motors(gear_ratio: &[usize], system: &Loop<'_>, state: &ColumnBlocks, rate: Rate) -> ColumnBlocks {
    let plant = &system.plant;
    let n = plant.p.len();
    let (first, own) = match rate {
        Rate::Position => (0, &plant.p),
        Rate::Velocity => (n, &plant.v),
    };
    let mut motors = state.with_rows(n);
    for block in 0..state.blocks() {
        for &(i, j, w) in plant.coupling.entries() {
            add_product(&mut motors.block_mut(block)[i], w, &state.block(block)[first + j]);
        }
    }
    gear_ratio.iter().for_each(|column| motors.add_column(*column, own.iter().copied()));
    motors
}
