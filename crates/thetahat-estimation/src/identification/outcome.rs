//! How an estimation ended, and its iterations.

use serde::{Deserialize, Serialize};

use super::fit::{EstimationError, Fit};
use crate::simulation::SimulationError;
use thetahat_ground::linear_algebra::Matrix;

/// How an estimation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Both changes fell below their limits, or no iteration was needed.
    Converged,
    /// An iteration ended before its changes were small; its last estimate is kept.
    Stalled,
    /// The iterations, one step at a time, have not converged yet.
    IterationLimit,
    /// The simulation of the start values failed.
    Diverged,
    /// The motion does not separate the parameters.
    NotIdentifiable,
}

impl Status {
    /// Its name in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Stalled => "stalled",
            Self::IterationLimit => "iteration limit",
            Self::Diverged => "diverged",
            Self::NotIdentifiable => "not identifiable",
        }
    }
}

/// Why an estimation has not converged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// The motion does not give an estimate.
    #[error(transparent)]
    Estimation(EstimationError),
    /// A simulation failed, even after the step towards its parameters was halved.
    #[error(transparent)]
    Simulation(SimulationError),
    /// A simulation failed, even after the step towards its parameters was halved; an earlier estimate exists.
    #[error("{cause}; kept is {}", reached(*.relative_error_percent, *.parameter_change))]
    Stalled {
        /// Why the simulation failed.
        cause: SimulationError,
        /// Relative error of the kept estimate, percent.
        relative_error_percent: f64,
        /// Largest change that led to it, in standard deviations; none after one iteration.
        parameter_change: Option<f64>,
    },
    /// The changes did not become small in the allowed iterations.
    #[error("no convergence within {iterations} iterations; kept is {}", reached(*.relative_error_percent, *.parameter_change))]
    IterationLimit {
        /// Iterations allowed.
        iterations: usize,
        /// Relative error of the kept estimate, percent.
        relative_error_percent: f64,
        /// Largest change that led to it, in standard deviations; none after one iteration.
        parameter_change: Option<f64>,
    },
}

/// One iteration.
#[derive(Debug, Clone, PartialEq)]
pub struct Iteration {
    /// The estimates.
    pub theta: Vec<f64>,
    /// Relative error in percent.
    pub relative_error_percent: f64,
    /// Largest change of an estimate in standard deviations; none for the first, which follows the start values.
    pub parameter_change: Option<f64>,
    /// Relative change of the error.
    pub error_change: Option<f64>,
}

/// The end of an estimation and its iterations.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// Why, if it has not converged.
    pub reason: Option<Reason>,
    /// The last estimate; none if there is none to trust.
    pub fit: Option<Fit>,
    /// Every iteration.
    pub iterations: Vec<Iteration>,
    /// Closed-loop simulations run.
    pub simulations: usize,
    /// The instruments of the last estimate, or the sensitivities of its response.
    pub instruments: Option<Matrix>,
    /// The constant that the prediction adds to `J theta` if the response is not linear in the parameters.
    pub offset: Option<Vec<f64>>,
}

impl Outcome {
    /// The state before an estimation: not converged, and without a reason.
    pub(super) fn nothing() -> Self {
        let (status, iterations) = (Status::IterationLimit, Vec::new());
        Self { status, reason: None, fit: None, iterations, simulations: 0, instruments: None, offset: None }
    }

    /// The outcome of a method that does not iterate.
    #[must_use]
    pub fn direct(result: Result<Fit, EstimationError>) -> Self {
        let (status, reason, fit) = match result {
            Ok(fit) => (Status::Converged, None, Some(fit)),
            Err(e) => (Status::NotIdentifiable, Some(Reason::Estimation(e)), None),
        };
        Self { status, reason, fit, ..Self::nothing() }
    }
}

/// A kept estimate, in words.
fn reached(relative_error_percent: f64, parameter_change: Option<f64>) -> String {
    let change = parameter_change.map(|c| format!(", last change {c:.2} standard deviations")).unwrap_or_default();
    format!("the last estimate, error {relative_error_percent:.3} %{change}")
}
