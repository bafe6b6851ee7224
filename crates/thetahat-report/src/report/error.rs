use std::{io, path::PathBuf};

use crate::results::ResultsError;
use thetahat_ground::output::WriteError;

/// Why a report cannot be written, or published figures cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The folder of the report cannot be made.
    #[error("{}: the folder cannot be made: {source}", path.display())]
    Directory {
        /// The folder.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A file of the report cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The output of a command cannot be written as JSON.
    #[error("the output as JSON: {source}")]
    PrintedJson {
        /// Why.
        source: serde_json::Error,
    },
    /// The results cannot be written as JSON.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The page's content cannot be rendered.
    #[error("the page: {source}")]
    Json {
        /// Why.
        source: serde_json::Error,
    },
    /// The parameters cannot be written as CSV.
    #[error("parameters.csv: {source}")]
    Csv {
        /// Why.
        source: csv::Error,
    },
    /// The page cannot be rendered.
    #[error("report.html: {source}")]
    Html {
        /// Why.
        source: minijinja::Error,
    },
    /// The file of published figures cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    PublishedUnreadable {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A line of the published figures is not of the expected form.
    #[error("{}: line {line}: expected {expected}, found {found:?}", path.display())]
    PublishedLine {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The expected value.
        expected: String,
        /// The value found.
        found: String,
    },
}

impl From<WriteError> for ReportError {
    fn from(WriteError { path, source }: WriteError) -> Self {
        Self::Write { path, source }
    }
}
