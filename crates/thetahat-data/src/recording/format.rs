//! The formats of recordings, recognised by the extension.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A kind of file that holds recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Format {
    /// Text in columns: `.csv`, `.tsv`, `.tab`, `.txt`, `.dat`, `.asc`, `.log`, `.lvm`.
    Csv,
    /// One NumPy array: `.npy`.
    Npy,
    /// A NumPy archive of arrays: `.npz`.
    Npz,
    /// MATLAB variables: `.mat`, of version 5 or 7.3.
    Mat,
    /// HDF5: `.h5`, `.hdf5`.
    Hdf5,
    /// Apache Parquet: `.parquet`.
    Parquet,
    /// A ROS 2 bag in SQLite: `.db3`.
    Db3,
    /// A ROS 2 bag in MCAP: `.mcap`.
    Mcap,
    /// A bag of ROS 1: `.bag`.
    Ros1,
    /// A ROS 2 bag of one or several files: its folder, or `metadata.yaml`.
    Metadata,
}

/// The structure in which a file contains its channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holds {
    /// Lines of text, in a dialect.
    Lines,
    /// Named arrays.
    Arrays,
    /// Topics with messages.
    Topics,
}

impl Format {
    /// The format of a lower-case extension; none if there is none.
    pub(super) fn of_extension(extension: &str) -> Option<Self> {
        match extension {
            "csv" | "tsv" | "tab" | "txt" | "dat" | "asc" | "log" | "lvm" => Some(Self::Csv),
            "npy" => Some(Self::Npy),
            "npz" => Some(Self::Npz),
            "mat" => Some(Self::Mat),
            "h5" | "hdf5" => Some(Self::Hdf5),
            "parquet" => Some(Self::Parquet),
            "db3" => Some(Self::Db3),
            "mcap" => Some(Self::Mcap),
            "bag" => Some(Self::Ros1),
            _ => None,
        }
    }

    /// The structure in which the file contains its channels.
    pub(super) fn holds(self) -> Holds {
        match self {
            Self::Csv => Holds::Lines,
            Self::Npy | Self::Npz | Self::Mat | Self::Hdf5 | Self::Parquet => Holds::Arrays,
            Self::Db3 | Self::Mcap | Self::Ros1 | Self::Metadata => Holds::Topics,
        }
    }

    /// Whether the file is a bag: its tables are topics.
    #[must_use]
    pub fn is_bag(self) -> bool {
        self.holds() == Holds::Topics
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
            Self::Hdf5 => "an HDF5 file",
            Self::Parquet => "a Parquet file",
            Self::Db3 => "a ROS 2 bag in SQLite",
            Self::Mcap => "a ROS 2 bag in MCAP",
            Self::Ros1 => "a ROS 1 bag",
            Self::Metadata => "a folder of a ROS 2 bag",
        })
    }
}
