use serde::{Deserialize, Serialize};

use thetahat_estimation::checks::Finding;

/// Whether some robot made of bodies has the estimates: see `docs/theory/physical_consistency.md`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PhysicalResult {
    /// Whether one has.
    pub consistent: bool,
    /// Links and parameters that are outside, as few as possible.
    pub outside: Vec<String>,
    /// What each of them lacks: links the least u in kg m^2 with `P + u 1` positive semidefinite, parameters in their unit.
    #[serde(default)]
    pub lacking: Vec<f64>,
    /// Standard deviations, with correlated errors, by which the estimates are outside along the combination of parameters
    /// that shows it best; none for consistent ones.
    #[serde(default)]
    pub deviations: Option<f64>,
    /// Smallest eigenvalue of the pseudo-inertia matrices of the standard parameters nearest to consistent ones.
    pub smallest_eigenvalue: f64,
    /// What was found in the estimates, the gravest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<Finding>,
    /// The consistent estimate, with `physical = true`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimate: Option<ConsistentEstimate>,
    /// Why there is none with `physical = true`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// The consistent parameters nearest to an estimate in the metric of its method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConsistentEstimate {
    /// All base parameters.
    pub parameters: Vec<ConsistentParameter>,
    /// All standard parameters.
    pub standard: Vec<ConsistentParameter>,
    /// What is fixed or known, in words.
    pub known: Vec<String>,
    /// Distance from the a-priori parameters that is kept small: `log-det` or `euclidean`.
    pub prior: String,
    /// Its weight, in variances of the error.
    pub prior_weight: f64,
    /// Weights tried with the squared error on what was left out, where cross-validation chose.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub weights_tried: Vec<[f64; 2]>,
    /// Smallest eigenvalue of the pseudo-inertia matrices of `standard`.
    pub smallest_eigenvalue: f64,
    /// Links and parameters at the boundary: less than a thousandth of usual values inside.
    pub at_boundary: Vec<String>,
    /// Squared residual of the free estimate, in the weights of the method.
    pub squared_residual_free: f64,
    /// The same of the consistent one.
    pub squared_residual: f64,
    /// Relative error, percent, as for the free estimate.
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
    /// Free estimate of a base parameter, a-priori value of a standard one.
    pub beside: Option<f64>,
    /// 95 % interval of a base parameter: that of the free estimate as far as the set allows it, widened to the consistent
    /// value.
    pub interval_95: Option<[f64; 2]>,
}

/// The F-like test of consistency: the distance to the set over what noise makes of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ConsistencyTest {
    /// `|R (theta_consistent - theta_free)|^2 / (k s^2)`, s^2 with correlated errors.
    pub statistic: f64,
    /// k: parameters that the conditions take from the data, not an integer.
    pub numerator_freedom: f64,
    /// Rows less parameters.
    pub denominator_freedom: f64,
    /// Probability of a statistic at least as large where a consistent robot made the data.
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
