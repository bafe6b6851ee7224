use serde::{Deserialize, Serialize};

use crate::{
    identification::fit::{Divisor, EstimationError, Fit},
    regression::Regression,
};
use thetahat_ground::linear_algebra::Matrix;

/// What an estimator needs in addition to the regression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// Nothing.
    Measurement,
    /// Z of the closed loop simulated with its own estimate: the estimator iterates.
    Instruments,
    /// The response of the closed loop simulated with its own estimate, and the derivatives J of that response: the estimator iterates.
    Sensitivities,
}

/// Which signal of the closed loop is compared with the recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Response {
    /// Joint torques.
    Torque,
    /// Joint positions.
    Position,
}

/// The matrix that the parameters multiply in the prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DesignMatrix {
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

/// The entry of an estimator in the table.
pub(super) struct Estimator {
    /// Name, lower case with hyphens.
    pub(super) name: &'static str,
    /// Number of its equation in the paper.
    pub(super) equation: &'static str,
    pub(super) needs: Needs,
    pub(super) design: DesignMatrix,
    pub(super) response: Response,
    /// The weighting that defines the estimator, if it has one.
    pub(super) weighting: Option<Weighting>,
    pub(super) estimate: fn(&Regression, Option<&Matrix>, Divisor) -> Result<Fit, EstimationError>,
    pub(super) influence: fn(&Regression, Option<&Matrix>) -> Result<Matrix, EstimationError>,
}
