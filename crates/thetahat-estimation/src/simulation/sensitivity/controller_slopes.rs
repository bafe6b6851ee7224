//! How the drive signals of a controller change, in a given state, with the sensitivity parameters.

use super::{
    columns::ColumnBlocks,
    sensitive_to::{Motors, SensitiveTo},
};
use crate::{
    control::{Controller, Law},
    simulation::{closed_loop::Job, system::Loop},
};

/// The derivatives `du/dp` of the drive signals with the state held, motors by columns.
pub(super) struct ControllerSlopes {
    /// Gains, gear ratio and delay, each with its column.
    tuned: Vec<(usize, Tuned)>,
    by_inertia: Option<ByInertia>,
    /// The derivatives of the motors' reference in time: velocity, acceleration, jerk.
    rates: [Vec<f64>; 3],
}

/// Parameters that act on the drive signals themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tuned {
    PositionGain(Motors),
    VelocityGain(Motors),
    /// The velocity gain of a cascade, which multiplies the position loop too.
    CascadeGain(Motors),
    /// The gear ratio in the positions that a continuous controller observes.
    GearRatio,
    /// The delay of a continuous controller's reference.
    Delay,
}

/// Gains that follow from the inertia.
struct ByInertia {
    /// The gains per inertia.
    per_inertia: Controller,
    /// Whether position and velocity gains also follow from the inertia.
    by_bandwidth: bool,
    /// The derivatives of the inertia, motors by columns.
    slopes: ColumnBlocks,
}

impl ControllerSlopes {
    /// `inertia_slopes` are the derivatives of the motors' inertia, for each column one value per motor.
    pub(super) fn new(job: &Job<'_>, to: &[SensitiveTo], inertia_slopes: Option<&[Vec<f64>]>) -> Self {
        let description = job.closed_loop.controller;
        let motors = job.motor_inertia.len();
        let by_inertia = |columns: &[Vec<f64>]| {
            let mut slopes = ColumnBlocks::zeros(motors, to.len());
            let values = columns.iter().enumerate();
            values.for_each(|(column, of_motors)| slopes.add_column(column, of_motors.iter().copied()));
            let per_inertia = description.resolve(&vec![1.0; motors], job.closed_loop.bias.controller_gain);
            ByInertia { per_inertia, by_bandwidth: !description.bandwidth_hz.is_empty(), slopes }
        };
        let is_sampled = description.sample_time_s > 0.0;
        let tuned = |(column, to): (usize, &SensitiveTo)| {
            Tuned::of(*to, description.law, is_sampled).map(|tuned| (column, tuned))
        };
        Self {
            tuned: to.iter().enumerate().filter_map(tuned).collect(),
            by_inertia: inertia_slopes.map(by_inertia),
            rates: [(); 3].map(|()| vec![0.0; motors]),
        }
    }

    /// Whether every column is zero.
    pub(super) fn is_empty(&self) -> bool {
        self.tuned.is_empty() && self.by_inertia.is_none()
    }

    /// Writes the derivatives at the time and the state last observed; zeros where the limit acts.
    pub(super) fn write(&mut self, system: &mut Loop<'_>, out: &mut ColumnBlocks) {
        out.fill_with_zeros();
        if self.tuned.iter().any(|(_, tuned)| *tuned == Tuned::Delay) {
            system.reference.rates(&mut self.rates);
        }
        let Loop { controller, reference, plant, .. } = system;
        for i in 0..plant.p.len() {
            let (p, v, dr, ddr) = (plant.p[i], plant.v[i], reference.dp[i], reference.ddp[i]);
            let error = reference.p[i] - p;
            if controller.is_limited(i, error, v, dr, ddr) {
                continue;
            }
            let [position, velocity, _] = controller.parts(i, error, v, dr, ddr);
            for (column, tuned) in &self.tuned {
                let slope = match tuned {
                    Tuned::PositionGain(motors) => motors.factor(i) * position,
                    Tuned::VelocityGain(motors) => motors.factor(i) * velocity,
                    Tuned::CascadeGain(motors) => motors.factor(i) * (position + velocity),
                    Tuned::GearRatio => controller
                        .derivative_of_own(i, [error, v, dr, ddr], [-p, v, 0.0, 0.0])
                        .unwrap_or_else(|| controller.parts(i, -p, v, 0.0, 0.0).iter().sum()),
                    Tuned::Delay => -self.rate_of_command(controller, i, [error, v, dr, ddr]),
                };
                out.add(i, *column, slope);
            }
            if let Some(ByInertia { per_inertia, by_bandwidth, slopes }) = &self.by_inertia {
                let [position, velocity, acceleration] = per_inertia.parts(i, error, v, dr, ddr);
                let pd = if *by_bandwidth { position + velocity } else { 0.0 };
                out.add_row(i, pd + acceleration, slopes, i);
            }
        }
    }

    /// The derivative in time of a motor's drive signal with its state held.
    fn rate_of_command(&self, controller: &Controller, i: usize, state: [f64; 4]) -> f64 {
        let [dr, ddr, dddr] = self.rates.each_ref().map(|rate| rate[i]);
        let of_own = controller.derivative_of_own(i, state, [dr, 0.0, ddr, dddr]);
        of_own.unwrap_or_else(|| controller.parts(i, dr, 0.0, ddr, dddr).iter().sum())
    }
}

impl Tuned {
    fn of(to: SensitiveTo, law: Law, is_sampled: bool) -> Option<Self> {
        match to {
            SensitiveTo::PositionGain(motors) => Some(Self::PositionGain(motors)),
            SensitiveTo::VelocityGain(motors) => match law {
                Law::Pd => Some(Self::VelocityGain(motors)),
                Law::Cascaded => Some(Self::CascadeGain(motors)),
                Law::OpenLoop => None,
            },
            SensitiveTo::GearRatio => (!is_sampled).then_some(Self::GearRatio),
            SensitiveTo::Delay => (!is_sampled).then_some(Self::Delay),
            SensitiveTo::DriveGain(_) | SensitiveTo::Parameter(_) | SensitiveTo::FrictionTransition => None,
        }
    }
}

/// The negated derivatives of a motor's signal with respect to position and velocity in the state last observed: zero at its limit.
pub(super) fn gains(Loop { controller, reference, plant, .. }: &Loop<'_>, i: usize) -> [f64; 2] {
    controller.slopes(i, reference.p[i] - plant.p[i], plant.v[i], reference.dp[i], reference.ddp[i])
}
