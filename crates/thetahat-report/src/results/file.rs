//! Reading and writing `results.json`.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::content::{Results, SCHEMA};
use thetahat_ground::files;

/// Why a `results.json` cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is not JSON of the expected form.
    #[error(
        "{}: is not the results.json of an identification: {source}; give one that an identification wrote",
        path.display()
    )]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line and column.
        source: serde_json::Error,
    },
    /// A later version of this program wrote the file.
    #[error(
        "{}: has schema {found}, and this version of thetahat reads schemas up to {supported}; update thetahat, or \
         identify again with this version",
        path.display()
    )]
    NewerSchema {
        /// The file.
        path: PathBuf,
        /// The schema of the file.
        found: u64,
        /// The largest schema that can be read.
        supported: u32,
    },
    /// The results have no form in JSON.
    #[error("results.json: {source}")]
    Unwritable {
        /// Why.
        source: serde_json::Error,
    },
}

/// The one key that every schema has; a file without it is of schema 0.
#[derive(Deserialize)]
struct SchemaKey {
    #[serde(default)]
    schema: u64,
}

impl Results {
    /// The results in a `results.json`.
    ///
    /// # Errors
    /// [`ResultsError`] for a file that cannot be read, is not of the expected form or has a larger schema than [`SCHEMA`].
    pub fn read(path: &Path) -> Result<Self, ResultsError> {
        let text =
            files::read_to_string(path).map_err(|source| ResultsError::Unreadable { path: path.to_owned(), source })?;
        Self::from_json(path, &text)
    }

    /// The results in the text of a `results.json`; `path` names it in errors.
    ///
    /// # Errors
    /// [`ResultsError`] for a text that is not of the expected form or has a larger schema than [`SCHEMA`].
    pub fn from_json(path: &Path, text: &str) -> Result<Self, ResultsError> {
        let malformed = |source| ResultsError::Malformed { path: path.to_owned(), source };
        // The schema comes first: what a later one holds need not be of the form of this one.
        let SchemaKey { schema } = serde_json::from_str(text).map_err(malformed)?;
        if schema > SCHEMA.into() {
            return Err(ResultsError::NewerSchema { path: path.to_owned(), found: schema, supported: SCHEMA });
        }
        serde_json::from_str(text).map_err(malformed)
    }

    /// The text of `results.json`.
    ///
    /// # Errors
    /// [`ResultsError::Unwritable`] where JSON has no form for a value.
    pub fn to_json(&self) -> Result<String, ResultsError> {
        let text = serde_json::to_string_pretty(self).map_err(|source| ResultsError::Unwritable { source })?;
        Ok(text + "\n")
    }
}
