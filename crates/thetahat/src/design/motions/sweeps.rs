//! Sweeps of single joints at constant velocities, after the moves of a design: there and back from its first posture.

use crate::design::{
    error::DesignError,
    limits::joint_limits::JointLimits,
    motions::moves::{MoveFamily, Sweep},
    search::information::Information,
    text::description::Design,
};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
};

impl Design {
    /// The sweeps of a design: joint by joint, the slowest first, there and back, while shapes stay apart. Empty if the design
    /// has no sweeps.
    ///
    /// # Errors
    /// [`DesignError::NoRoomToSweep`].
    pub(in crate::design) fn sweeps(&self, model: &Model, kept: &[JointLimits]) -> Result<Vec<Sweep>, DesignError> {
        let Some(start) = self.start_posture().filter(|_| self.file.motion.sweeps() > 0) else { return Ok(Vec::new()) };
        let (family, clearances) = (self.move_family(kept, Vec::new()), self.clearances(model)?);
        let mut sweeps = Vec::new();
        for (joint, limits) in kept.iter().enumerate() {
            let way = self.sweep_way(joint, limits, &start, clearances.as_ref())?;
            sweeps.extend(self.sweeps_of(&family, joint, way, &start));
        }
        Ok(sweeps)
    }

    fn sweeps_of(&self, family: &MoveFamily, joint: usize, way: f64, start: &[f64]) -> Vec<Sweep> {
        let motion = &self.file.motion;
        let (speeds, longest_s) = (motion.sweeps(), motion.sweep_s());
        let fastest = fastest(&family.limits[joint], way.abs(), longest_s);
        let one = |number: usize| {
            let part = if speeds > 1 { number as f64 / (speeds - 1) as f64 } else { 1.0 };
            let velocity = fastest * motion.sweep_slowest().powf(1.0 - part);
            let mut end = start.to_vec();
            end[joint] += way.signum() * way.abs().min(velocity * longest_s);
            let mut slow = family.clone();
            slow.limits[joint].velocity = velocity;
            let widths = slow.fastest(start, &end);
            [Sweep { joint, end, widths }, Sweep { joint, end: start.to_vec(), widths }]
        };
        (0..speeds).flat_map(one).collect()
    }

    /// The information of the sweeps on the base parameters: from the rows of the joint that moves, since the others rest.
    pub(in crate::design) fn information_of_sweeps(
        &self,
        model: &Model,
        base: &BaseParameters,
        family: &MoveFamily,
    ) -> Option<Matrix> {
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
