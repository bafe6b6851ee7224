//! Reverse mode: derivatives of a scalar of the links' motion and twists with respect to the coordinates.

use super::{
    geometry::JointGeometry, model::Model, motion::LinkMotion, state::State, twist::Twist, workspace::Workspace,
};
use thetahat_ground::{
    real::Real,
    vector::{Mat3, Vec3, add, constant_times, cross, dot, scale},
};

/// The derivatives of a scalar with respect to velocities and accelerations of the links and to unit twists, in the layout of a
/// [`Workspace`].
#[derive(Debug, Clone)]
pub(crate) struct Adjoint<T = f64> {
    pub(crate) links: Vec<LinkAdjoint<T>>,
    pub(crate) twists: Vec<Twist<T>>,
}

/// The derivatives with respect to `w`, `dw` and `dv` of a link, in its frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinkAdjoint<T = f64> {
    pub(crate) w: Vec3<T>,
    pub(crate) dw: Vec3<T>,
    pub(crate) dv: Vec3<T>,
}

impl<T: Real> LinkAdjoint<T> {
    #[inline(always)]
    pub(crate) fn zero(kind: T) -> Self {
        let zero = [kind.like(0.0); 3];
        Self { w: zero, dw: zero, dv: zero }
    }

    /// `x_there = axes x_here`.
    #[inline(always)]
    pub(crate) fn out_of_axes(&self, axes: &Mat3) -> Self {
        let [w, dw, dv] = [self.w, self.dw, self.dv].map(|x| constant_times(axes, x));
        Self { w, dw, dv }
    }

    #[inline(always)]
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self { w: add(self.w, other.w), dw: add(self.dw, other.dw), dv: add(self.dv, other.dv) }
    }
}

impl<T: Real> Adjoint<T> {
    /// Zeros for a model.
    #[inline(always)]
    pub(crate) fn like(model: &Model, kind: T) -> Self {
        let zero = [kind.like(0.0); 3];
        Self {
            links: vec![LinkAdjoint::zero(kind); model.link_count()],
            twists: vec![Twist { angular: zero, linear: zero }; model.twist_count()],
        }
    }

    #[inline(always)]
    pub(crate) fn clear(&mut self, kind: T) {
        let zero = [kind.like(0.0); 3];
        self.links.iter_mut().for_each(|link| *link = LinkAdjoint::zero(kind));
        self.twists.iter_mut().for_each(|twist| *twist = Twist { angular: zero, linear: zero });
    }
}

/// The derivatives of one joint.
struct Slopes<T> {
    q: T,
    dq: T,
    ddq: T,
}

impl Model {
    /// Adds to `slopes` the derivatives with respect to `q`, `dq` and `ddq` of a scalar whose derivatives with respect to the
    /// links' motion and twists are given. The workspace holds motion and twists of the state; the adjoint is overwritten.
    #[inline(always)]
    pub(crate) fn pull_back<T: Real>(
        &self,
        state: State<'_, T>,
        workspace: &Workspace<T>,
        adjoint: &mut Adjoint<T>,
        [of_q, of_dq, of_ddq]: [&mut [T]; 3],
    ) {
        let Some(&kind) = state.q.first() else { return };
        let rest = LinkMotion::at_rest(kind, scale(-1.0, self.gravity));
        for (k, joint) in self.joints.iter().enumerate().rev() {
            let before = workspace.links.get(joint.parent).copied().unwrap_or(rest);
            let slopes = self.pull_back_joint(k, joint, state, &before, workspace, adjoint);
            joint.project(slopes.q, of_q);
            joint.project(slopes.dq, of_dq);
            joint.project(slopes.ddq, of_ddq);
        }
    }

