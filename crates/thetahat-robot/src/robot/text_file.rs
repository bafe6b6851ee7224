//! Files of text, with what identifies their content.

use std::{io::Read, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    encoding::{NotText, decoded},
    error::RobotError,
};
use thetahat_ground::{digest::sha256, files};

/// Longest robot description, bytes.
const LONGEST: u64 = 16 << 20;

/// A file that a robot was read from, with a digest that identifies its content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RobotFile {
    /// Its name without folders.
    pub name: String,
    /// SHA-256 of its bytes, in hexadecimal digits: what `sha256sum` prints.
    pub sha256: String,
}

impl RobotFile {
    pub(super) fn new(path: &Path, bytes: &[u8]) -> Self {
        Self {
            name: path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
            sha256: sha256(bytes),
        }
    }
}

/// The text of a file, and the file.
pub(super) struct TextFile {
    pub(super) text: String,
    pub(super) file: RobotFile,
}

/// A description of at most 16 MiB, in UTF-8 or the encoding of its byte order mark or XML declaration.
pub(super) fn read(path: &Path) -> Result<TextFile, RobotError> {
    let unreadable = |e: std::io::Error| RobotError::Unreadable { path: path.to_owned(), reason: e.to_string() };
    let mut bytes = Vec::new();
    files::open(path).and_then(|file| file.take(LONGEST + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
    if bytes.len() as u64 > LONGEST {
        return Err(RobotError::TooLarge {
            path: path.to_owned(),
            what: "MiB of text",
            limit: (LONGEST >> 20) as usize,
        });
    }
    let file = RobotFile::new(path, &bytes);
    let text = decoded(bytes).map_err(|NotText { line, encoding }| {
        let path = path.to_owned();
        RobotError::Encoding { path, line, encoding }
    })?;
    Ok(TextFile { text, file })
}

/// The text of a description, of at most 16 MiB.
#[doc(hidden)]
pub fn read_text(path: &Path) -> Result<String, RobotError> {
    read(path).map(|file| file.text)
}
