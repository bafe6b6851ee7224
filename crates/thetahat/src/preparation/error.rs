use std::{error::Error, fmt::Display, sync::Arc};

use thetahat_estimation::{control::ControllerError, signal::SignalError, trajectory::TrajectoryError};
use thetahat_model::{
    base_parameters::BaseParametersError, consistency::ConsistencyError, dynamics::DynamicsError, robot::NotARobot,
};

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
    /// A value is not a finite number above zero.
    #[error("{key} is {found}, expected a finite number above zero")]
    NotPositive {
        /// The key.
        key: String,
        /// The value.
        found: f64,
    },
    /// A signal has not one channel for each coordinate of the robot.
    #[error("{place}: number of channels is {found}, expected {expected}, one for each coordinate of the robot")]
    JointCount {
        /// The signal of a recording, as `recording a, position`, or the file that holds it.
        place: String,
        /// Number of coordinates of the robot.
        expected: usize,
        /// Channels of the signal.
        found: usize,
    },
    /// A channel that torque terms take has neither one column nor one for each coordinate of the robot.
    #[error(
        "recording {recording}: the number of columns of channel {channel} is {found}, expected 1, or {expected}, one for each \
         coordinate of the robot"
    )]
    ColumnCount {
        /// The recording.
        recording: String,
        /// Name of the channel.
        channel: String,
        /// Number of coordinates of the robot.
        expected: usize,
        /// Columns of the channel.
        found: usize,
    },
    /// A signal has not as many samples as the positions.
    #[error(
        "recording {recording}: the number of samples of {signal} is {found}, expected {expected}, that of position"
    )]
    SampleCount {
        /// The recording.
        recording: String,
        /// The signal, such as `torque`.
        signal: String,
        /// Samples of the positions.
        expected: usize,
        /// Samples of the signal.
        found: usize,
    },
    /// A sample is NaN or infinite.
    #[error(
        "recording {recording}: {signal}, column {column} at sample {sample} (counted from 0) is {found}, expected a finite number"
    )]
    NotFinite {
        /// The recording.
        recording: String,
        /// The signal, such as `torque`.
        signal: String,
        /// The column, counted from 1, as joints are.
        column: usize,
        /// The sample, counted from 0.
        sample: usize,
        /// The value: NaN or an infinity.
        found: f64,
    },
    /// The loops of links cannot be closed at a sample.
    #[error("recording {recording}, sample {sample} (counted from 0), joints at {position:.4?} rad or m: {source}")]
    OpenLoop {
        /// The recording.
        recording: String,
        /// The sample.
        sample: usize,
        /// Positions of the driven joints, rad or m.
        position: Vec<f64>,
        /// Which joint is not determined, and what to do.
        source: DynamicsError,
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
    /// [`PreparationError::NotPositive`].
    pub(crate) fn require_positive(key: &str, value: f64) -> Result<(), Self> {
        let is_positive = value > 0.0 && value.is_finite();
        if is_positive { Ok(()) } else { Err(Self::NotPositive { key: key.to_owned(), found: value }) }
    }
}
