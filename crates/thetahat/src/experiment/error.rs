use std::path::PathBuf;

use crate::{
    filter_choice::FilterChoiceError, preparation::PreparationError, recording::RecordingError, results::ResultsError,
    robot::RobotError, simulation::SimulationError, trajectory::TrajectoryError,
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
    /// What the experiment says cannot be used for its robot or recordings.
    #[error("{}: {source}", path.display())]
    Preparation {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: PreparationError,
    },
    /// No filter can be chosen.
    #[error("{}: no filter can be chosen from the recordings: {source}", path.display())]
    Filter {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: FilterChoiceError,
    },
    /// The robot description is not usable.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The recording is not usable.
    #[error(transparent)]
    Recording(#[from] RecordingError),
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
