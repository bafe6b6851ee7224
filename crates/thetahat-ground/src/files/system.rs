//! Files of the system.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

pub use std::fs::File;

/// All bytes of a file.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    fs::read(path)
}

/// A file opened for reading.
pub fn open(path: &Path) -> io::Result<File> {
    File::open(path)
}

/// The length in bytes of an ordinary file. Folders, pipes and devices are refused: reading one may never end.
pub fn length(path: &Path) -> io::Result<u64> {
    let metadata = fs::metadata(path)?;
    if metadata.is_file() {
        return Ok(metadata.len());
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a folder or a device"))
}

/// The absolute path of an existing file or folder, links followed.
pub fn real(path: &Path) -> io::Result<PathBuf> {
    path.canonicalize()
}

/// Whether there is a file or a folder.
pub fn exists(path: &Path) -> bool {
    path.exists()
}

/// Whether there is an ordinary file.
pub fn is_file(path: &Path) -> bool {
    path.is_file()
}
