use super::geometry::JointGeometry;
use crate::{
    real::Real,
    robot::{ParameterTable, Robot, Transmission},
    vector::{Mat3, Vec3},
};

/// Why accelerations cannot be computed.
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
    motors: Vec<CoupledMotor>,
    table: ParameterTable,
}

/// The coordinates that move a link, those nearer to the base before, and where their twists stand in the workspace.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Support {
    pub(crate) coordinates: Vec<usize>,
    /// Place of the first twist.
    pub(crate) start: usize,
    /// Which of the coordinates is the joint's own, or that of the joint that it follows.
    pub(crate) own: usize,
}

/// A motor that turns with more than one coordinate, as row i of `n` (design: motor velocity `n dq`).
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledMotor {
    /// Its number from zero, which is the number of its own joint.
    pub motor: usize,
    /// The coordinates that move it, with their weights in `n`.
    pub weights: Vec<(usize, f64)>,
}

impl Model {
    /// The model of a robot.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let coordinates = robot.coordinate_joints();
        let geometry = |j| JointGeometry::new(robot, j, &coordinates);
        let joints: Vec<JointGeometry> = (0..robot.joints.len()).map(geometry).collect();
        Self {
            support: support(&joints),
            link_axes: robot.joints.iter().map(|j| j.link_axes).collect(),
            motors: coupled_motors(&robot.transmission, &coordinates),
            gravity: robot.gravity,
            table: robot.parameter_table(),
            joints,
            coordinates,
        }
    }

    /// Number of coordinates: the length of `q` and `tau`.
    #[must_use]
    pub fn coordinate_count(&self) -> usize {
        self.coordinates.len()
    }

    /// Number of moving links: of the joints that follow others as well.
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

    /// The coordinate of joint `j`, or of the joint that it follows, and the joint's velocity per velocity of it.
    #[must_use]
    pub fn coordinate_of(&self, j: usize) -> (usize, f64) {
        (self.joints[j].coordinate, self.joints[j].ratio)
    }

    /// The coordinates that move link `k`.
    pub(crate) fn support(&self, k: usize) -> &Support {
        &self.support[k]
    }

    pub(super) fn supports(&self) -> &[Support] {
        &self.support
    }

    /// From link `k`'s own axes to those of its joint's frame, where they differ.
    pub(crate) fn link_axes(&self, k: usize) -> Option<&Mat3> {
        self.link_axes[k].as_ref()
    }

    /// Number of twists that the regressor needs: of all links, those of the coordinates that move it.
    pub(super) fn twist_count(&self) -> usize {
        self.support.last().map_or(0, |last| last.start + last.coordinates.len())
    }
}

fn support(joints: &[JointGeometry]) -> Vec<Support> {
    let mut all: Vec<Support> = Vec::with_capacity(joints.len());
    let mut start = 0;
    for joint in joints {
        let mut coordinates = all.get(joint.parent).map_or_else(Vec::new, |p| p.coordinates.clone());
        let known = coordinates.iter().position(|&c| c == joint.coordinate);
        let own = known.unwrap_or(coordinates.len());
        if known.is_none() {
            coordinates.push(joint.coordinate);
        }
        let count = coordinates.len();
        all.push(Support { coordinates, start, own });
        start += count;
    }
    all
}

fn coupled_motors(transmission: &Transmission, coordinates: &[usize]) -> Vec<CoupledMotor> {
    let n = transmission.motor_in_joint_units();
    let weights = |i: usize| (0..n.columns()).map(|j| (j, n.at(i, j))).filter(|(_, w)| *w != 0.0).collect();
    let motor = |i: usize| CoupledMotor { motor: coordinates[i], weights: weights(i) };
    transmission.coupled_motors().into_iter().map(motor).collect()
}

impl CoupledMotor {
    /// The motor's velocity in joint units, `n_i dq`.
    #[must_use]
    pub fn velocity(&self, dq: &[f64]) -> f64 {
        self.weights.iter().map(|&(j, w)| w * dq[j]).sum()
    }

    /// The same, or the acceleration, in each lane.
    #[inline(always)]
    pub(crate) fn rate<T: Real>(&self, rates: &[T]) -> T {
        let mut sum = rates[0].like(0.0);
        for &(j, w) in &self.weights {
            sum += rates[j] * w;
        }
        sum
    }

    /// The cross terms of `n_i^T n_i`: every ordered pair of different coordinates with its weight.
    pub fn cross_terms(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.weights.iter().flat_map(move |&(j, wj)| {
            self.weights.iter().filter(move |&&(k, _)| k != j).map(move |&(k, wk)| (j, k, wj * wk))
        })
    }
}
