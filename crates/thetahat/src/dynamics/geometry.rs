use super::{
    algorithms::LinkMotion,
    rotation::{Rotation, Turn},
    twist::Twist,
};
use crate::{
    robot::{JointKind, Robot},
    vector::{Vec3, add},
};

/// The parent of joints on the base: beyond any joint, so that `get` finds none.
pub(super) const BASE: usize = usize::MAX;

/// A joint as the kernels need it: its placement with the sines taken, and the coordinate that moves it.
#[derive(Debug, Clone)]
pub(super) struct JointGeometry {
    pub(super) revolute: bool,
    /// The joint whose link carries it, or [`BASE`].
    pub(super) parent: usize,
    /// Whether that is the joint before it in the list.
    pub(super) continues_chain: bool,
    /// `Rot(z, gamma)`, from the frame before to the one in which `origin` and the rotations are; none where gamma is zero.
    pub(super) turn: Option<Turn>,
    sin_alpha: f64,
    cos_alpha: f64,
    theta: f64,
    origin: Vec3,
    pub(super) coordinate: usize,
    /// Velocity per velocity of the coordinate: one but for joints that follow others.
    pub(super) ratio: f64,
    offset: f64,
}

impl JointGeometry {
    pub(super) fn new(robot: &Robot, j: usize, coordinates: &[usize]) -> Self {
        let joint = &robot.joints[j];
        let (leader, ratio, offset) = joint.mimic.map_or((j, 1.0, 0.0), |m| (m.of, m.ratio, m.offset));
        let (sin_gamma, cos_gamma) = joint.placement.gamma.sin_cos();
        let (sin_alpha, cos_alpha) = joint.placement.alpha.sin_cos();
        let turn = (joint.placement.gamma != 0.0).then_some(Turn { sin: sin_gamma, cos: cos_gamma });
        Self {
            revolute: joint.kind == JointKind::Revolute,
            parent: joint.parent.unwrap_or(BASE),
            continues_chain: j > 0 && joint.parent == Some(j - 1),
            turn,
            sin_alpha,
            cos_alpha,
            theta: joint.placement.theta,
            origin: turn.map_or(joint.placement.origin, |turn| turn.transpose_times(joint.placement.origin)),
            coordinate: coordinates.iter().position(|&c| c == leader).unwrap_or(0),
            ratio,
            offset,
        }
    }

    /// Rotation from the joint's frame to the turned one before, and its origin there, at the coordinates `q`.
    #[inline]
    pub(super) fn placement(&self, q: &[f64]) -> (Rotation, Vec3) {
        let q = self.ratio * q[self.coordinate] + self.offset;
        let (theta, p) = if self.revolute {
            (self.theta + q, self.origin)
        } else {
            (self.theta, add(self.origin, [0.0, -q * self.sin_alpha, q * self.cos_alpha]))
        };
        let (sin_theta, cos_theta) = theta.sin_cos();
        (Rotation { sin_alpha: self.sin_alpha, cos_alpha: self.cos_alpha, sin_theta, cos_theta }, p)
    }

    /// A vector of the frame before, in the turned one.
    #[inline]
    pub(super) fn turned_back(&self, x: Vec3) -> Vec3 {
        self.turn.as_ref().map_or(x, |turn| turn.transpose_times(x))
    }

    /// The joint's own velocity or acceleration, of those of the coordinates.
    #[inline]
    pub(super) fn rate(&self, rates: &[f64]) -> f64 {
        self.ratio * rates[self.coordinate]
    }

    /// The twist, at the joint's own frame, of a unit velocity of its coordinate.
    #[inline]
    pub(super) fn twist(&self) -> Twist {
        let (z, zero) = ([0.0, 0.0, self.ratio], [0.0; 3]);
        if self.revolute { Twist { angular: z, linear: zero } } else { Twist { angular: zero, linear: z } }
    }

    /// The motion of the link behind the joint, of that of the link before.
    #[inline]
    pub(super) fn propagate(&self, mut before: LinkMotion, q: &[f64], dq: &[f64], ddq: &[f64]) -> LinkMotion {
        if let Some(turn) = &self.turn {
            before = before.turned_back(turn);
        }
        let (r, p) = self.placement(q);
        let (dq, ddq) = (self.rate(dq), self.rate(ddq));
        let w = r.transpose_times(before.w);
        let dw = r.transpose_times(before.dw);
        let dv = r.transpose_times(before.acceleration_at(p));
        // Products with the z axis are written out: w x (0, 0, dq) = (w_y dq, -w_x dq, 0).
        if self.revolute {
            let dw = [dw[0] + w[1] * dq, dw[1] - w[0] * dq, dw[2] + ddq];
            LinkMotion { r, p, w: [w[0], w[1], w[2] + dq], dw, dv }
        } else {
            let dv = [dv[0] + 2.0 * w[1] * dq, dv[1] - 2.0 * w[0] * dq, dv[2] + ddq];
            LinkMotion { r, p, w, dw, dv }
        }
    }
}
