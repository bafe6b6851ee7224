use std::path::PathBuf;

use crate::experiment::ExperimentError;
use thetahat_data::recording::RecordingError;
use thetahat_estimation::signal::SignalError;

/// Why a robot cannot be watched.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WatchError {
    /// The results or the recording cannot be used.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// A line of the recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The filter of the identification does not fit the recording's rate.
    #[error("{}: {source}; identify at the rate that you watch", path.display())]
    Signal {
        /// The results.
        path: PathBuf,
        /// Why.
        source: SignalError,
    },
    /// The model needs what cannot be watched.
    #[error("{}: its model needs {needs}, which is not watched; identify without it", path.display())]
    NotWatched {
        /// The results.
        path: PathBuf,
        /// What it needs.
        needs: &'static str,
    },
    /// The description of a signal does not fit text that grows.
    #[error("{}: {signal} {why}, which text that grows does not have; record it to a file and watch that", path.display())]
    NotInText {
        /// The recording.
        path: PathBuf,
        /// The signal.
        signal: &'static str,
        /// What it needs.
        why: &'static str,
    },
    /// The recording has no torques.
    #[error("{}: has no torques, whose residual is watched; name their columns with --torque NAME,NAME,...", path.display())]
    NoTorque {
        /// The recording.
        path: PathBuf,
    },
    /// There are fewer samples than are needed to settle.
    #[error(
        "{}: ended after {found_s:.1} s, {needed_s:.1} s are needed before watching begins; record longer or give a shorter --settle",
        path.display()
    )]
    TooShort {
        /// The recording.
        path: PathBuf,
        /// Its time, s.
        found_s: f64,
        /// What is needed, s.
        needed_s: f64,
    },
    /// Settling shows no motion.
    #[error(
        "{}: no joint moves in the {settle_s:.1} s before watching begins; start watching while the robot works, or give a longer --settle",
        path.display()
    )]
    NoMotion {
        /// The recording.
        path: PathBuf,
        /// Time of settling, s.
        settle_s: f64,
    },
    /// The recording has another number of joints.
    #[error("{}: has {found} columns of {signal}, the robot has {expected} joints; name them with --position and --torque", path.display())]
    JointCount {
        /// The recording.
        path: PathBuf,
        /// Positions or torques.
        signal: &'static str,
        /// Joints of the robot.
        expected: usize,
        /// Columns.
        found: usize,
    },
    /// An option has no sense.
    #[error("{option} is {found}, expected {expected}")]
    Option {
        /// The option.
        option: &'static str,
        /// What is expected.
        expected: &'static str,
        /// What was found.
        found: f64,
    },
}
