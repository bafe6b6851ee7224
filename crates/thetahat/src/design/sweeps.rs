//! Sweeps of single joints at constant velocities, behind the moves of a design: there and back from its first posture.

use super::{description::Design, information::Information, limits::JointLimits, moves::MoveFamily, sweep::Sweep};
use crate::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    linear_algebra::Matrix,
};

impl Design {
    /// The sweeps of a design: joint by joint, the slowest first, there and back. None where no first posture is given.
    pub(super) fn sweeps(&self, kept: &[JointLimits]) -> Vec<Sweep> {
        let Some(start) = self.start_posture() else { return Vec::new() };
        let family = self.move_family(kept, Vec::new());
        (0..kept.len()).flat_map(|joint| self.sweeps_of(&family, joint, &start)).collect()
    }

    fn sweeps_of(&self, family: &MoveFamily, joint: usize, start: &[f64]) -> Vec<Sweep> {
        let motion = &self.file.motion;
        let (speeds, longest_s) = (motion.sweeps(), motion.sweep_s());
        let limits = &family.limits[joint];
        let room = [limits.lower - start[joint], limits.upper - start[joint]];
        let farther = if -room[0] > room[1] { room[0] } else { room[1] };
        let fastest = fastest(limits, farther.abs(), longest_s);
        let one = |number: usize| {
            let part = if speeds > 1 { number as f64 / (speeds - 1) as f64 } else { 1.0 };
            let velocity = fastest * motion.sweep_slowest().powf(1.0 - part);
            let mut end = start.to_vec();
            end[joint] += farther.signum() * farther.abs().min(velocity * longest_s);
            let mut slow = family.clone();
            slow.limits[joint].velocity = velocity;
            let widths = slow.fastest(start, &end);
            [Sweep { joint, end, widths }, Sweep { joint, end: start.to_vec(), widths }]
        };
        (0..speeds).flat_map(one).collect()
    }

    /// What the sweeps tell of the base parameters: of each the rows of the joint that moves, since the others rest.
    pub(super) fn swept(&self, model: &Model, base: &BaseParameters, family: &MoveFamily) -> Option<Matrix> {
        if family.sweeps.is_empty() {
            return None;
        }
        let rate = self.file.sample_rate_hz;
        let of = |joint: usize| {
            let noise = (0..family.joints()).map(|j| if j == joint { self.noise.deviations[j] } else { f64::INFINITY });
            let information = Information::new(model, &base.columns(), &noise.collect::<Vec<_>>());
            let motion = family.sweep_motion(joint, rate);
            information.of([&motion.q, &motion.dq, &motion.ddq], 1.0, Sign::Exact)
        };
        (0..family.joints()).map(of).reduce(|sum, one| sum.plus(&one, 1.0))
    }
}

/// The velocity that a joint keeps for half of its way, or half of the time that a sweep may last.
fn fastest(limits: &JointLimits, way: f64, longest_s: f64) -> f64 {
    let half = 0.5 * limits.acceleration;
    limits.velocity.min((half * way).sqrt()).min(half * longest_s)
}
