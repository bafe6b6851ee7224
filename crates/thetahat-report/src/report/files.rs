//! Writes files atomically.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::error::ReportError;

/// Writes files with their content into a folder, all of them or none; returns their paths.
pub(super) fn write_files(directory: &Path, files: Vec<(&'static str, Vec<u8>)>) -> Result<Vec<PathBuf>, ReportError> {
    fs::create_dir_all(directory).map_err(|source| ReportError::Directory { path: directory.to_owned(), source })?;
    let files: Vec<NewFile> = files.into_iter().map(|(name, content)| NewFile::new(directory, name, content)).collect();
    let written = write_together(&files);
    if written.is_err() {
        files.iter().for_each(NewFile::discard);
    }
    written.map(|()| files.into_iter().map(|f| f.path).collect())
}

/// Writes one file into an existing folder. Returns its path.
pub(super) fn write_one(directory: &Path, name: &str, content: Vec<u8>) -> Result<PathBuf, ReportError> {
    let file = NewFile::new(directory, name, content);
    let written = write_together(std::slice::from_ref(&file));
    if written.is_err() {
        file.discard();
    }
    written.map(|()| file.path)
}

fn write_together(files: &[NewFile]) -> Result<(), ReportError> {
    files.iter().try_for_each(NewFile::write)?;
    files.iter().try_for_each(NewFile::rename)
}

/// A file under its temporary and its final name.
struct NewFile {
    temporary: PathBuf,
    path: PathBuf,
    content: Vec<u8>,
}

impl NewFile {
    fn new(directory: &Path, name: &str, content: Vec<u8>) -> Self {
        let temporary = directory.join(format!(".{name}.{}.part", std::process::id()));
        Self { temporary, path: directory.join(name), content }
    }

    fn write(&self) -> Result<(), ReportError> {
        if self.path.is_dir() {
            return Err(self.error(std::io::ErrorKind::IsADirectory.into()));
        }
        fs::write(&self.temporary, &self.content).map_err(|source| self.error(source))
    }

    fn rename(&self) -> Result<(), ReportError> {
        fs::rename(&self.temporary, &self.path).map_err(|source| self.error(source))
    }

    /// Removes the temporary file, if there is one.
    fn discard(&self) {
        let _ = fs::remove_file(&self.temporary);
    }

    fn error(&self, source: std::io::Error) -> ReportError {
        ReportError::Write { path: self.path.clone(), source }
    }
}
