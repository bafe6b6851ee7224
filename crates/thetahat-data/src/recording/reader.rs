//! The reader of each format. The file of a new format belongs in the folder `reader`, declared here.

use std::path::{Path, PathBuf};

use super::conversion::conversion;
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
    /// [`RecordingError::ToConvert`] if the file needs another program first, [`RecordingError::UnknownFormat`] if the extension is
    /// unknown.
    pub fn of(path: &Path) -> Result<Self, RecordingError> {
        if Self::metadata_of(path).is_some() {
            return Ok(Self::Metadata);
        }
        let extension = extension(path);
        if let Some((what, remedy)) = conversion(path, &extension) {
            return Err(RecordingError::ToConvert { file: path.to_owned(), what, remedy });
        }
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

/// How a table is read from a file.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(not(feature = "parquet"), allow(dead_code))]
pub(super) struct TableOptions<'a> {
    /// Of a text.
    pub(super) dialect: Dialect,
    /// Of a Parquet file with several episodes; none means the first.
    pub(super) episode: Option<u64>,
    /// The folder that nothing is read outside of; none means anywhere.
    pub(super) root: Option<&'a Path>,
}

/// The table in a file. For bags see `bag`.
pub(super) fn table(
    path: &Path,
    format: Format,
    options: &TableOptions<'_>,
    wanted: RequestedColumns<'_>,
) -> Result<Table, RecordingError> {
    table_with_notes(path, format, options, wanted).map(|(table, _)| table)
}

/// The table in a file, and what a user should know of it, in sentences.
pub(super) fn table_with_notes(
    path: &Path,
    format: Format,
    options: &TableOptions<'_>,
    wanted: RequestedColumns<'_>,
) -> Result<(Table, Vec<String>), RecordingError> {
    let bytes = file_bytes(path)?;
    let table = match format {
        Format::Csv => csv::read(&bytes, path, &options.dialect, wanted),
        Format::Npy => npy::read(&bytes, path),
        Format::Npz => archive(&bytes, path, wanted),
        Format::Mat => mat::read(bytes, path, wanted),
        Format::Hdf5 => mat::read_hdf5(bytes, path, wanted),
        Format::Parquet => return parquet(bytes, path, options, wanted),
        Format::Db3 | Format::Mcap | Format::Ros1 | Format::Metadata => Ok(Table::default()),
    };
    table.map(|table| (table, Vec::new()))
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
fn parquet(
    bytes: Vec<u8>,
    path: &Path,
    options: &TableOptions<'_>,
    wanted: RequestedColumns<'_>,
) -> Result<(Table, Vec<String>), RecordingError> {
    let info = super::parquet::DatasetInfo::of(path, options.root);
    super::parquet::read_episode(bytes, path, info, options.episode, wanted)
}

#[cfg(not(feature = "parquet"))]
fn parquet(
    _: Vec<u8>,
    path: &Path,
    _: &TableOptions<'_>,
    _: RequestedColumns<'_>,
) -> Result<(Table, Vec<String>), RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "Parquet files", feature: "parquet" })
}
