//! MAT files of MATLAB: real numeric vectors and matrices, also as fields of structures (`log.q`).
//!
//! | file | what it does |
//! | --- | --- |
//! | `read` | the version of a file |
//! | `elements` | the data elements of a file of version 5 (`save -v7` and earlier): sizes, byte order, numbers |
//! | `shape` | samples and channels of an array |
//! | `v5` | variables of version 5 from their elements |
//! | `v73` | variables of version 7.3, which is HDF5 |
//!
//! The crate that read version 5 before, `matfile`, does not know fields of structures and int32 matrices, reads a file
//! that was cut short as one with fewer variables, and decompresses without bound; with the elements walked over and
//! decompressed here, only the numbers themselves were left to it, so they are read here too.

mod elements;
mod read;
mod shape;
mod v5;
#[cfg(feature = "hdf5")]
mod v73;

pub(super) use read::read;
#[cfg(feature = "hdf5")]
pub(super) use read::read_v73;

#[cfg(test)]
mod tests;
