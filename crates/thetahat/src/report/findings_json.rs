use super::error::ReportError;
use crate::results::RecordingFindings;

/// The findings of every recording as one JSON array.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered.
pub fn findings_json(recordings: &[RecordingFindings]) -> Result<String, ReportError> {
    let text = serde_json::to_string_pretty(recordings).map_err(|source| ReportError::ModelJson { source })?;
    Ok(text + "\n")
}
