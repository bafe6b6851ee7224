//! MAT files of MATLAB: real numeric vectors and matrices, also as fields of structures (`log.q`).
//!
//! | file | what it does |
//! | --- | --- |
//! | `parts` | the parts of a file of version 5 (`save -v7` and earlier): sizes, byte order, numbers |
//! | `v5` | variables of version 5 from their parts |
//! | `v73` | variables of version 7.3, which is HDF5 |
//!
//! The crate that read version 5 before, `matfile`, does not know fields of structures and int32 matrices, reads a file
//! that was cut short as one with fewer variables, and decompresses without bound; with the parts walked over and
//! decompressed here, only the numbers themselves were left to it, so they are read here too.

mod parts;
mod v5;
#[cfg(feature = "hdf5")]
mod v73;

use std::path::Path;

use super::RecordingError;
use super::table::{Column, Table, Wanted};

/// The signature of an HDF5 file, at its beginning or behind a header of 512 bytes.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// The variables of a MAT file. Those not wanted are there by name, without values.
pub(super) fn read(bytes: Vec<u8>, path: &Path, wanted: Wanted<'_>) -> Result<Table, RecordingError> {
    let columns = if is_version_7_3(&bytes) { read_v73(bytes, path, wanted)? } else { v5::read(&bytes, path, wanted)? };
    Ok(Table { name: String::new(), columns })
}

fn is_version_7_3(bytes: &[u8]) -> bool {
    bytes.starts_with(b"MATLAB 7.3") || [0, 512].iter().any(|&at| bytes.get(at..).is_some_and(|b| b.starts_with(HDF5)))
}

#[cfg(feature = "hdf5")]
pub(super) fn read_v73(bytes: Vec<u8>, path: &Path, wanted: Wanted<'_>) -> Result<Vec<Column>, RecordingError> {
    v73::read(bytes, path, wanted)
}

#[cfg(not(feature = "hdf5"))]
pub(super) fn read_v73(_: Vec<u8>, path: &Path, _: Wanted<'_>) -> Result<Vec<Column>, RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "MAT files of version 7.3", feature: "hdf5" })
}

/// Samples and channels of an array: a vector, whichever way it lies, is one channel; a matrix has one for each column.
fn samples_and_channels(shape: &[usize]) -> Option<(usize, usize)> {
    match *shape {
        [1, columns] => Some((columns, 1)),
        [rows, columns] => Some((rows, columns)),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
