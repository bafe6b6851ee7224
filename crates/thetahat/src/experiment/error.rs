use std::path::PathBuf;

use crate::{
    base_parameters::BaseParametersError, control::ControllerError, recording::RecordingError, results::ResultsError,
    robot::RobotError, signal::SignalError, simulation::SimulationError, trajectory::TrajectoryError,
};

/// Why an experiment cannot be read or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExperimentError {
    /// A file cannot be read.
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The file is not TOML of the expected form; the message names line and column.
    #[error("{}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line, column and the expected keys.
        message: String,
    },
    /// A value of the experiment is not usable.
    #[error("{}: {key} is {found}, expected {expected}", path.display())]
    Value {
        /// The experiment file.
        path: PathBuf,
        /// The key.
        key: String,
        /// What is allowed.
        expected: String,
        /// What was found.
        found: String,
    },
    /// Something that a method needs is not described.
    #[error("{}: {missing} is missing: {why}", path.display())]
    Missing {
        /// The experiment file.
        path: PathBuf,
        /// The table or key.
        missing: &'static str,
        /// What needs it.
        why: &'static str,
    },
    /// The position filter asks for more than the record holds.
    #[error("{}: [signal] {source}", path.display())]
    Signal {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: SignalError,
    },
    /// The controller is not usable.
    #[error("{}: {source}", path.display())]
    Controller {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: ControllerError,
    },
    /// The parameters are not those of the robot.
    #[error("{}: [parameters] {source}", path.display())]
    Parameters {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: BaseParametersError,
    },
    /// The robot description is not usable.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The recording is not usable.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// No reference can be made of the recording.
    #[error("{}: the reference made of the recorded motion: {source}", path.display())]
    Trajectory {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: TrajectoryError,
    },
    /// The twin's moves cannot be planned.
    #[error("{}: [twin] {source}", path.display())]
    Plan {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: TrajectoryError,
    },
    /// The twin's record cannot be simulated.
    #[error("{}: [twin] {source}", path.display())]
    Twin {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: SimulationError,
    },
    /// The results cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The results miss what a prediction needs.
    #[error("{}: {problem}", path.display())]
    ResultsFile {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        problem: String,
    },
}
