//! Every reader applied to bytes, for fuzz tests: each reads everything in the bytes and discards it.
//!
//! The readers of HDF5, Parquet and MCAP catch panics of their libraries. A fuzzer that stops at a panic before it is caught must not
//! replace the panic hook.

use std::path::Path;

use super::csv::{self, Decimal, Dialect};
use super::table::RequestedColumns;
use super::{mat, npy};

/// Text in columns, with everything detected.
pub fn csv(bytes: &[u8]) {
    for channels_in_rows in [false, true] {
        let dialect = Dialect { channels_in_rows, ..Dialect::default() };
        let _ = csv::read(bytes, Path::new("fuzz.csv"), &dialect, RequestedColumns::All);
    }
}

/// Text of another tool: the first two bytes choose what a user states of it, the others are the text. All columns are read, and those
/// of seconds and nanoseconds.
pub fn text(bytes: &[u8]) {
    let Some((&[first, second], text)) = bytes.split_first_chunk::<2>() else { return };
    let mut choice = usize::from(u16::from_le_bytes([first, second]));
    let mut next = |count: usize| {
        let chosen = choice % count;
        choice /= count;
        chosen
    };
    let dialect = Dialect {
        delimiter: [None, Some(','), Some(';'), Some('\t'), Some(' '), Some('|')][next(6)],
        decimal: [None, Some(Decimal::Point), Some(Decimal::Comma)][next(3)],
        header: [None, Some(true), Some(false)][next(3)],
        skip_lines: [None, Some(0), Some(2), Some(u64::MAX)][next(4)],
        day_first: [None, Some(true), Some(false)][next(3)],
        drop_cut_line: next(2) == 1,
        channels_in_rows: next(2) == 1,
    };
    let path = Path::new("fuzz.csv");
    let columns = ["sec".to_owned(), "1+2".to_owned()];
    for wanted in [RequestedColumns::All, RequestedColumns::Named(&columns)] {
        let _ = csv::read(text, path, &dialect, wanted);
    }
}

/// A NumPy array.
pub fn npy(bytes: &[u8]) {
    let _ = npy::read(bytes, Path::new("fuzz.npy"));
}

/// A NumPy archive.
#[cfg(feature = "npz")]
pub fn npz(bytes: &[u8]) {
    let _ = super::npz::read(bytes, Path::new("fuzz.npz"), RequestedColumns::All);
}

/// A MAT file: of version 7.3 if the bytes begin as one does.
pub fn mat(bytes: &[u8]) {
    let _ = mat::read(bytes.to_vec(), Path::new("fuzz.mat"), RequestedColumns::All);
}

/// A MAT file of version 7.3, whatever the bytes begin with.
#[cfg(feature = "hdf5")]
pub fn mat73(bytes: &[u8]) {
    let _ = mat::read_v73(bytes.to_vec(), Path::new("fuzz.mat"), RequestedColumns::All);
}

/// An HDF5 file.
#[cfg(feature = "hdf5")]
pub fn hdf5(bytes: &[u8]) {
    let _ = mat::read_hdf5(bytes.to_vec(), Path::new("fuzz.h5"), RequestedColumns::All);
}

/// A Parquet file, whole and a piece of it.
#[cfg(feature = "parquet")]
pub fn parquet(bytes: &[u8]) {
    let info = super::parquet::DatasetInfo::default();
    let _ = super::parquet::read_episode(bytes.to_vec(), Path::new("fuzz.parquet"), info, None, RequestedColumns::All);
    super::parquet::fuzz_pieces(bytes);
}

/// A bag in SQLite.
#[cfg(feature = "rosbag")]
pub fn db3(bytes: &[u8]) {
    super::bag::fuzz_db3(bytes);
}

/// A bag of ROS 1.
#[cfg(feature = "rosbag")]
pub fn ros1(bytes: &[u8]) {
    super::bag::fuzz_ros1(bytes);
}

/// A bag in MCAP.
#[cfg(feature = "rosbag")]
pub fn mcap(bytes: &[u8]) {
    super::bag::fuzz_mcap(bytes);
}
