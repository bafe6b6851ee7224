use serde::{Deserialize, Serialize};

use crate::{
    identification::fit::{Divisor, EstimationError, Fit},
    regression::Regression,
};
use thetahat_ground::linear_algebra::Matrix;

/// What an estimator needs beside the regression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// Nothing.
    Measurement,
    /// Z of the closed loop simulated with its own estimate: it iterates.
    Instruments,
    /// What the closed loop simulated with its own estimate answers, and the derivatives J of that: it iterates.
    Sensitivities,
}

/// Which signal of the closed loop is compared with the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Response {
    /// Joint torques.
    Torque,
    /// Joint positions.
    Position,
}

/// What the parameters multiply in the prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Design {
    /// X, of the measured motion.
    Measured,
    /// Z of the simulated motion, or J.
    Simulated,
}

/// Weighting of the rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weighting {
    /// Equal weights.
    #[default]
    None,
    /// One over the standard deviation of each joint's residual of LS with these weights.
    PerJoint,
}

impl Weighting {
    /// Its name in files, lower case with hyphens.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::PerJoint => "per-joint",
        }
    }
}

/// What there is to know of an estimator.
pub(super) struct Estimator {
    /// Name, lower case with hyphens.
    pub(super) name: &'static str,
    /// Number of its equation in the paper.
    pub(super) equation: &'static str,
    pub(super) needs: Needs,
    pub(super) design: Design,
    pub(super) response: Response,
    /// The weighting that makes it what it is, where it has one.
    pub(super) weighting: Option<Weighting>,
    pub(super) estimate: fn(&Regression, Option<&Matrix>, Divisor) -> Result<Fit, EstimationError>,
    pub(super) influence: fn(&Regression, Option<&Matrix>) -> Result<Matrix, EstimationError>,
}
