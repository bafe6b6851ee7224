//! The drives of a robot for simulators that take its links from elsewhere: what is written, and read back.

mod bam;
mod drive;
mod isaac;
mod of_format;
mod pace;

pub(super) use drive::Written;
pub(super) use of_format::{read, text};
