//! Apache Parquet: numeric columns, uncompressed or with Snappy or Zstandard.
//!
//! | file | what it does |
//! | --- | --- |
//! | `thrift`, `records` | walk over the records that describe a file, to check them before the library uses them |
//! | `guard` | checks between the library and the file: sizes of pages and dictionaries |
//! | `read` | the description of a file, and any rows of its columns |
//! | `numbers` | converts values to numbers, also of lists of equal lengths |
//! | `lerobot` | names of channels and episodes of LeRobot's datasets |
//! | `pieces` | a file that is read in pieces |

mod guard;
mod lerobot;
mod numbers;
mod pieces;
mod read;
mod records;
mod thrift;

pub(super) use lerobot::DatasetInfo;
pub(super) use pieces::{GroupPieces, fuzz_pieces};
pub(super) use read::read_episode;

#[cfg(test)]
mod tests;
