//! Outward recursion over the links: placements, motion and unit twists.

use super::{model::Model, motion::LinkMotion, state::State, twist::Twist};
use thetahat_ground::{real::Real, vector::scale};

impl Model {
    /// Forward pass of recursive Newton-Euler: placement, velocity and acceleration of every link.
    #[inline(always)]
    pub(crate) fn propagate_motion<T: Real>(&self, state: State<'_, T>, ddq: &[T], links: &mut [LinkMotion<T>]) {
        let Some(&kind) = state.q.first() else { return };
        if self.has_sums {
            return self.propagate_motion_of_sums(state, ddq, links);
        }
        let base = LinkMotion::at_rest(kind, scale(-1.0, self.gravity));
        let mut before = base;
        for (j, joint) in self.joints.iter().enumerate() {
            // In a chain the motion passes from link to link without going through memory.
            if !joint.continues_chain {
                before = links.get(joint.parent).copied().unwrap_or(base);
            }
            before = joint.propagate(before, joint.motion_of_first(state, ddq));
            links[j] = before;
        }
    }

    /// The same where a joint follows several others.
    #[cold]
    #[inline(never)]
    fn propagate_motion_of_sums<T: Real>(&self, state: State<'_, T>, ddq: &[T], links: &mut [LinkMotion<T>]) {
        let Some(&kind) = state.q.first() else { return };
        let base = LinkMotion::at_rest(kind, scale(-1.0, self.gravity));
        for (j, joint) in self.joints.iter().enumerate() {
            let before = links.get(joint.parent).copied().unwrap_or(base);
            links[j] = joint.propagate(before, joint.motion(state, ddq));
        }
    }

    /// The placements of the links only.
    #[inline(always)]
    pub(super) fn place(&self, q: &[f64], links: &mut [LinkMotion]) {
        for (joint, link) in self.joints.iter().zip(links) {
            (link.r, link.p) = joint.placement(q);
        }
    }

    /// The unit twists of link `k`, one for each coordinate of its support, from the parent link's twists.
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
        let kind = links[k].dv[0];
        let own = joint.twist(kind, joint.moved_by.ratio);
        here[support.own] = if support.own < carried { here[support.own].plus(&own) } else { own };
        if !support.also.is_empty() {
            self.add_twists_of_shares(k, carried, kind, here);
        }
    }

    /// The unit twists by the further joints that joint `k` follows; the first `carried` have those of the parent's link.
    #[cold]
    #[inline(never)]
    fn add_twists_of_shares<T: Real>(&self, k: usize, carried: usize, kind: T, here: &mut [Twist<T>]) {
        let joint = &self.joints[k];
        for (&place, (_, ratio)) in self.support(k).also.iter().zip(&joint.also_moved_by) {
            let own = joint.twist(kind, *ratio);
            here[place] = if place < carried { here[place].plus(&own) } else { own };
        }
    }
}
