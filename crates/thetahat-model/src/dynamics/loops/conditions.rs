//! The conditions `c(q) = 0` that close loops, their Jacobian, and their acceleration.

use std::collections::BTreeSet;

use super::condition::{Anchor, Condition};
use crate::{
    dynamics::{
        frames::JointFrame,
        geometry::BASE,
        model::{ClosedTree, Model},
        workspace::LoopScratch,
    },
    robot::{Loop, LoopKind, Robot},
};
use thetahat_ground::vector::{Vec3, add, dot, norm, scale, sub, times};

/// The conditions of a robot's loops.
pub(super) fn conditions_of(robot: &Robot) -> Vec<Condition> {
    let of_loop = |(number, of_loop): (usize, &Loop)| {
        let distance = match of_loop.kind {
            LoopKind::Distance { length } => Some(length),
            LoopKind::Point | LoopKind::Axis | LoopKind::Pose => None,
        };
        let anchor = |joint: Option<usize>, point: Vec3| {
            let axes = joint.and_then(|j| robot.joints[j].link_axes.as_ref());
            Anchor { joint: joint.unwrap_or(BASE), point: axes.map_or(point, |axes| times(axes, point)) }
        };
        let joints = [of_loop.from.joint, of_loop.to.joint];
        let ends = |[from, to]: [Vec3; 2]| [anchor(joints[0], from), anchor(joints[1], to)];
        let condition = move |points| Condition { of_loop: number, ends: ends(points), distance };
        of_loop.points().into_iter().map(condition).collect::<Vec<_>>()
    };
    robot.loops.iter().enumerate().flat_map(of_loop).collect()
}

/// The origin of the anchor's frame and the point, in the frame of the base.
fn place(anchor: &Anchor, frames: &[JointFrame]) -> [Vec3; 2] {
    match frames.get(anchor.joint) {
        None => [[0.0; 3], anchor.point],
        Some(frame) => [frame.origin, add(frame.origin, times(&frame.rotation, anchor.point))],
    }
}

impl ClosedTree {
    /// `c(q)`, its gaps in m, and its Jacobian, row by row, at the tree's coordinates in the scratch.
    pub(super) fn linearise(&self, scratch: &mut LoopScratch) {
        let n = self.tree.coordinate_count();
        let LoopScratch { q, frames, gaps, jacobian, .. } = scratch;
        self.tree.frames_into(q, frames);
        jacobian.fill(0.0);
        let mut row = 0;
        for condition in &self.conditions {
            let [from, to] = condition.ends.each_ref().map(|end| place(end, frames)[1]);
            let between = sub(to, from);
            let (directions, gap) = condition.equations_at(between);
            for (direction, gap) in directions.iter().zip(gap).take(condition.equations()) {
                let entries = &mut jacobian[row * n..(row + 1) * n];
                self.tree.add_point_slopes(frames, condition.ends[1].joint, to, *direction, entries);
                self.tree.add_point_slopes(frames, condition.ends[0].joint, from, scale(-1.0, *direction), entries);
                gaps[row] = gap;
                row += 1;
            }
        }
    }

    /// `dJ dq`: the acceleration of the conditions where the tree's coordinates have no acceleration.
    pub(super) fn drift(&self, scratch: &mut LoopScratch) {
        let LoopScratch { frames, spins, dq, drift, .. } = scratch;
        self.tree.spins_into(frames, dq, spins);
        let mut row = 0;
        for condition in &self.conditions {
            let [from, to] = condition.ends.each_ref().map(|end| {
                let [origin, point] = place(end, frames);
                let [v, a] = spins.get(end.joint).map_or([[0.0; 3]; 2], |spin| spin.of_point(sub(point, origin)));
                [point, v, a]
            });
            let [between, velocity, acceleration] = [0, 1, 2].map(|order: usize| sub(to[order], from[order]));
            match condition.distance {
                None => drift[row..row + 3].copy_from_slice(&acceleration),
                Some(length) => {
                    drift[row] = (dot(between, acceleration) + dot(velocity, velocity)) / length;
                }
            }
            row += condition.equations();
        }
    }

    /// The loop, from zero, with the largest gap, and the gap in m.
    pub(super) fn largest_gap(&self, scratch: &LoopScratch) -> (usize, f64) {
        let rows = self.conditions.iter().flat_map(|c| std::iter::repeat_n(c.of_loop, c.equations()));
        let gaps = rows.zip(scratch.gaps.iter().map(|gap| gap.abs()));
        gaps.fold((0, 0.0), |largest, gap| if gap.1 > largest.1 { gap } else { largest })
    }
}

impl Condition {
    /// The coordinates of a tree that move one of its points and not the other.
    pub(super) fn coordinates(&self, tree: &Model) -> BTreeSet<usize> {
        let before = |end: &Anchor| {
            let own = Some(end.joint).filter(|joint| *joint != BASE);
            std::iter::successors(own, |&j| tree.carrier(j)).collect::<Vec<_>>()
        };
        let [from, to] = self.ends.each_ref().map(before);
        let moves_one = |j: &&usize| from.contains(*j) != to.contains(*j);
        from.iter().chain(&to).filter(moves_one).flat_map(|&j| tree.shares_of(j).map(|(c, _)| c)).collect()
    }

    /// The directions along which it restrains the difference of its points, and the gap along each, m.
    fn equations_at(&self, between: Vec3) -> ([Vec3; 3], Vec3) {
        match self.distance {
            None => ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], between),
            Some(length) => {
                let gap = 0.5 * (norm(between).powi(2) / length - length);
                ([scale(1.0 / length, between); 3], [gap; 3])
            }
        }
    }
}
