use super::rotation::{Rotation, Turn};
use thetahat_ground::{
    real::Real,
    vector::{Mat3, Vec3, add, cross, in_lanes, transpose_times},
};

/// Placement of one link in the turned frame before it (see [`Turn`]), and its motion in its own frame.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LinkMotion<T = f64> {
    pub(crate) r: Rotation<T>,
    pub(crate) p: Vec3<T>,
    pub(crate) w: Vec3<T>,
    pub(crate) dw: Vec3<T>,
    pub(crate) dv: Vec3<T>,
}

impl<T: Real> LinkMotion<T> {
    /// A link at rest with acceleration `dv`, less gravity.
    #[inline(always)]
    pub(super) fn at_rest(kind: T, dv: Vec3) -> Self {
        let zero = kind.like(0.0);
        let r = Rotation { sin_alpha: 0.0, cos_alpha: 1.0, sin_theta: zero, cos_theta: kind.like(1.0) };
        Self { r, p: [zero; 3], w: [zero; 3], dw: [zero; 3], dv: in_lanes(kind, dv) }
    }

    /// Acceleration, less gravity, of the point of the link at `p`.
    #[inline(always)]
    pub(super) fn acceleration_at(&self, p: Vec3<T>) -> Vec3<T> {
        let centripetal = cross(self.w, cross(self.w, p));
        add(self.dv, add(cross(self.dw, p), centripetal))
    }

    /// Transforms the motion to the frame turned by gamma.
    #[inline(always)]
    pub(super) fn turned_back(&self, turn: &Turn) -> Self {
        let [w, dw, dv] = [self.w, self.dw, self.dv];
        Self { w: turn.transpose_times(w), dw: turn.transpose_times(dw), dv: turn.transpose_times(dv), ..*self }
    }

    /// The motion in the link's own axes, `x_here = axes x_link`.
    #[inline(always)]
    pub(crate) fn in_axes(&self, axes: &Mat3) -> Self {
        let [w, dw, dv] = [self.w, self.dw, self.dv];
        Self { w: transpose_times(axes, w), dw: transpose_times(axes, dw), dv: transpose_times(axes, dv), ..*self }
    }
}
