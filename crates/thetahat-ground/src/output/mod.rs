//! Where files may be written, and how: never over an input, a link or a device, over files of other programs, kinds or robots only with
//! force, and whole or not at all.

mod error;
mod guard;
mod kind;
mod lock;
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
mod nowhere;
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
mod replace;

pub use error::{OutputError, WriteError};
pub use guard::{OutputGuard, remove_own};
pub use kind::{
    DESIGNED_EXPERIMENT, EXPORT, FileKind, MOVES_JSON, POINTS, PROPOSAL, RECORD, TRAJECTORY, TRAJECTORY_JSON,
    TRAJECTORY_YAML,
};
pub use lock::FileLock;
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub use nowhere::{replace_file, replace_files};
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
pub use replace::{UnfinishedFolder, replace_file, replace_files};

/// Extension of unfinished files.
pub const TEMPORARY: &str = "part";
