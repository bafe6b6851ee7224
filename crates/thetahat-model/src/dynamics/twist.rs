use super::{motion::LinkMotion, rotation::Turn};
use thetahat_ground::{
    real::Real,
    vector::{Mat3, Vec3, add, cross, transpose_times},
};

/// Angular and linear velocity at the origin of a frame, in that frame, for a unit velocity of a coordinate.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Twist<T = f64> {
    pub(crate) angular: Vec3<T>,
    pub(crate) linear: Vec3<T>,
}

impl<T: Real> Twist<T> {
    /// The twist as seen from the next frame.
    #[inline(always)]
    pub(super) fn seen_from(&self, next: &LinkMotion<T>) -> Self {
        let linear = add(self.linear, cross(self.angular, next.p));
        Self { angular: next.r.transpose_times(self.angular), linear: next.r.transpose_times(linear) }
    }

    /// The twist in other axes, `x_here = axes x_there`.
    #[inline(always)]
    pub(crate) fn in_axes(&self, axes: &Mat3) -> Self {
        Self { angular: transpose_times(axes, self.angular), linear: transpose_times(axes, self.linear) }
    }

    /// The twist in the frame turned by gamma.
    #[inline(always)]
    pub(super) fn turned_back(&self, turn: &Turn) -> Self {
        Self { angular: turn.transpose_times(self.angular), linear: turn.transpose_times(self.linear) }
    }

    /// The sum of two twists of one frame.
    #[inline(always)]
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self { angular: add(self.angular, other.angular), linear: add(self.linear, other.linear) }
    }
}
