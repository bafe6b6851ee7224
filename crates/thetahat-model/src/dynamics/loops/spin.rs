//! How a link turns and moves.

use thetahat_ground::vector::{Vec3, add, cross};

/// Velocity and acceleration of a link, in the frame of the base: `w`, `dw`, and `v`, `a` of its frame's origin.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::dynamics) struct Spin {
    pub(super) w: Vec3,
    pub(super) dw: Vec3,
    pub(super) v: Vec3,
    pub(super) a: Vec3,
}

impl Spin {
    /// Velocity and acceleration of a point of the link at `arm` from the frame's origin.
    pub(super) fn of_point(&self, arm: Vec3) -> [Vec3; 2] {
        let turning = cross(self.w, arm);
        [add(self.v, turning), add(self.a, add(cross(self.dw, arm), cross(self.w, turning)))]
    }
}
