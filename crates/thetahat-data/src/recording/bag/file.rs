//! The messages of a file by its format.

use std::path::Path;

use super::super::error::RecordingError;
use super::super::format::Format;
use super::topics::Topics;
use super::{db3, mcap, ros1};

/// Adds the messages of a file: those of one topic, or all.
pub(super) fn add(path: &Path, format: Format, topic: Option<&str>, topics: &mut Topics) -> Result<(), RecordingError> {
    match format {
        Format::Mcap => mcap::read(path, topic, topics),
        Format::Ros1 => ros1::read(path, topic, topics),
        Format::Db3 => db3::read(path, topic, topics),
        Format::Metadata | Format::Csv | Format::Npy | Format::Npz | Format::Mat | Format::Hdf5 | Format::Parquet => {
            Ok(())
        }
    }
}
