use serde::{Deserialize, Serialize};

use thetahat_estimation::checks::Finding;

/// Physical consistency: whether the estimates can be those of a robot of rigid bodies. See `docs/theory/physical_consistency.md`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PhysicalResult {
    /// Whether the estimates are physically consistent.
    pub consistent: bool,
    /// Links and parameters that violate the conditions, as few as possible.
    #[serde(alias = "outside")]
    pub inconsistent: Vec<String>,
    /// The violation of each: for a link the smallest u in kg m^2 with `P + u 1` positive semidefinite, for a parameter in its unit.
    #[serde(default, alias = "lacking")]
    pub violations: Vec<f64>,
    /// Distance of the estimates from the consistent set in standard deviations, with correlated errors, along the combination of parameters
    /// that shows it best; `null` for consistent estimates.
    #[serde(default)]
    pub deviations: Option<f64>,
    /// Smallest eigenvalue of the pseudo-inertia matrices of all links, at the standard parameters with the smallest violation.
    pub smallest_eigenvalue: f64,
    /// The findings in the estimates, the most serious first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<Finding>,
    /// The consistent estimate, with `physical = true`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimate: Option<ConsistentEstimate>,
    /// Why there is no consistent estimate with `physical = true`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// The consistent parameters closest to an estimate in the metric of its method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConsistentEstimate {
    /// All base parameters.
    pub parameters: Vec<ConsistentParameter>,
    /// All standard parameters.
    pub standard: Vec<ConsistentParameter>,
    /// Fixed or known quantities, in words.
    pub known: Vec<String>,
    /// Distance to the a-priori parameters that is penalized: `log-det` or `euclidean`.
    pub prior: String,
    /// Its weight, in variances of the error.
    pub prior_weight: f64,
    /// Weights tried, each with the squared error on the data left out, if cross-validation chose the weight.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub weights_tried: Vec<[f64; 2]>,
    /// Smallest eigenvalue of the pseudo-inertia matrices of `standard`.
    pub smallest_eigenvalue: f64,
    /// Links and parameters at the boundary: their margin is below a thousandth of usual values.
    pub at_boundary: Vec<String>,
    /// Squared residual of the unconstrained estimate, in the weights of the method.
    pub squared_residual_free: f64,
    /// The same for the consistent estimate.
    pub squared_residual: f64,
    /// Relative error, percent, as for the unconstrained estimate.
    pub relative_error_percent: f64,
    /// Whether the data reject consistency.
    pub test: Option<ConsistencyTest>,
    /// Whether the solver reached its accuracy.
    pub converged: bool,
    /// Its iterations.
    pub iterations: usize,
    /// Time of the solver, s.
    pub seconds: f64,
}

/// One parameter of a consistent estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConsistentParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Consistent value.
    pub estimate: f64,
    /// Value for comparison: the unconstrained estimate of a base parameter, the a-priori value of a standard parameter.
    #[serde(alias = "beside")]
    pub reference_value: Option<f64>,
    /// 95 % interval of a base parameter: that of the unconstrained estimate where the set allows it, widened to the consistent
    /// value.
    pub interval_95: Option<[f64; 2]>,
}

/// The F-like test of consistency: the squared distance to the set over its expectation from noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ConsistencyTest {
    /// `|R (theta_consistent - theta_free)|^2 / (k s^2)`, s^2 with correlated errors.
    pub statistic: f64,
    /// k: effective number of parameters that the conditions fix, not an integer.
    pub numerator_freedom: f64,
    /// Rows minus parameters.
    pub denominator_freedom: f64,
    /// Probability of a statistic at least as large if the robot is consistent.
    pub p_value: f64,
}

impl PhysicalResult {
    /// Whether the data reject consistency at 5 %; none without a consistent estimate.
    #[must_use]
    pub fn rejects(&self) -> Option<bool> {
        self.estimate.as_ref()?.test.map(|t| t.p_value < REJECTED)
    }
}

/// Probability below which consistency is rejected.
const REJECTED: f64 = 0.05;
