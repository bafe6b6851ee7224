//! The variables of a MAT file of either version.

use std::path::Path;

use super::super::error::RecordingError;
use super::super::table::{Column, RequestedColumns, Table};
use super::v5;
#[cfg(feature = "hdf5")]
use super::v73::{self, Convention};

/// The signature of an HDF5 file, at its beginning or after a header of 512 bytes.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// The variables of a MAT file. Variables that are not requested have a name and no values.
pub(in super::super) fn read(
    bytes: Vec<u8>,
    path: &Path,
    wanted: RequestedColumns<'_>,
) -> Result<Table, RecordingError> {
    let columns = if is_version_7_3(&bytes) { read_v73(bytes, path, wanted)? } else { v5::read(&bytes, path, wanted)? };
    Ok(Table { name: String::new(), columns })
}

/// The data sets of an HDF5 file. Those that are not requested have a name and no values.
#[cfg(feature = "hdf5")]
pub(in super::super) fn read_hdf5(
    bytes: Vec<u8>,
    path: &Path,
    wanted: RequestedColumns<'_>,
) -> Result<Table, RecordingError> {
    let columns = v73::read(bytes, path, Convention::Hdf5, wanted)?;
    Ok(Table { name: String::new(), columns })
}

#[cfg(not(feature = "hdf5"))]
pub(in super::super) fn read_hdf5(_: Vec<u8>, path: &Path, _: RequestedColumns<'_>) -> Result<Table, RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "HDF5 files", feature: "hdf5" })
}

fn is_version_7_3(bytes: &[u8]) -> bool {
    bytes.starts_with(b"MATLAB 7.3") || [0, 512].iter().any(|&at| bytes.get(at..).is_some_and(|b| b.starts_with(HDF5)))
}

#[cfg(feature = "hdf5")]
pub(in super::super) fn read_v73(
    bytes: Vec<u8>,
    path: &Path,
    wanted: RequestedColumns<'_>,
) -> Result<Vec<Column>, RecordingError> {
    v73::read(bytes, path, Convention::Matlab, wanted)
}

#[cfg(not(feature = "hdf5"))]
pub(in super::super) fn read_v73(
    _: Vec<u8>,
    path: &Path,
    _: RequestedColumns<'_>,
) -> Result<Vec<Column>, RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "MAT files of version 7.3", feature: "hdf5" })
}
