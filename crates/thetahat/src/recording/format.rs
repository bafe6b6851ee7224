//! The formats of recordings, told apart by the extension, and the reader of each.

use std::fmt;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::csv::{self, Dialect};
use super::place::file_bytes;
use super::table::{Table, Wanted};
use super::{RecordingError, mat, npy};

/// A kind of file that holds recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Format {
    /// Text in columns: `.csv`, `.tsv`, `.txt`, `.dat`.
    Csv,
    /// One NumPy array: `.npy`.
    Npy,
    /// A NumPy archive of arrays: `.npz`.
    Npz,
    /// MATLAB variables: `.mat`, of version 5 or 7.3.
    Mat,
    /// Apache Parquet: `.parquet`.
    Parquet,
    /// A ROS 2 bag in SQLite: `.db3`.
    Db3,
    /// A ROS 2 bag in MCAP: `.mcap`.
    Mcap,
}

impl Format {
    /// The format that the extension of a path names.
    ///
    /// # Errors
    /// [`RecordingError::UnknownFormat`] if it names none.
    pub fn of(path: &Path) -> Result<Self, RecordingError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match extension.as_str() {
            "csv" | "tsv" | "txt" | "dat" => Ok(Self::Csv),
            "npy" => Ok(Self::Npy),
            "npz" => Ok(Self::Npz),
            "mat" => Ok(Self::Mat),
            "parquet" => Ok(Self::Parquet),
            "db3" => Ok(Self::Db3),
            "mcap" => Ok(Self::Mcap),
            _ => Err(RecordingError::UnknownFormat { file: path.to_owned(), found: extension }),
        }
    }

    /// Whether the file is a bag: its tables are topics.
    pub(super) fn is_bag(self) -> bool {
        matches!(self, Self::Db3 | Self::Mcap)
    }

    /// Whether the file is one table, whose columns are all channels unless some are named.
    pub(super) fn is_one_table(self) -> bool {
        matches!(self, Self::Csv | Self::Parquet)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Csv => "text in columns (CSV)",
            Self::Npy => "a NumPy array",
            Self::Npz => "a NumPy archive",
            Self::Mat => "a MAT file",
            Self::Parquet => "a Parquet file",
            Self::Db3 => "a ROS 2 bag in SQLite",
            Self::Mcap => "a ROS 2 bag in MCAP",
        })
    }
}

/// The table that a file holds. For bags see `bag`.
pub(super) fn table(
    path: &Path,
    format: Format,
    dialect: &Dialect,
    wanted: Wanted<'_>,
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
fn archive(bytes: &[u8], path: &Path, wanted: Wanted<'_>) -> Result<Table, RecordingError> {
    super::npz::read(bytes, path, wanted)
}

#[cfg(not(feature = "npz"))]
fn archive(_: &[u8], path: &Path, _: Wanted<'_>) -> Result<Table, RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "NumPy archives", feature: "npz" })
}

#[cfg(feature = "parquet")]
fn parquet(bytes: Vec<u8>, path: &Path, wanted: Wanted<'_>) -> Result<Table, RecordingError> {
    super::parquet::read(bytes, path, wanted)
}

#[cfg(not(feature = "parquet"))]
fn parquet(_: Vec<u8>, path: &Path, _: Wanted<'_>) -> Result<Table, RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "Parquet files", feature: "parquet" })
}
