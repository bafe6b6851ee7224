//! JSON output of commands.

use serde::Serialize;

use super::error::ReportError;
use crate::results::{RecordingFindings, RobotSummary};

/// A robot as one JSON object; the units are SI.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered.
pub fn model_json(summary: &RobotSummary) -> Result<String, ReportError> {
    rendered(summary)
}

/// The findings of every recording as one JSON array.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered.
pub fn findings_json(recordings: &[RecordingFindings]) -> Result<String, ReportError> {
    rendered(recordings)
}

fn rendered(content: &(impl Serialize + ?Sized)) -> Result<String, ReportError> {
    let text = serde_json::to_string_pretty(content).map_err(|source| ReportError::PrintedJson { source })?;
    Ok(text + "\n")
}
