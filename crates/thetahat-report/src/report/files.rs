//! Writes files atomically.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::error::ReportError;
use thetahat_ground::output::replace_files;

/// Writes files with their content into a folder, all of them or none; returns their paths.
pub(super) fn write_files(directory: &Path, files: Vec<(&'static str, Vec<u8>)>) -> Result<Vec<PathBuf>, ReportError> {
    fs::create_dir_all(directory).map_err(|source| ReportError::Directory { path: directory.to_owned(), source })?;
    let paths: Vec<PathBuf> = files.iter().map(|(name, _)| directory.join(name)).collect();
    replace_files(paths.iter().map(PathBuf::as_path).zip(files.iter().map(|(_, content)| &content[..])))?;
    Ok(paths)
}

/// Writes one file into an existing folder. Returns its path.
pub(super) fn write_one(directory: &Path, name: &str, content: &[u8]) -> Result<PathBuf, ReportError> {
    let path = directory.join(name);
    replace_files([(&*path, content)])?;
    Ok(path)
}
