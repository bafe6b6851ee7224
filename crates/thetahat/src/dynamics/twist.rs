use super::{Model, algorithms::LinkMotion, rotation::Turn};
use crate::{
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
    /// The same twist, seen from the next frame.
    #[inline(always)]
    fn seen_from(&self, next: &LinkMotion<T>) -> Self {
        let linear = add(self.linear, cross(self.angular, next.p));
        Self { angular: next.r.transpose_times(self.angular), linear: next.r.transpose_times(linear) }
    }

    /// The same twist in other axes, `x_here = axes x_there`.
    #[inline(always)]
    pub(crate) fn in_axes(&self, axes: &Mat3) -> Self {
        Self { angular: transpose_times(axes, self.angular), linear: transpose_times(axes, self.linear) }
    }

    #[inline(always)]
    fn turned_back(&self, turn: &Turn) -> Self {
        Self { angular: turn.transpose_times(self.angular), linear: turn.transpose_times(self.linear) }
    }

    #[inline(always)]
    fn plus(&self, other: &Self) -> Self {
        Self { angular: add(self.angular, other.angular), linear: add(self.linear, other.linear) }
    }
}

impl Model {
    /// The unit twists of link `k`, one for each coordinate of its support, from those of its parent.
    #[inline(always)]
    pub(crate) fn propagate_twists<T: Real>(&self, k: usize, links: &[LinkMotion<T>], twists: &mut [Twist<T>]) {
        let joint = &self.joints[k];
        let support = self.support(k);
        let (before, here) = twists.split_at_mut(support.start);
        let here = &mut here[..support.coordinates.len()];
        let mut carried = 0;
        if let Some(parent) = self.supports().get(joint.parent) {
            carried = parent.coordinates.len();
            let of_parent = &before[parent.start..parent.start + carried];
            let link = &links[k];
            for (twist, before) in here.iter_mut().zip(of_parent) {
                let turned = match &joint.turn {
                    None => *before,
                    Some(turn) => before.turned_back(turn),
                };
                *twist = turned.seen_from(link);
            }
        }
        let own = joint.twist(links[k].dv[0]);
        here[support.own] = if support.own < carried { here[support.own].plus(&own) } else { own };
    }
}
