use super::error::ReportError;
use crate::results::RobotSummary;

/// A robot as one JSON object; the units are SI.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered.
pub fn model_json(summary: &RobotSummary) -> Result<String, ReportError> {
    let text = serde_json::to_string_pretty(summary).map_err(|source| ReportError::ModelJson { source })?;
    Ok(text + "\n")
}
