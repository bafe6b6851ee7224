//! Where there is no file system, as in a browser's page.

use std::{io, path::Path};

use super::WriteError;

/// Writes nothing.
///
/// # Errors
/// Always.
pub fn replace_file(path: &Path, content: &[u8]) -> io::Result<()> {
    replace_files([(path, content)]).map_err(|error| error.source)
}

/// Writes nothing.
///
/// # Errors
/// [`WriteError`] if there is a file.
pub fn replace_files<'f>(files: impl IntoIterator<Item = (&'f Path, &'f [u8])>) -> Result<(), WriteError> {
    match files.into_iter().next() {
        None => Ok(()),
        Some((path, _)) => Err(WriteError { path: path.to_owned(), source: io::ErrorKind::Unsupported.into() }),
    }
}
