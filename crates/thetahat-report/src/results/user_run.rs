use serde::{Deserialize, Serialize};

use super::parameters::ParameterResult;

/// What an estimator of the user's own found in the nominal case. The verdict, the advice and exports know nothing of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct UserRun {
    /// The name that the user gave it.
    pub name: String,
    /// Whether it was given the instruments of IDIM-IV.
    pub has_instruments: bool,
    /// `100 |y - X theta| / |y|`, unweighted.
    pub relative_error_percent: f64,
    /// The same for each joint; none where its torque is zero.
    pub joint_relative_error_percent: Vec<Option<f64>>,
    /// The same on data that the estimate has not seen, as of [`RunResult`](super::RunResult).
    pub cross_validation_relative_error_percent: Option<f64>,
    /// Its 95 % interval, from how much the parts that were left out differ.
    pub cross_validation_interval_95_percent: Option<[f64; 2]>,
    /// Wall-clock time of the estimate of all rows, s.
    pub seconds: f64,
    /// The estimates. Deviations, and intervals of 1.96 of them, are those of the estimator's own covariance; none where it gave
    /// none.
    pub parameters: Vec<ParameterResult>,
    /// That covariance: the lower triangle row by row, SI; empty where it gave none.
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
