use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{
    curves::RunPlots,
    diagnosis::{HiddenBias, Influence, ResidualResult},
    parameters::ParameterResult,
    physical::PhysicalResult,
};
use thetahat_estimation::{
    checks::Finding,
    identification::{Method, Response, Status, Weighting},
    statistics::FTest,
};

/// One case and method.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RunResult {
    /// The case.
    pub case: String,
    /// The method.
    pub method: Method,
    /// Weighting of the rows, as the experiment file names it: `none` or `per-joint`. `null` in a file
    /// of schema 0.
    #[serde(default)]
    pub weighting: Option<Weighting>,
    /// How it ended.
    pub status: Status,
    /// Why it did not converge; `null` if it did.
    pub reason: Option<String>,
    /// Simulations that differ from the experiment file: a guessed controller, other parameters than the estimate.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Whether the estimates are physically consistent; `null` without an estimate.
    #[serde(default)]
    pub physical: Option<PhysicalResult>,
    /// The findings of the checks in its predictions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<Finding>,
    /// Iterations.
    pub iterations: usize,
    /// Closed-loop simulations of the iteration.
    pub simulations: usize,
    /// `100 |y - y_hat| / |y|`, unweighted; `null` without an estimate.
    pub relative_error_percent: Option<f64>,
    /// The same for each joint; `null` if its torque is zero.
    pub joint_relative_error_percent: Vec<Option<f64>>,
    /// The same on data not used for the estimate: the recordings held back, or each move left out in turn.
    pub cross_validation_relative_error_percent: Option<f64>,
    /// Its 95 % interval, from the scatter between the parts left out.
    #[serde(default)]
    pub cross_validation_interval_95_percent: Option<[f64; 2]>,
    /// The part of the recording whose removal changes the estimates most.
    #[serde(default)]
    pub influence: Option<Influence>,
    /// Possible bias of the estimates by errors that the intervals do not include; nominal runs only.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hidden_bias: Vec<HiddenBias>,
    /// The tests of the residual.
    #[serde(default)]
    pub residual: Option<ResidualResult>,
    /// Condition number of the observation matrix of the second recording.
    pub validation_condition_number: Option<f64>,
    /// Condition number of the matrix that is solved.
    pub condition_number: Option<f64>,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Relative errors of the closed-loop simulation with these estimates: position, velocity, acceleration, torque.
    pub simulation_relative_error_percent: Option<BTreeMap<String, f64>>,
    /// The same on the second recording.
    pub validation_simulation_relative_error_percent: Option<BTreeMap<String, f64>>,
    /// F-test of these parameters against all base parameters, where fewer are estimated, on X.
    pub f_test: Option<FTest>,
    /// Convergence.
    pub convergence: Vec<IterationResult>,
    /// The estimates.
    pub parameters: Vec<ParameterResult>,
    /// Covariance of the estimates in the order of `parameters`, of nominal runs: the lower triangle row by row, SI. The
    /// deviations are those with correlated errors, as in `interval_95`; the correlations are classical. Empty if it
    /// was read from a file from before this key.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub covariance: Vec<f64>,
    /// Quantities of the simulated loop that were estimated with the parameters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub loop_parameters: Vec<LoopParameterResult>,
    /// Curves for the report.
    #[serde(skip)]
    pub plots: RunPlots,
}

/// A quantity of the simulated loop that was estimated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoopParameterResult {
    /// Its name; motors count from one.
    pub name: String,
    /// The factor on the value in the experiment file, the added delay in s, or the velocity at which friction changes its sign.
    pub estimate: f64,
    /// Its classical standard deviation.
    pub standard_deviation: f64,
    /// Its 95 % interval with correlated errors.
    pub interval_95: Option<[f64; 2]>,
    /// `s` for a delay, `rad/s or m/s` for a velocity, empty for a factor.
    pub unit: String,
}

/// One iteration.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct IterationResult {
    /// Relative error, percent.
    pub relative_error_percent: f64,
    /// Largest change of an estimate, in its standard deviations.
    pub parameter_change: Option<f64>,
    /// Relative change of the error.
    pub error_change: Option<f64>,
    /// The estimates.
    pub estimates: Vec<f64>,
}

impl RunResult {
    /// A run with a status and no numbers.
    #[doc(hidden)]
    pub fn new(case: &str, method: Method, status: Status) -> Self {
        Self {
            case: case.to_owned(),
            method,
            weighting: None,
            status,
            reason: None,
            notes: Vec::new(),
            physical: None,
            findings: Vec::new(),
            iterations: 0,
            simulations: 0,
            relative_error_percent: None,
            joint_relative_error_percent: Vec::new(),
            cross_validation_relative_error_percent: None,
            cross_validation_interval_95_percent: None,
            influence: None,
            hidden_bias: Vec::new(),
            residual: None,
            validation_condition_number: None,
            condition_number: None,
            seconds: 0.0,
            simulation_relative_error_percent: None,
            validation_simulation_relative_error_percent: None,
            f_test: None,
            convergence: Vec::new(),
            parameters: Vec::new(),
            covariance: Vec::new(),
            loop_parameters: Vec::new(),
            plots: RunPlots::default(),
        }
    }

    /// Median over the parameters of the standard deviation with correlated errors over the classical one: by how much the
    /// classical ones are too small.
    #[must_use]
    pub fn widening(&self) -> Option<f64> {
        let ratio = |p: &ParameterResult| Some(p.standard_deviation_robust? / p.standard_deviation?);
        let mut ratios: Vec<f64> = self.parameters.iter().filter_map(ratio).filter(|r| r.is_finite()).collect();
        ratios.sort_by(f64::total_cmp);
        ratios.get(ratios.len() / 2).copied()
    }

    /// Whether its errors are errors of positions, not of torques.
    #[must_use]
    pub fn is_of_positions(&self) -> bool {
        self.method.response() == Response::Position
    }

    /// The estimate of a parameter.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&ParameterResult> {
        self.parameters.iter().find(|p| p.name == name)
    }
}
