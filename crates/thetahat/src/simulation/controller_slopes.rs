//! How the drive signals of a controller change with what it is sensitive to, in a given state.

use super::{
    closed_loop::Job,
    columns::{ColumnBlocks, add_product},
    sensitive_to::SensitiveTo,
    system::Loop,
};
use crate::control::{Controller, Law};

/// The columns of the drive signals' explicit derivatives, `du/dp` with the state held.
pub(super) struct ControllerSlopes {
    /// Gains, gear ratio and delay, each with its column.
    tuned: Vec<(usize, SensitiveTo)>,
    /// The controller's gains per inertia, and `dJ/dp`: motors by columns.
    by_inertia: Option<(Controller, ColumnBlocks)>,
    /// Whether position and velocity gains follow from the inertia too.
    by_bandwidth: bool,
    /// Whether a velocity gain multiplies the position loop.
    cascaded: bool,
    /// The derivatives of the motors' reference in time: velocity, acceleration, jerk.
    rates: [Vec<f64>; 3],
}

impl ControllerSlopes {
    /// `inertia_slopes` are the derivatives of the motors' inertia, for each column one value per motor.
    pub(super) fn new(job: &Job<'_>, to: &[SensitiveTo], inertia_slopes: Option<&[Vec<f64>]>) -> Self {
        let description = job.closed_loop.controller;
        let motors = job.motor_inertia.len();
        let tuned = |(_, to): &(usize, SensitiveTo)| match to {
            SensitiveTo::PositionGain(_)
            | SensitiveTo::VelocityGain(_)
            | SensitiveTo::GearRatio
            | SensitiveTo::Delay => true,
            SensitiveTo::Parameter(_) | SensitiveTo::DriveGain(_) => false,
        };
        let by_inertia = inertia_slopes.map(|slopes| {
            let mut columns = ColumnBlocks::zeros(motors, to.len());
            for (column, slopes) in slopes.iter().enumerate() {
                slopes.iter().enumerate().for_each(|(motor, slope)| columns.add(motor, column, *slope));
            }
            (description.resolve(&vec![1.0; motors], job.closed_loop.bias.controller_gain), columns)
        });
        Self {
            tuned: to.iter().copied().enumerate().filter(tuned).collect(),
            by_inertia,
            by_bandwidth: !description.bandwidth_hz.is_empty(),
            cascaded: description.law == Law::Cascaded,
            rates: [(); 3].map(|()| vec![0.0; motors]),
        }
    }

    /// Whether every column is zero.
    pub(super) fn is_empty(&self) -> bool {
        self.tuned.is_empty() && self.by_inertia.is_none()
    }

    /// Writes the columns, motors by columns, at the time and the state last observed.
    pub(super) fn write(&mut self, system: &mut Loop<'_>, out: &mut ColumnBlocks) {
        out.fill_with_zeros();
        if !system.controller.is_sampled() && self.tuned.iter().any(|(_, to)| *to == SensitiveTo::Delay) {
            system.reference.rates(&mut self.rates);
        }
        for motor in 0..system.u.len() {
            if !is_limited(system, motor) {
                self.write_motor(system, motor, out);
            }
        }
    }

    fn write_motor(&self, system: &Loop<'_>, i: usize, out: &mut ColumnBlocks) {
        let Loop { controller, reference, plant, .. } = system;
        let (p, v, dr, ddr) = (plant.p[i], plant.v[i], reference.dp[i], reference.ddp[i]);
        let error = reference.p[i] - p;
        let [position, velocity, _] = controller.parts(i, error, v, dr, ddr);
        for (column, to) in &self.tuned {
            let slope = match to {
                SensitiveTo::PositionGain(motors) if motors.contains(i) => position,
                SensitiveTo::VelocityGain(motors) if motors.contains(i) && self.cascaded => position + velocity,
                SensitiveTo::VelocityGain(motors) if motors.contains(i) => velocity,
                // A sampled controller takes the motors' own derivatives.
                SensitiveTo::GearRatio if !controller.is_sampled() => controller.parts(i, -p, v, 0.0, 0.0).iter().sum(),
                SensitiveTo::Delay if !controller.is_sampled() => {
                    let [dr, ddr, dddr] = [0, 1, 2].map(|rate: usize| self.rates[rate][i]);
                    -controller.parts(i, dr, 0.0, ddr, dddr).iter().sum::<f64>()
                }
                SensitiveTo::PositionGain(_)
                | SensitiveTo::VelocityGain(_)
                | SensitiveTo::GearRatio
                | SensitiveTo::Delay
                | SensitiveTo::DriveGain(_)
                | SensitiveTo::Parameter(_) => 0.0,
            };
            out.add(i, *column, slope);
        }
        if let Some((per_inertia, slopes)) = &self.by_inertia {
            let [position, velocity, acceleration] = per_inertia.parts(i, error, v, dr, ddr);
            let part = if self.by_bandwidth { position + velocity + acceleration } else { acceleration };
            out.add_row(i, part, slopes, i);
        }
    }
}

/// Whether the limit acts on a motor in the state last observed.
pub(super) fn is_limited(Loop { controller, reference, plant, .. }: &Loop<'_>, i: usize) -> bool {
    let error = reference.p[i] - plant.p[i];
    controller.is_limited(i, error, plant.v[i], reference.dp[i], reference.ddp[i])
}

/// The gains of a motor where the limit does not act on it: what a position and a velocity take away from its signal.
pub(super) fn gains(Loop { controller, reference, plant, .. }: &Loop<'_>, i: usize) -> [f64; 2] {
    let error = reference.p[i] - plant.p[i];
    controller.slopes(i, error, plant.v[i], reference.dp[i], reference.ddp[i])
}

/// `motors += n_s joints`, the rows of joints starting at `first`.
pub(super) fn add_to_motors(system: &Loop<'_>, joints: &ColumnBlocks, first: usize, motors: &mut ColumnBlocks) {
    for block in 0..joints.blocks() {
        for &(i, j, w) in system.plant.coupling.entries() {
            add_product(&mut motors.block_mut(block)[i], w, &joints.block(block)[first + j]);
        }
    }
}
