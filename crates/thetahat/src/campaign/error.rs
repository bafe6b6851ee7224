use std::path::PathBuf;

use super::row::Key;
use crate::experiment::ExperimentError;

/// Why a campaign cannot be read, run or stored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CampaignError {
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
    /// A value of the campaign is not usable.
    #[error("{}: {key} is {found}, expected {expected}", path.display())]
    Value {
        /// The campaign file.
        path: PathBuf,
        /// The key.
        key: String,
        /// What is allowed.
        expected: String,
        /// What was found.
        found: String,
    },
    /// The experiment, its robot or its twin is not usable.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// No physical start was drawn.
    #[error(
        "{}: [starts]: none of {draws} draws around the a-priori parameters is physical. {reason}",
        path.display()
    )]
    NoPhysicalStart {
        /// The campaign file.
        path: PathBuf,
        /// Draws made.
        draws: u32,
        /// The link or joint, what it violates, and the remedy.
        reason: String,
    },
    /// A recording that the campaign does not have.
    #[error(
        "{}: has no recording of noise level {}, start {} and seed {}, each from one",
        path.display(), key.level.saturating_add(1), key.start.saturating_add(1), key.seed.saturating_add(1)
    )]
    NoRecording {
        /// The campaign file.
        path: PathBuf,
        /// Noise level, start and seed of the recording.
        key: Key,
    },
    /// The folder holds the results of another campaign.
    #[error(
        "{}: holds runs of another campaign: {changed} is not what it was when they were made; take another folder, or \
         delete this one",
        folder.display()
    )]
    OtherCampaign {
        /// The folder.
        folder: PathBuf,
        /// What changed: the campaign, the experiment, the robot, what the twin follows, or the version of the program.
        changed: String,
    },
    /// Another campaign is running into the folder.
    #[error("{}: another campaign runs into it; wait for its end, or take another folder", folder.display())]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds files, and none says that they are of a campaign.
    #[error("{}: holds files but no {manifest}, so it is not the folder of a campaign; take another folder", folder.display())]
    NoCampaign {
        /// The folder.
        folder: PathBuf,
        /// The file that is missing.
        manifest: &'static str,
    },
    /// This build cannot write Parquet files, in which a folder keeps the runs.
    #[error("{}: this program was built without Parquet files, in which a campaign is kept", folder.display())]
    NoParquet {
        /// The folder.
        folder: PathBuf,
    },
    /// A file of the folder is not what this program writes.
    #[error("{}: {problem}; delete the file, and its runs are made again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A file or folder cannot be written.
    #[error("{}: cannot be written: {reason}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system or the Parquet library says.
        reason: String,
    },
}
