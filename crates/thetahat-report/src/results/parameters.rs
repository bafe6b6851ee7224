use serde::{Deserialize, Serialize};

use thetahat_estimation::statistics::FTest;

/// One estimate.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ParameterResult {
    /// Name.
    pub name: String,
    /// Estimate.
    pub estimate: f64,
    /// Classical standard deviation.
    pub standard_deviation: Option<f64>,
    /// The same in percent of the estimate.
    pub relative_standard_deviation_percent: Option<f64>,
    /// True value, for a simulated robot.
    pub true_value: Option<f64>,
    /// Unit.
    pub unit: String,
    /// Regrouping formula.
    pub expression: String,
    /// Whether the tables show it.
    pub shown: bool,
    /// Standard deviation with errors that are correlated in time and differ between joints.
    #[serde(default)]
    pub standard_deviation_robust: Option<f64>,
    /// Low and high end of the 95 % interval with these errors.
    #[serde(default)]
    pub interval_95: Option<[f64; 2]>,
}

/// A base parameter that the motion does not separate from others.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NotSeparated {
    /// Its name.
    pub parameter: String,
    /// Parameters whose estimates include a part of it, the largest part first, and have no intervals for that; empty if it has no effect.
    pub with: Vec<String>,
}

/// The result of an elimination.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EliminationResult {
    /// Parameters kept.
    pub kept: Vec<String>,
    /// Parameters eliminated, in order.
    pub eliminated: Vec<String>,
    /// The test of the parameters kept against all.
    pub f_test: Option<FTest>,
}
