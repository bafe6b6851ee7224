//! The reader of each format. The file of a new format belongs in the folder `reader`, declared here.

use std::path::Path;

use super::csv::{self, Dialect};
use super::error::RecordingError;
use super::format::Format;
use super::place::file_bytes;
use super::table::{RequestedColumns, Table};
use super::{mat, npy};

impl Format {
    /// The format of a path by its extension.
    ///
    /// # Errors
    /// [`RecordingError::UnknownFormat`] if the extension is unknown.
    pub fn of(path: &Path) -> Result<Self, RecordingError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let format = Self::of_extension(&extension);
        format.ok_or_else(|| RecordingError::UnknownFormat { file: path.to_owned(), found: extension })
    }
}

/// The table in a file. For bags see `bag`.
pub(super) fn table(
    path: &Path,
    format: Format,
    dialect: &Dialect,
    wanted: RequestedColumns<'_>,
) -> Result<Table, RecordingError> {
    let bytes = file_bytes(path)?;
    match format {
        Format::Csv => csv::read(&bytes, path, dialect, wanted),
        Format::Npy => npy::read(&bytes, path),
        Format::Npz => archive(&bytes, path, wanted),
        Format::Mat => mat::read(bytes, path, wanted),
        Format::Parquet => parquet(bytes, path, wanted),
        Format::Db3 | Format::Mcap => Ok(Table::default()),
    }
}

#[cfg(feature = "npz")]
fn archive(bytes: &[u8], path: &Path, wanted: RequestedColumns<'_>) -> Result<Table, RecordingError> {
    super::npz::read(bytes, path, wanted)
}

#[cfg(not(feature = "npz"))]
fn archive(_: &[u8], path: &Path, _: RequestedColumns<'_>) -> Result<Table, RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "NumPy archives", feature: "npz" })
}

#[cfg(feature = "parquet")]
fn parquet(bytes: Vec<u8>, path: &Path, wanted: RequestedColumns<'_>) -> Result<Table, RecordingError> {
    super::parquet::read(bytes, path, wanted)
}

#[cfg(not(feature = "parquet"))]
fn parquet(_: Vec<u8>, path: &Path, _: RequestedColumns<'_>) -> Result<Table, RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "Parquet files", feature: "parquet" })
}
