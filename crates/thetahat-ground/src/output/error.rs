//! Why a file is not written.

use std::{io, path::PathBuf};

/// Why a file is not written. The remedy is another place, or, for [`OutputError::NotOurs`], [`OutputError::OfAnotherRobot`] and
/// [`OutputError::MayHoldChanges`], a guard that is made with `force`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The file is an input of the same run.
    #[error("{}: is read as an input, and is not replaced", path.display())]
    IsInput {
        /// The file.
        path: PathBuf,
    },
    /// Something else than a file is there.
    #[error("{}: expected a file, found {found}", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
        /// A folder, a pipe or a device.
        found: &'static str,
    },
    /// Something else than a folder is there.
    #[error("{}: expected a folder, found {found}", path.display())]
    NotAFolder {
        /// The path.
        path: PathBuf,
        /// A file, a pipe or a device.
        found: &'static str,
    },
    /// A link is there.
    #[error("{}: is a link to {}, and is not replaced", path.display(), target.display())]
    IsLink {
        /// The link.
        path: PathBuf,
        /// What it leads to.
        target: PathBuf,
    },
    /// There is no folder for the file.
    #[error("{}: there is no such folder; make it, or choose another file", path.display())]
    NoFolder {
        /// The folder.
        path: PathBuf,
    },
    /// A file is there that this program did not write, or that is of another kind.
    #[error("{}: exists and is not a file of this kind that thetahat wrote", path.display())]
    NotOurs {
        /// The file.
        path: PathBuf,
    },
    /// A result of another robot is there.
    #[error("{}: is of another robot than {robot}", path.display())]
    OfAnotherRobot {
        /// The file.
        path: PathBuf,
        /// The robot of this command.
        robot: String,
    },
    /// A file is there that this program wrote for the user to edit.
    #[error("{}: exists and may contain your changes", path.display())]
    MayHoldChanges {
        /// The file.
        path: PathBuf,
    },
    /// The existing file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {source}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The system's error.
    pub source: io::Error,
}
