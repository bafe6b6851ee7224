//! Apache Parquet: numeric columns, uncompressed or with Snappy or Zstandard.
//!
//! | file | what it does |
//! | --- | --- |
//! | `thrift`, `records` | walk over the records that describe a file, to check them before the library believes them |
//! | `guard` | what stands between the library and the bytes of a file: sizes of pages and dictionaries |
//! | `read` | columns to numbers |

mod guard;
mod read;
mod records;
mod thrift;

pub(super) use read::read;

#[cfg(test)]
mod tests;
