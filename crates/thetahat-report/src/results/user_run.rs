use serde::{Deserialize, Serialize};

use super::parameters::ParameterResult;

/// The estimates of a user's own estimator in the nominal case. The verdict, the advice and exports do not use them.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct UserRun {
    /// The name that the user gave it.
    pub name: String,
    /// Whether it was given the instruments of IDIM-IV.
    pub has_instruments: bool,
    /// `100 |y - X theta| / |y|`, unweighted.
    pub relative_error_percent: f64,
    /// The same for each joint; `null` if its torque is zero.
    pub joint_relative_error_percent: Vec<Option<f64>>,
    /// The same on data not used for the estimate, as in [`RunResult`](super::RunResult).
    pub cross_validation_relative_error_percent: Option<f64>,
    /// Its 95 % interval, from the scatter between the parts left out.
    pub cross_validation_interval_95_percent: Option<[f64; 2]>,
    /// Wall-clock time of the estimate of all rows, s.
    pub seconds: f64,
    /// The estimates. Deviations, and intervals of 1.96 of them, come from the estimator's own covariance; `null` if it gave
    /// no covariance.
    pub parameters: Vec<ParameterResult>,
    /// That covariance: the lower triangle row by row, SI; may be empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub covariance: Vec<f64>,
    /// `X theta`, one vector per joint.
    #[serde(skip)]
    pub predicted: Vec<Vec<f64>>,
}

impl UserRun {
    /// The estimate of a parameter.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&ParameterResult> {
        self.parameters.iter().find(|p| p.name == name)
    }
}
