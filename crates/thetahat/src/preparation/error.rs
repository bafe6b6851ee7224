use std::{error::Error, fmt::Display, sync::Arc};

use thetahat_estimation::{control::ControllerError, signal::SignalError, trajectory::TrajectoryError};
use thetahat_model::{base_parameters::BaseParametersError, consistency::ConsistencyError, robot::NotARobot};

/// Why a robot cannot be identified from its recordings with these settings. Keys are those of an experiment file.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum PreparationError {
    /// A value is not usable.
    #[error("{key} is {found}, expected {expected}")]
    Value {
        /// The key.
        key: String,
        /// What is allowed.
        expected: String,
        /// What was found.
        found: String,
    },
    /// The robot cannot be computed with.
    #[error("{source}")]
    Robot {
        /// Why.
        #[from]
        source: NotARobot,
    },
    /// Something that a method needs is not described.
    #[error("{missing} is missing: {why}")]
    Missing {
        /// The table or key.
        missing: &'static str,
        /// What needs it.
        why: &'static str,
    },
    /// The position filter asks for more than the recording holds.
    #[error("[signal] {source}")]
    Signal {
        /// Why.
        #[from]
        source: SignalError,
    },
    /// The controller is not usable.
    #[error("{source}")]
    Controller {
        /// Why.
        #[from]
        source: ControllerError,
    },
    /// The parameters are not those of the robot.
    #[error("[parameters] {source}")]
    Parameters {
        /// Why.
        #[from]
        source: BaseParametersError,
    },
    /// What is fixed or known cannot hold.
    #[error("{place}: {source}")]
    Consistency {
        /// The key.
        place: String,
        /// Why.
        source: ConsistencyError,
    },
    /// An estimator of the user's own failed.
    #[error("the estimator {name}{part}: {source}")]
    Estimator {
        /// Its name.
        name: String,
        /// The part that was left out, in words; empty where all rows were given.
        part: String,
        /// What it says.
        source: Arc<dyn Error + Send + Sync>,
    },
    /// No reference can be made of the recording.
    #[error("the reference made of the recorded motion: {source}")]
    Reference {
        /// Why.
        #[from]
        source: TrajectoryError,
    },
}

impl PreparationError {
    /// A value that is not usable.
    pub(crate) fn value(key: &str, expected: &str, found: impl Display) -> Self {
        Self::Value { key: key.to_owned(), expected: expected.to_owned(), found: found.to_string() }
    }

    /// Refuses a value where `holds` is false.
    ///
    /// # Errors
    /// [`PreparationError::Value`].
    pub(crate) fn require(holds: bool, key: &str, expected: &str, found: impl Display) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self::value(key, expected, found)) }
    }

    /// Refuses what is not a finite number above zero.
    ///
    /// # Errors
    /// [`PreparationError::Value`].
    pub(crate) fn require_positive(key: &str, value: f64) -> Result<(), Self> {
        Self::require(value > 0.0 && value.is_finite(), key, "a finite number above zero", value)
    }
}
