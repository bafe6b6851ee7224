//! How the coordinates of a tree move in a mechanism that closes.

use std::collections::{BTreeMap, BTreeSet};

use super::{condition::Condition, conditions::conditions_of};
use crate::{
    dynamics::{
        geometry::JointGeometry,
        model::{ClosedTree, DynamicsError, Model},
        state::JointCoordinate,
        workspace::LoopScratch,
    },
    robot::Robot,
};

impl ClosedTree {
    /// The closed tree of a robot, whose loops may prove impossible: see [`Self::problem`].
    pub(crate) fn new(robot: &Robot) -> Self {
        let opened = robot.opened();
        let tree = Model::of_tree(&opened).with_table(robot.parameter_table());
        let own = opened.coordinate_joints();
        let (passive, independent): (Vec<usize>, Vec<usize>) =
            (0..own.len()).partition(|&c| robot.joints[own[c]].passive);
        let conditions = conditions_of(robot);
        let equations = conditions.iter().map(Condition::equations).sum();
        let mut reference = vec![0.0; own.len()];
        for &(joint, position) in robot.loops.iter().flat_map(|of_loop| &of_loop.near) {
            own.iter().zip(&mut reference).filter(|(j, _)| **j == joint).for_each(|(_, q)| *q = position);
        }
        let movers = movers(&tree, &conditions, [&independent, &passive]);
        let slopes_near = Vec::new();
        let mut closed =
            Self { tree, independent, passive, conditions, movers, equations, reference, slopes_near, problem: None };
        let mut scratch = LoopScratch::new(&closed);
        closed.problem = closed.close_first(&mut scratch).err();
        closed.reference.copy_from_slice(&scratch.q);
        closed.slopes_near = scratch.slopes;
        closed
    }

    /// Why the loops cannot be closed as the description states them.
    pub(crate) fn problem(&self) -> Option<&DynamicsError> {
        self.problem.as_ref()
    }

    /// Number of the joint, from one, of a coordinate of the tree.
    pub(super) fn joint_number(&self, coordinate: usize) -> usize {
        self.tree.coordinates[coordinate] + 1
    }

    /// `dq_t / dq_i` of a tree's coordinate and a coordinate of the robot, at the state of the scratch.
    #[inline]
    pub(crate) fn slope(&self, scratch: &LoopScratch, tree: usize, coordinate: usize) -> f64 {
        scratch.slopes[tree * self.independent.len() + coordinate]
    }

    /// The coordinates of the robot that can move a coordinate of the tree: its own, or those of its loops.
    pub(crate) fn moved_by(&self, tree: usize) -> &[usize] {
        &self.movers[tree]
    }

    /// The tree's coordinates where the description closes the loops.
    pub(crate) fn reference(&self) -> &[f64] {
        &self.reference
    }

    /// The same of one coordinate of the robot.
    pub(crate) fn reference_of(&self, coordinate: usize) -> f64 {
        self.reference[self.independent[coordinate]]
    }

    /// The robot's coordinates that move a joint, and their ratios where the description closes the loops, from the tree's.
    pub(crate) fn shares_near_reference(&self, of_tree: impl Iterator<Item = (usize, f64)>) -> Vec<(usize, f64)> {
        let mut shares: BTreeMap<usize, f64> = BTreeMap::new();
        for (tree, ratio) in of_tree {
            for &coordinate in self.moved_by(tree) {
                let slope = self.slopes_near[tree * self.independent.len() + coordinate];
                *shares.entry(coordinate).or_insert(0.0) += ratio * slope;
            }
        }
        shares.into_iter().collect()
    }
}

impl JointGeometry {
    /// That it moves as near the position at which the description closes the loops; `of_tree` is the same joint of the tree.
    pub(in crate::dynamics) fn follow_loops(&mut self, of_tree: &Self, closed: &ClosedTree) {
        let mut shares = closed.shares_near_reference(of_tree.shares());
        let position = of_tree.position(closed.reference());
        let first = if shares.is_empty() { (0, 0.0) } else { shares.remove(0) };
        let others: f64 = shares.iter().map(|(c, ratio)| ratio * closed.reference_of(*c)).sum();
        let offset = position - first.1 * closed.reference_of(first.0) - others;
        self.moved_by = JointCoordinate { coordinate: first.0, ratio: first.1, offset, ..self.moved_by };
        self.also_moved_by = shares;
    }
}

/// The independent coordinates, by their place among them, that can move each coordinate of a tree: loops that share a passive
/// coordinate move together.
fn movers(tree: &Model, conditions: &[Condition], [independent, passive]: [&[usize]; 2]) -> Vec<Vec<usize>> {
    let mut groups: Vec<BTreeSet<usize>> = Vec::new();
    for condition in conditions {
        let mut group = condition.coordinates(tree);
        let shares = |other: &BTreeSet<usize>| passive.iter().any(|c| other.contains(c) && group.contains(c));
        let (joined, apart): (Vec<_>, Vec<_>) = groups.into_iter().partition(shares);
        group.extend(joined.into_iter().flatten());
        groups = apart;
        groups.push(group);
    }
    let of_group =
        |group: &BTreeSet<usize>| (0..independent.len()).filter(|&i| group.contains(&independent[i])).collect();
    let of_coordinate = |c: usize| match independent.iter().position(|&own| own == c) {
        Some(own) => vec![own],
        None => {
            groups.iter().find(|group| group.contains(&c)).map_or_else(|| (0..independent.len()).collect(), of_group)
        }
    };
    (0..tree.coordinate_count()).map(of_coordinate).collect()
}
