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
//! The former reader of version 5, the crate `matfile`, does not support fields of structures and int32 matrices, reads a truncated file as
//! one with fewer variables, and decompresses without bound; since the elements are walked and decompressed here, the numbers are read here
//! too.

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
