//! The reader of each format. The file of a new format belongs in the folder `reader`, declared here.

use std::path::{Path, PathBuf};

use super::csv::{self, Dialect};
use super::error::RecordingError;
use super::format::Format;
use super::place::file_bytes;
use super::table::{RequestedColumns, Table};
use super::{mat, npy};
use thetahat_ground::files;

/// The file of a ROS 2 bag that lists its other files.
const METADATA: &str = "metadata.yaml";

impl Format {
    /// The format of a path by its extension. A folder with `metadata.yaml` is a bag, and so is that file; of a bag that is compressed, as
    /// `bag.mcap.zstd`, the extension before the last counts.
    ///
    /// # Errors
    /// [`RecordingError::UnknownFormat`] if the extension is unknown.
    pub fn of(path: &Path) -> Result<Self, RecordingError> {
        if Self::metadata_of(path).is_some() {
            return Ok(Self::Metadata);
        }
        let extension = extension(path);
        let format = match extension.as_str() {
            "zstd" | "zst" => compressed_bag(path),
            other => Self::of_extension(other),
        };
        format.ok_or_else(|| RecordingError::UnknownFormat { file: path.to_owned(), found: extension })
    }

    /// The metadata in the folder of a bag.
    pub(super) fn metadata_below(folder: &Path) -> PathBuf {
        folder.join(METADATA)
    }

    /// The metadata of a bag, by its folder or their own path; none for other files.
    pub(super) fn metadata_of(path: &Path) -> Option<PathBuf> {
        if path.file_name().is_some_and(|name| name == METADATA) {
            return Some(path.to_owned());
        }
        let metadata = Self::metadata_below(path);
        files::is_file(&metadata).then_some(metadata)
    }
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// The format of a bag that was compressed as a whole, by the extension before the last.
fn compressed_bag(path: &Path) -> Option<Format> {
    let format = Format::of_extension(&extension(Path::new(path.file_stem()?)))?;
    matches!(format, Format::Db3 | Format::Mcap).then_some(format)
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
        Format::Db3 | Format::Mcap | Format::Ros1 | Format::Metadata => Ok(Table::default()),
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