    /// The slopes of one joint; the remaining adjoint is passed to the parent link.
    #[inline(always)]
    fn pull_back_joint<T: Real>(
        &self,
        k: usize,
        joint: &JointGeometry,
        state: State<'_, T>,
        before: &LinkMotion<T>,
        workspace: &Workspace<T>,
        adjoint: &mut Adjoint<T>,
    ) -> Slopes<T> {
        let before = match &joint.turn {
            None => *before,
            Some(turn) => before.turned_back(turn),
        };
        let (link, of_link) = (&workspace.links[k], adjoint.links[k]);
        let dq = joint.rate(state.dq);
        let (carried, mut slopes) = joint.pull_back_rates(link, &of_link, dq);
        let (mut parent, mut of_p) = carried_back(link, &before, &carried);
        let support = self.support(k).start;
        if let Some(of_parent) = self.supports().get(joint.parent) {
            for place in 0..of_parent.coordinates.len() {
                let (twist, of_twist) = (workspace.twists[support + place], adjoint.twists[support + place]);
                slopes.q += joint.turned(twist.angular, of_twist.angular) + joint.turned(twist.linear, of_twist.linear);
                let of_linear = link.r.times(of_twist.linear);
                let of_angular = add(link.r.times(of_twist.angular), cross(link.p, of_linear));
                // The twist of a prismatic joint has no angular part; for a revolute joint p does not move.
                of_p = add(of_p, cross(of_linear, link.r.times(twist.angular)));
                let back = Twist { angular: of_angular, linear: of_linear };
                let back = match &joint.turn {
                    None => back,
                    Some(turn) => Twist { angular: turn.times(back.angular), linear: turn.times(back.linear) },
                };
                let there = &mut adjoint.twists[of_parent.start + place];
                *there = there.plus(&back);
            }
        }
        if !joint.revolute {
            slopes.q += dot(of_p, joint.sliding_axis(dq));
        }
        if let Some(turn) = &joint.turn {
            let [w, dw, dv] = [parent.w, parent.dw, parent.dv].map(|x| turn.times(x));
            parent = LinkAdjoint { w, dw, dv };
        }
        if let Some(there) = adjoint.links.get_mut(joint.parent) {
            *there = there.plus(&parent);
        }
        slopes
    }
}

/// Transforms the adjoints of the parent's motion, seen at the joint, from the link's frame to the frame before, including that
/// of the joint's origin.
#[inline(always)]
fn carried_back<T: Real>(
    link: &LinkMotion<T>,
    before: &LinkMotion<T>,
    carried: &LinkAdjoint<T>,
) -> (LinkAdjoint<T>, Vec3<T>) {
    let (p, LinkMotion { w, dw, .. }) = (link.p, *before);
    let a = link.r.times(carried.dv);
    // a . (w x (w x p)) = (a . w) (w . p) - (a . p) (w . w)
    let (aw, wp, ap, ww) = (dot(a, w), dot(w, p), dot(a, p), dot(w, w));
    let of_w = add(add(scale(wp, a), scale(aw, p)), scale(ap * -2.0, w));
    let of_p = add(cross(a, dw), add(scale(aw, w), scale(-ww, a)));
    let parent =
        LinkAdjoint { w: add(link.r.times(carried.w), of_w), dw: add(link.r.times(carried.dw), cross(p, a)), dv: a };
    (parent, of_p)
}

impl JointGeometry {
    /// The derivatives with respect to the joint's own rates, and the adjoint of the parent's motion as seen in the link's
    /// frame.
    #[inline(always)]
    fn pull_back_rates<T: Real>(
        &self,
        link: &LinkMotion<T>,
        of: &LinkAdjoint<T>,
        dq: T,
    ) -> (LinkAdjoint<T>, Slopes<T>) {
        let LinkMotion { w, dw, dv, .. } = *link;
        let zero = dq.like(0.0);
        // x . (w x z), and z x x.
        let along = |x: Vec3<T>| x[0] * w[1] - x[1] * w[0];
        let about = |x: Vec3<T>| [-x[1], x[0], zero];
        if self.revolute {
            let seen = [dw[0] - w[1] * dq, dw[1] + w[0] * dq, zero];
            let carried = LinkAdjoint { w: add(of.w, scale(dq, about(of.dw))), ..*of };
            let q = self.turned(w, carried.w) + self.turned(seen, of.dw) + self.turned(dv, of.dv);
            (carried, Slopes { q, dq: of.w[2] + along(of.dw), ddq: of.dw[2] })
        } else {
            let carried = LinkAdjoint { w: add(of.w, scale(dq * 2.0, about(of.dv))), ..*of };
            (carried, Slopes { q: zero, dq: along(of.dv) * 2.0, ddq: of.dv[2] })
        }
    }

    /// The derivative of `a . R^T x` with respect to the angle, for `y = R^T x`: zero for a prismatic joint.
    #[inline(always)]
    fn turned<T: Real>(&self, y: Vec3<T>, a: Vec3<T>) -> T {
        if self.revolute { a[0] * y[1] - a[1] * y[0] } else { a[0].like(0.0) }
    }
}
