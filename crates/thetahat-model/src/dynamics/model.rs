use super::{
    coupled_motor::{CoupledMotor, coupled_motors},
    geometry::JointGeometry,
    loops::Condition,
    sign::Sign,
    state::{JointCoordinate, State},
    term_columns::{ModelTerm, terms_of},
    terms::JointState,
};
use crate::robot::{JointKind, ParameterTable, Quantity, Robot};
use thetahat_ground::{
    real::Real,
    vector::{Mat3, Vec3},
};

/// Why dynamics cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DynamicsError {
    /// The parameters give a mass matrix that is not positive definite in this state.
    #[error(
        "the mass matrix is not positive definite: joint {joint} has the pivot {pivot:.3e}; \
         give it a larger inertia (ia{joint} or the link's own)"
    )]
    MassMatrixNotPositiveDefinite {
        /// The joint, from one, at which the factorisation stops.
        joint: usize,
        /// The pivot found there.
        pivot: f64,
    },
    /// The conditions of a loop are not met where its description closes it.
    #[error(
        "loop {number} stays open by {gap:.2e} m: correct its points, or give in near_deg and near_m positions at which it is \
         closed"
    )]
    LoopOpen {
        /// The loop, from one.
        number: usize,
        /// The gap, m.
        gap: f64,
    },
    /// The conditions of the loops do not determine a passive joint in this position.
    #[error(
        "the loops do not determine joint {joint}: the position is singular or out of reach; keep away from it, or give in \
         near_deg and near_m positions on the branch that is meant"
    )]
    LoopSingular {
        /// The passive joint, from one.
        joint: usize,
    },
    /// More passive joints than equations.
    #[error(
        "the loops have {equations} equations for {passive} passive joints; name fewer joints in `passive`, and leave out a hinge by which \
         a rod only turns about itself"
    )]
    LoopConditions {
        /// Equations of the conditions.
        equations: usize,
        /// Passive joints.
        passive: usize,
    },
    /// The conditions hold a joint that is driven.
    #[error("the loops hold joint {joint}, which is driven; name in `passive` one more joint that the loops move")]
    LoopHolds {
        /// The joint, from one.
        joint: usize,
    },
    /// There is not one value for each standard parameter.
    #[error("expected {expected} parameter values, one for each standard parameter of the robot, found {found}")]
    ParameterCount {
        /// Standard parameters of the robot.
        expected: usize,
        /// Values found.
        found: usize,
    },
}

/// The constant part of a robot's dynamics: geometry, gravity and coupling.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    pub(super) joints: Vec<JointGeometry>,
    pub(super) gravity: Vec3,
    /// The joint of each coordinate.
    pub(super) coordinates: Vec<usize>,
    link_axes: Vec<Option<Mat3>>,
    support: Vec<Support>,
    /// Whether a joint follows several others.
    pub(super) has_sums: bool,
    motors: Vec<CoupledMotor>,
    table: ParameterTable,
    pub(super) terms: Vec<ModelTerm>,
    channels: Vec<String>,
    /// The tree and its conditions if loops move some joints; the other fields then hold the joints as they move near the position at
    /// which the description closes the loops.
    closed: Option<Box<ClosedTree>>,
}

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
    /// The coordinates of the robot that can move each coordinate of the tree.
    pub(super) movers: Vec<Vec<usize>>,
    /// Number of equations.
    pub(super) equations: usize,
    /// Coordinates of the tree where the loops are closed.
    pub(super) reference: Vec<f64>,
    /// `G` there, row by row of the tree's coordinates.
    pub(super) slopes_near: Vec<f64>,
    /// Why there are none; the first condition of the description that is wrong.
    pub(super) problem: Option<DynamicsError>,
}

/// The coordinates that move a link, those nearer to the base first, and where their twists are in the workspace.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Support {
    pub(crate) coordinates: Vec<usize>,
    /// Index of the first twist.
    pub(crate) start: usize,
    /// Which of the coordinates moves the joint: its own, or that of the joint that it follows.
    pub(crate) own: usize,
    /// The same of the further joints that it follows.
    pub(crate) also: Vec<usize>,
}

