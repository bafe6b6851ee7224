use std::collections::BTreeMap;

use super::{
    conditions::{Condition, conditions_of},
    scratch::LoopScratch,
};
use crate::{
    dynamics::model::{DynamicsError, Model},
    robot::Robot,
};

/// A tree with conditions that close its loops.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ClosedTree {
    /// The tree in which all joints move.
    pub(crate) tree: Model,
    /// The coordinates of the tree that are coordinates of the robot.
    pub(super) independent: Vec<usize>,
    /// The other coordinates of the tree.
    pub(super) passive: Vec<usize>,
    pub(super) conditions: Vec<Condition>,
    /// Number of equations.
    pub(super) equations: usize,
    /// Coordinates of the tree where the loops are closed.
    pub(super) reference: Vec<f64>,
    /// `G` there, row by row of the tree's coordinates.
    pub(super) slopes_near: Vec<f64>,
    /// Why there are none; the first condition of the description that is wrong.
    problem: Option<DynamicsError>,
}

impl ClosedTree {
    /// The closed tree of a robot, whose loops may prove impossible: see [`Self::problem`].
    pub(crate) fn new(robot: &Robot) -> Self {
        let opened = robot.opened();
        let tree = Model::of_tree(&opened).with_table(robot.parameter_table());
        let own = opened.coordinate_joints();
        let (passive, independent) = (0..own.len()).partition(|&c: &usize| robot.joints[own[c]].passive);
        let conditions = conditions_of(robot);
        let equations = conditions.iter().map(Condition::equations).sum();
        let mut reference = vec![0.0; own.len()];
        for &(joint, position) in robot.loops.iter().flat_map(|of_loop| &of_loop.near) {
            own.iter().zip(&mut reference).filter(|(j, _)| **j == joint).for_each(|(_, q)| *q = position);
        }
        let slopes_near = Vec::new();
        let mut closed =
            Self { tree, independent, passive, conditions, equations, reference, slopes_near, problem: None };
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

    /// The coordinates of the robot that can move a coordinate of the tree: its own, or all.
    pub(crate) fn moved_by(&self, tree: usize) -> Vec<usize> {
        match self.independent.iter().position(|&c| c == tree) {
            Some(own) => vec![own],
            None => (0..self.independent.len()).collect(),
        }
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
            for coordinate in self.moved_by(tree) {
                let slope = self.slopes_near[tree * self.independent.len() + coordinate];
                *shares.entry(coordinate).or_insert(0.0) += ratio * slope;
            }
        }
        shares.into_iter().collect()
    }
}
