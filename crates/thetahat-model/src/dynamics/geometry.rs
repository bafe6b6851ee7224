use super::{
    motion::LinkMotion,
    rotation::{Rotation, Turn},
    sign::Sign,
    state::{JointCoordinate, State},
    terms::JointState,
    twist::Twist,
};
use crate::robot::{JointKind, Robot};
use thetahat_ground::{
    real::Real,
    vector::{Vec3, add, in_lanes},
};

/// The parent of joints on the base: beyond any joint, so that `get` finds none.
pub(super) const BASE: usize = usize::MAX;

/// A joint as the kernels need it: its placement with precomputed sines, and the coordinate that moves it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointGeometry {
    pub(super) revolute: bool,
    /// The joint whose link carries it, or [`BASE`].
    pub(super) parent: usize,
    /// Whether the parent is the previous joint in the list.
    pub(super) continues_chain: bool,
    /// `Rot(z, gamma)`, from the frame before to the one in which `origin` and the rotations are given; none if gamma is zero.
    pub(super) turn: Option<Turn>,
    sin_alpha: f64,
    cos_alpha: f64,
    theta: f64,
    origin: Vec3,
    /// The coordinate that moves it, with the offset.
    pub(super) moved_by: JointCoordinate,
    /// Further coordinates that move it at the same time, and their ratios.
    pub(super) also_moved_by: Vec<(usize, f64)>,
}

impl JointGeometry {
    pub(super) fn new(robot: &Robot, j: usize, coordinates: &[usize]) -> Self {
        let joint = &robot.joints[j];
        let (leader, ratio, offset) = joint.mimic.map_or((j, 1.0, 0.0), |m| (m.of, m.ratio, m.offset));
        let coordinate_of = |leader: usize| coordinates.iter().position(|&c| c == leader).unwrap_or(0);
        let coordinate = coordinate_of(leader);
        let (sin_gamma, cos_gamma) = joint.placement.gamma.sin_cos();
        let (sin_alpha, cos_alpha) = joint.placement.alpha.sin_cos();
        let turn = (joint.placement.gamma != 0.0).then_some(Turn { sin: sin_gamma, cos: cos_gamma });
        Self {
            revolute: match joint.kind {
                JointKind::Revolute => true,
                JointKind::Prismatic => false,
            },
            parent: joint.parent.unwrap_or(BASE),
            continues_chain: j > 0 && joint.parent == Some(j - 1),
            turn,
            sin_alpha,
            cos_alpha,
            theta: joint.placement.theta,
            origin: turn.map_or(joint.placement.origin, |turn| turn.transpose_times(joint.placement.origin)),
            moved_by: JointCoordinate { coordinate, ratio, offset, kind: joint.kind },
            also_moved_by: joint.also_follows.iter().map(|share| (coordinate_of(share.of), share.ratio)).collect(),
        }
    }

    /// The coordinates that move it, and their ratios.
    #[inline(always)]
    pub(super) fn shares(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        [(self.moved_by.coordinate, self.moved_by.ratio)].into_iter().chain(self.also_moved_by.iter().copied())
    }

    /// Its position.
    #[inline(always)]
    pub(super) fn position<T: Real>(&self, q: &[T]) -> T {
        let first = self.moved_by.position(q);
        if self.also_moved_by.is_empty() { first } else { self.with_shares(first, q) }
    }

    /// Its velocity or acceleration.
    #[inline(always)]
    pub(super) fn rate<T: Real>(&self, rates: &[T]) -> T {
        let first = self.moved_by.rate(rates);
        if self.also_moved_by.is_empty() { first } else { self.with_shares(first, rates) }
    }

    /// Its position, velocity and acceleration, if it follows one joint at most.
    #[inline(always)]
    pub(super) fn motion_of_first<T: Real>(&self, state: State<'_, T>, ddq: &[T]) -> [T; 3] {
        [self.moved_by.position(state.q), self.moved_by.rate(state.dq), self.moved_by.rate(ddq)]
    }

    /// The same of any joint.
    #[inline(always)]
    pub(super) fn motion<T: Real>(&self, state: State<'_, T>, ddq: &[T]) -> [T; 3] {
        [self.position(state.q), self.rate(state.dq), self.rate(ddq)]
    }

    /// A joint that follows several is rare: what it takes is kept out of the kernels.
    #[cold]
    #[inline(never)]
    fn with_shares<T: Real>(&self, first: T, values: &[T]) -> T {
        self.also_moved_by.iter().fold(first, |sum, &(c, ratio)| sum + values[c] * ratio)
    }

