use std::collections::VecDeque;

use super::system::{Loop, SAME_TIME};
use crate::control::VelocityEstimate;

/// A sampled controller: each drive signal acts after the delay, and is held until the next.
pub(super) struct Sampling {
    positions: PositionHistory,
    /// Delayed signals, and when they act.
    waiting: VecDeque<(f64, Vec<f64>)>,
    pub(super) commanded: Vec<f64>,
    /// Samples taken.
    pub(super) samples: usize,
}

impl Sampling {
    pub(super) fn new(system: &mut Loop<'_>, start: &[f64]) -> Self {
        system.plant.observe(start);
        let p = &system.plant.p;
        Self {
            positions: PositionHistory { one_before: p.clone(), two_before: p.clone() },
            waiting: VecDeque::new(),
            commanded: vec![0.0; p.len()],
            samples: 0,
        }
    }

    /// Sets the drive signals from `t` on in the system and returns the time until which they hold.
    pub(super) fn hold(&mut self, system: &mut Loop<'_>, t: f64, state: &[f64]) -> f64 {
        let period = system.controller.sample_time_s;
        if t >= (self.samples as f64 - SAME_TIME) * period {
            let u = self.sample(system, t, state);
            self.waiting.push_back((t + system.controller.delay_s, u));
            self.samples += 1;
        }
        while self.waiting.front().is_some_and(|(due, _)| t >= due - SAME_TIME * period) {
            self.commanded = self.waiting.pop_front().map_or_else(Vec::new, |(_, u)| u);
        }
        system.u.copy_from_slice(&self.commanded);
        system.add_recorded_signal(t);
        let due = self.waiting.front().map_or(f64::INFINITY, |(due, _)| *due);
        (self.samples as f64 * period).min(due)
    }

    /// Number of delayed signals.
    pub(super) fn waiting(&self) -> usize {
        self.waiting.len()
    }

    fn sample(&mut self, system: &mut Loop<'_>, t: f64, state: &[f64]) -> Vec<f64> {
        let Loop { reference, plant, controller, .. } = system;
        reference.evaluate(t);
        plant.observe(state);
        if controller.velocity == VelocityEstimate::AveragedDifference {
            self.positions.averaged_velocity(controller.sample_time_s, &plant.p, &mut plant.v);
        }
        self.positions.push(&plant.p);
        let sample = |i: usize| {
            let error = reference.p[i] - plant.p[i];
            controller.sample(i, error, plant.v[i], reference.dp[i], reference.ddp[i])
        };
        (0..self.commanded.len()).map(sample).collect()
    }
}

/// The motor positions at the two previous samples.
struct PositionHistory {
    one_before: Vec<f64>,
    two_before: Vec<f64>,
}

impl PositionHistory {
    fn averaged_velocity(&self, period: f64, p: &[f64], v: &mut [f64]) {
        for (v, (now, before)) in v.iter_mut().zip(p.iter().zip(&self.two_before)) {
            *v = (now - before) / (2.0 * period);
        }
    }

    fn push(&mut self, p: &[f64]) {
        std::mem::swap(&mut self.one_before, &mut self.two_before);
        self.one_before.copy_from_slice(p);
    }
}
