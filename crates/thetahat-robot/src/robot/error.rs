use std::path::{Path, PathBuf};

use super::{locking::LockError, mjcf::MjcfError, terms::TermError, urdf::UrdfError, xacro::XacroError};
use thetahat_ground::syntax::in_plain_words;

/// Why a robot description cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotError {
    /// The file cannot be read.
    #[error("{}: the robot description cannot be read: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's error.
        reason: String,
    },
    /// The bytes of the file are not text.
    #[error("{}, line {line}: the robot description is not text in {encoding}; save it as UTF-8", path.display())]
    Encoding {
        /// The file.
        path: PathBuf,
        /// The first line that cannot be read.
        line: usize,
        /// The encoding that the file states, otherwise UTF-8.
        encoding: String,
    },
    /// The file is not TOML of the expected form; the message names line and column.
    #[error("{}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line, column and the expected keys.
        message: String,
    },
    /// A list has the wrong number of entries.
    #[error("{}: {key} must have {expected} entries, one for each joint, but has {found}", path.display())]
    WrongCount {
        /// The file.
        path: PathBuf,
        /// The key.
        key: String,
        /// Number of joints.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// The chain of `parent` names returns to a joint that it has left.
    #[error("{}, line {line}: the parents of the joints form a cycle ({}); one joint must stand on the base, without `parent`", path.display(), joints.join(" -> "))]
    Cycle {
        /// The file.
        path: PathBuf,
        /// Line of the first joint of the cycle.
        line: usize,
        /// The joints on the cycle, the first repeated at the end.
        joints: Vec<String>,
    },
    /// Something is wrong with one joint.
    #[error("{}, line {line}: joint `{joint}` {problem}", path.display())]
    Joint {
        /// The file.
        path: PathBuf,
        /// Line of the joint.
        line: usize,
        /// The joint.
        joint: String,
        /// What is wrong with it, and what to do.
        problem: String,
    },
    /// A description larger than any robot's.
    #[error("{}: the robot description has more than {limit} {what}, the most that is read", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The excess quantity.
        what: &'static str,
        /// The largest number that is read.
        limit: usize,
    },
    /// A URDF that cannot be used.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
    /// A xacro that cannot be expanded.
    #[error(transparent)]
    Xacro(Box<XacroError>),
    /// An MJCF that cannot be used.
    #[error(transparent)]
    Mjcf(#[from] MjcfError),
    /// Joints that cannot be locked.
    #[error("{}: {source}", path.display())]
    Lock {
        /// The file that locks them.
        path: PathBuf,
        /// Why not.
        source: Box<LockError>,
    },
    /// The motor-joint matrix cannot be inverted.
    #[error("{}, line {line}: [transmission] matrix is singular: {reason}; every joint needs a motor that moves it", path.display())]
    SingularTransmission {
        /// The file.
        path: PathBuf,
        /// Line of the matrix.
        line: usize,
        /// The row or condition that is singular.
        reason: String,
    },
    /// A loop of links that cannot be closed.
    #[error("{}: [[loop]] `{name}` {problem}", path.display())]
    Loop {
        /// The file.
        path: PathBuf,
        /// The loop.
        name: String,
        /// What is wrong with it, and what to do.
        problem: String,
    },
    /// A value is NaN or infinite.
    #[error("{}: {key} is {found}, expected finite numbers", path.display())]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// The key.
        key: String,
        /// The value.
        found: f64,
    },
    /// A value is not in its range.
    #[error("{}: {key} is {found}, expected {expected}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The key.
        key: String,
        /// What is allowed.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// A torque term that cannot be used.
    #[error("{}: {source}", path.display())]
    Term {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<TermError>,
    },
    /// A parameter name that this robot does not have.
    #[error("{}: [parameters] {name}: this robot has no such parameter; joint 1 has {}, and so on by number", path.display(), known.join(" "))]
    UnknownParameter {
        /// The file.
        path: PathBuf,
        /// The name found.
        name: String,
        /// The names of the first joint.
        known: Vec<String>,
    },
}

impl From<XacroError> for RobotError {
    fn from(error: XacroError) -> Self {
        Self::Xacro(Box::new(error))
    }
}

impl RobotError {
    pub(super) fn lock(path: &Path, source: LockError) -> Self {
        Self::Lock { path: path.to_owned(), source: Box::new(source) }
    }

    pub(super) fn of_toml(error: &toml::de::Error, path: &Path) -> Self {
        Self::Syntax { path: path.to_owned(), message: in_plain_words(&error.to_string()) }
    }
}
