//! Velocities and accelerations of all joints from those of the robot's coordinates.

use super::spin::Spin;
use crate::dynamics::{
    frames::JointFrame,
    model::{ClosedTree, DynamicsError, Model},
    workspace::LoopScratch,
};
use thetahat_ground::vector::{add, cross, scale, sub};

impl ClosedTree {
    /// Writes position, velocity and acceleration of all joints, and `G`, to the scratch.
    ///
    /// # Errors
    /// As [`Self::place`].
    pub(crate) fn move_all(&self, [q, dq, ddq]: [&[f64]; 3], scratch: &mut LoopScratch) -> Result<(), DynamicsError> {
        self.place(q, scratch)?;
        self.rates(dq, scratch);
        self.drift(scratch);
        let own = self.independent.len();
        scratch.rest.copy_from_slice(&scratch.drift);
        self.solve(scratch);
        let LoopScratch { slopes, ddq: all, solved, .. } = scratch;
        for (tree, slopes) in all.iter_mut().zip(slopes.chunks_exact(own.max(1))) {
            *tree = slopes.iter().zip(ddq).map(|(slope, rate)| slope * rate).sum();
        }
        self.passive.iter().zip(solved).for_each(|(&c, drift)| all[c] -= *drift);
        Ok(())
    }

    /// `dq = G dq_a`.
    pub(super) fn rates(&self, dq: &[f64], scratch: &mut LoopScratch) {
        let own = self.independent.len();
        let LoopScratch { slopes, dq: all, .. } = scratch;
        for (tree, slopes) in all.iter_mut().zip(slopes.chunks_exact(own.max(1))) {
            *tree = slopes.iter().zip(dq).map(|(slope, rate)| slope * rate).sum();
        }
    }
}

impl Model {
    /// The motion of the links, in the frame of the base, where the coordinates have velocities and no accelerations.
    pub(super) fn spins_into(&self, frames: &[JointFrame], dq: &[f64], spins: &mut Vec<Spin>) {
        spins.clear();
        for (joint, frame) in self.joints.iter().zip(frames) {
            let before = spins.get(joint.parent).copied().unwrap_or_default();
            let start = frames.get(joint.parent).map_or([0.0; 3], |parent| parent.origin);
            let [v, a] = before.of_point(sub(frame.origin, start));
            let moved = scale(joint.rate(dq), frame.rotation.map(|row| row[2]));
            let turned = cross(before.w, moved);
            spins.push(if joint.revolute {
                Spin { w: add(before.w, moved), dw: add(before.dw, turned), v, a }
            } else {
                Spin { v: add(v, moved), a: add(a, scale(2.0, turned)), ..before }
            });
        }
    }
}
