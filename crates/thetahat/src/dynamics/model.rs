use super::vector::{Rotation, Vec3};
use crate::robot::{JointKind, ParameterTable, Robot, Transmission};

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
#[derive(Debug, Clone)]
pub struct Model {
    pub(super) joints: Vec<JointGeometry>,
    pub(super) gravity: Vec3,
    motors: Vec<CoupledMotor>,
    table: ParameterTable,
}

/// A motor that turns with more than one joint, as row i of `n` (design: motor velocity `n dq`).
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledMotor {
    /// Its number from zero, which is the number of its own joint.
    pub motor: usize,
    /// The joints that move it, with their weights in `n`.
    pub weights: Vec<(usize, f64)>,
}

/// Modified Denavit-Hartenberg placement with its sines taken.
#[derive(Debug, Clone)]
pub(super) struct JointGeometry {
    kind: JointKind,
    a: f64,
    sin_alpha: f64,
    cos_alpha: f64,
    d: f64,
    theta: f64,
}

impl Model {
    /// The model of a robot.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let joints = robot.joints.iter().map(|j| JointGeometry {
            kind: j.kind,
            a: j.a,
            sin_alpha: j.alpha.sin(),
            cos_alpha: j.alpha.cos(),
            d: j.d,
            theta: j.theta,
        });
        Self {
            joints: joints.collect(),
            gravity: robot.gravity,
            motors: coupled_motors(&robot.transmission),
            table: robot.parameter_table(),
        }
    }

    /// Number of joints.
    #[must_use]
    pub fn joint_count(&self) -> usize {
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

    /// Whether joint `j` is revolute.
    #[must_use]
    pub fn is_revolute(&self, j: usize) -> bool {
        self.joints[j].kind == JointKind::Revolute
    }
}

fn coupled_motors(transmission: &Transmission) -> Vec<CoupledMotor> {
    let n = transmission.motor_in_joint_units();
    let weights = |i: usize| (0..n.columns()).map(|j| (j, n.at(i, j))).filter(|(_, w)| *w != 0.0).collect();
    transmission.coupled_motors().into_iter().map(|motor| CoupledMotor { motor, weights: weights(motor) }).collect()
}

impl CoupledMotor {
    /// The motor's velocity in joint units, `n_i dq`.
    #[inline]
    #[must_use]
    pub fn velocity(&self, dq: &[f64]) -> f64 {
        self.weights.iter().map(|&(j, w)| w * dq[j]).sum()
    }

    /// The cross terms of `n_i^T n_i`: every ordered pair of different joints with its weight.
    pub fn cross_terms(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.weights.iter().flat_map(move |&(j, wj)| {
            self.weights.iter().filter(move |&&(k, _)| k != j).map(move |&(k, wk)| (j, k, wj * wk))
        })
    }
}

impl JointGeometry {
    #[inline]
    pub(super) fn is_revolute(&self) -> bool {
        self.kind == JointKind::Revolute
    }

    /// Rotation from frame j to frame j-1, and origin of frame j in frame j-1, at coordinate `q`.
    #[inline]
    pub(super) fn placement(&self, q: f64) -> (Rotation, Vec3) {
        let (theta, d) = if self.is_revolute() { (self.theta + q, self.d) } else { (self.theta, self.d + q) };
        let (sin_theta, cos_theta) = theta.sin_cos();
        let (sa, ca) = (self.sin_alpha, self.cos_alpha);
        let r = Rotation { sin_alpha: sa, cos_alpha: ca, sin_theta, cos_theta };
        (r, [self.a, -d * sa, d * ca])
    }
}