    #[cold]
    #[inline(never)]
    fn drive_state_with_shares<T: Real>(&self, state: State<'_, T>, ddq: &[T], sign: Sign) -> JointState<T> {
        JointState::new(self.rate(state.dq), self.rate(ddq), (sign, self.moved_by.kind))
    }

    #[cold]
    #[inline(never)]
    pub(super) fn project_shares<T: Real>(&self, torque: T, tau: &mut [T]) {
        for &(c, ratio) in &self.also_moved_by {
            tau[c] += torque * ratio;
        }
    }

    /// Adds the torques on the coordinates of a torque on the joint.
    #[inline(always)]
    pub(super) fn project<T: Real>(&self, torque: T, tau: &mut [T]) {
        tau[self.moved_by.coordinate] += torque * self.moved_by.ratio;
        if !self.also_moved_by.is_empty() {
            self.project_shares(torque, tau);
        }
    }

    /// The state on which the torque of its drive depends.
    #[inline(always)]
    pub(super) fn drive_state<T: Real>(&self, state: State<'_, T>, ddq: &[T], sign: Sign) -> JointState<T> {
        let first = self.moved_by.state(state, ddq, sign);
        if self.also_moved_by.is_empty() { first } else { self.drive_state_with_shares(state, ddq, sign) }
    }

    /// Rotation from the joint's frame to the turned frame before, and its origin there, at the coordinates `q`.
    #[inline(always)]
    pub(super) fn placement<T: Real>(&self, q: &[T]) -> (Rotation<T>, Vec3<T>) {
        self.placement_at(self.position(q))
    }

    /// The same at the joint's own position.
    #[inline(always)]
    fn placement_at<T: Real>(&self, q: T) -> (Rotation<T>, Vec3<T>) {
        let origin = in_lanes(q, self.origin);
        let (theta, p) = if self.revolute {
            (q + q.like(self.theta), origin)
        } else {
            (q.like(self.theta), add(origin, [q.like(0.0), -q * self.sin_alpha, q * self.cos_alpha]))
        };
        let (sin_theta, cos_theta) = theta.sin_cos();
        (Rotation { sin_alpha: self.sin_alpha, cos_alpha: self.cos_alpha, sin_theta, cos_theta }, p)
    }

    /// The joint's axis in the turned frame before, along which a prismatic joint moves.
    #[inline(always)]
    pub(super) fn sliding_axis<T: Real>(&self, kind: T) -> Vec3<T> {
        in_lanes(kind, [0.0, -self.sin_alpha, self.cos_alpha])
    }

    /// Transforms a vector of the frame before to the turned frame.
    #[inline(always)]
    pub(super) fn turned_back<T: Real>(&self, x: Vec3<T>) -> Vec3<T> {
        match &self.turn {
            None => x,
            Some(turn) => turn.transpose_times(x),
        }
    }

    /// The twist, at the joint's own frame, of a unit velocity of a coordinate that moves it by this ratio.
    #[inline(always)]
    pub(super) fn twist<T: Real>(&self, kind: T, ratio: f64) -> Twist<T> {
        let (z, zero) = (in_lanes(kind, [0.0, 0.0, ratio]), [kind.like(0.0); 3]);
        if self.revolute { Twist { angular: z, linear: zero } } else { Twist { angular: zero, linear: z } }
    }

    /// Propagates motion from the parent link to the joint's link, given the joint's own.
    #[inline(always)]
    pub(super) fn propagate<T: Real>(&self, mut before: LinkMotion<T>, [q, dq, ddq]: [T; 3]) -> LinkMotion<T> {
        if let Some(turn) = &self.turn {
            before = before.turned_back(turn);
        }
        let (r, p) = self.placement_at(q);
        let w = r.transpose_times(before.w);
        let dw = r.transpose_times(before.dw);
        let dv = r.transpose_times(before.acceleration_at(p));
        // Products with the z axis are written out: w x (0, 0, dq) = (w_y dq, -w_x dq, 0).
        if self.revolute {
            let dw = [dw[0] + w[1] * dq, dw[1] - w[0] * dq, dw[2] + ddq];
            LinkMotion { r, p, w: [w[0], w[1], w[2] + dq], dw, dv }
        } else {
            let dv = [dv[0] + w[1] * 2.0 * dq, dv[1] - w[0] * 2.0 * dq, dv[2] + ddq];
            LinkMotion { r, p, w, dw, dv }
        }
    }
}
