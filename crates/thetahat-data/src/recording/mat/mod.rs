//! MAT files of MATLAB: real numeric vectors and matrices, also as fields of structures (`log.q`) and in cell arrays; and plain HDF5 files,
//! which the reader of version 7.3 reads too.
//!
//! | file | what it does |
//! | --- | --- |
//! | `read` | the version of a file |
//! | `elements` | the data elements of a file of version 5 (`save -v7` and earlier): sizes, byte order, numbers |
//! | `shape` | samples and channels of an array |
//! | `kinds` | cell arrays, and objects that are not read |
//! | `v5` | variables of version 5 from their elements |
//! | `soft_links` | links of HDF5 that the library cannot pass by
//! | `v73` | variables of version 7.3, which is HDF5, and data sets of other HDF5 files |
//!
//! The former reader of version 5, the crate `matfile`, does not support fields of structures and int32 matrices, reads a truncated file as
//! one with fewer variables, and decompresses without bound; since the elements are walked and decompressed here, the numbers are read here
//! too.

mod elements;
mod kinds;
mod read;
mod shape;
#[cfg(feature = "hdf5")]
mod soft_links;
mod v5;
#[cfg(feature = "hdf5")]
mod v73;

#[cfg(feature = "hdf5")]
pub(super) use read::read_v73;
pub(super) use read::{read, read_hdf5};

#[cfg(test)]
mod tests;