impl Model {
    /// The model of a robot.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        if robot.loops.is_empty() { Self::of_tree(robot) } else { Self::of_loops(robot) }
    }

    /// The model of a robot whose joints are a tree.
    pub(super) fn of_tree(robot: &Robot) -> Self {
        let coordinates = robot.coordinate_joints();
        let geometry = |j| JointGeometry::new(robot, j, &coordinates);
        let joints: Vec<JointGeometry> = (0..robot.joints.len()).map(geometry).collect();
        Self {
            support: support(&joints),
            has_sums: joints.iter().any(|joint| !joint.also_moved_by.is_empty()),
            link_axes: robot.joints.iter().map(|j| j.link_axes).collect(),
            motors: coupled_motors(&robot.transmission, &coordinates),
            gravity: robot.gravity,
            table: robot.parameter_table(),
            terms: terms_of(robot, &joints),
            channels: robot.channels(),
            joints,
            coordinates,
            closed: None,
        }
    }

    fn of_loops(robot: &Robot) -> Self {
        let closed = ClosedTree::new(robot);
        let mut model = Self::of_tree(robot);
        for (joint, of_tree) in model.joints.iter_mut().zip(&closed.tree.joints) {
            joint.follow_loops(of_tree, &closed);
        }
        model.support = support(&model.joints);
        model.has_sums = true;
        Self { closed: Some(Box::new(closed)), ..model }
    }

    /// The tree and its conditions, if loops move some of the joints.
    #[inline(always)]
    pub(crate) fn closed(&self) -> Option<&ClosedTree> {
        self.closed.as_deref()
    }

    /// The model with the parameters of another robot of the same joints.
    pub(super) fn with_table(self, table: ParameterTable) -> Self {
        Self { table, ..self }
    }

    /// Number of coordinates: the length of `q` and `tau`.
    #[must_use]
    pub fn coordinate_count(&self) -> usize {
        self.coordinates.len()
    }

    /// Number of moving links, including those of followers.
    #[must_use]
    pub fn link_count(&self) -> usize {
        self.joints.len()
    }

    /// The table of standard parameters.
    #[must_use]
    pub fn parameter_table(&self) -> &ParameterTable {
        &self.table
    }

    /// The coupled motors, in the order of their parameters in the table.
    #[must_use]
    pub fn coupled_motors(&self) -> &[CoupledMotor] {
        &self.motors
    }

    /// The recorded channels that torque terms use. [`super::State::channels`] has one value for each coordinate of each.
    #[must_use]
    pub fn channels(&self) -> &[String] {
        &self.channels
    }

    /// The columns of the robot's terms, in the order of their parameters.
    pub(crate) fn terms(&self) -> &[ModelTerm] {
        &self.terms
    }

    /// Whether a parameter of the table multiplies a recorded channel.
    #[doc(hidden)]
    pub fn takes_channel(&self, parameter: usize) -> bool {
        match self.table.get(parameter).quantity {
            Quantity::Term(term) => self.terms[term.column].takes_channel(),
            Quantity::Link(_) | Quantity::Joint(_) | Quantity::Motor(_) => false,
        }
    }

    /// The coordinates that move joint `j` and their ratios: its own, or those of the joints that it follows.
    pub fn shares_of(&self, j: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.joints[j].shares()
    }

    /// The velocity and the acceleration of joint `j` for its drive.
    #[inline(always)]
    pub(crate) fn drive_state<T: Real>(&self, j: usize, state: State<'_, T>, ddq: &[T], sign: Sign) -> JointState<T> {
        self.joints[j].drive_state(state, ddq, sign)
    }

    /// The coordinate that moves joint `j`: its own, or the coordinate of the joint that it follows, the first of several.
    #[must_use]
    pub fn coordinate_of(&self, j: usize) -> JointCoordinate {
        self.joints[j].moved_by
    }

    /// Whether each coordinate turns or slides a joint.
    #[doc(hidden)]
    #[must_use]
    pub fn coordinate_kinds(&self) -> Vec<JointKind> {
        self.coordinates.iter().map(|&joint| self.joints[joint].moved_by.kind).collect()
    }

    /// The coordinates that move link `k`.
    pub(crate) fn support(&self, k: usize) -> &Support {
        &self.support[k]
    }

    pub(super) fn supports(&self) -> &[Support] {
        &self.support
    }

    /// The rotation from link `k`'s own axes to its joint's frame, where they differ.
    pub(crate) fn link_axes(&self, k: usize) -> Option<&Mat3> {
        self.link_axes[k].as_ref()
    }

    /// Number of twists that the regressor needs: for each link, one per coordinate that moves it.
    pub(super) fn twist_count(&self) -> usize {
        self.support.last().map_or(0, |last| last.start + last.coordinates.len())
    }
}

/// The place of a coordinate in a list, to which it is appended if it is not there.
fn place_of(coordinate: usize, coordinates: &mut Vec<usize>) -> usize {
    let known = coordinates.iter().position(|&c| c == coordinate);
    known.unwrap_or_else(|| {
        coordinates.push(coordinate);
        coordinates.len() - 1
    })
}

fn support(joints: &[JointGeometry]) -> Vec<Support> {
    let mut all: Vec<Support> = Vec::with_capacity(joints.len());
    let mut start = 0;
    for joint in joints {
        let mut coordinates = all.get(joint.parent).map_or_else(Vec::new, |p| p.coordinates.clone());
        let mut places = joint.shares().map(|(coordinate, _)| place_of(coordinate, &mut coordinates));
        let own = places.next().unwrap_or(0);
        let also = places.collect();
        let count = coordinates.len();
        all.push(Support { coordinates, start, own, also });
        start += count;
    }
    all
}
