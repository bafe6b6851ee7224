//! The files that the library reads: those of the file system, or, in a browser's page, those that the page has put into memory.
//!
//! No other file of the library reads by `std::fs` (`tests/architecture`).

#[cfg(any(test, all(target_family = "wasm", target_os = "unknown")))]
mod memory;
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
mod system;

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub use memory::{File, exists, is_file, length, open, read, real};
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub use memory::{beginning, put, remove, sizes};
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
pub use system::{File, exists, is_file, length, open, read, real};

use std::{io, path::Path};

/// All of a file that is text.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    String::from_utf8(read(path)?)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "stream did not contain valid UTF-8"))
}
