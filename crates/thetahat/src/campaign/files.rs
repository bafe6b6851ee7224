use std::path::Path;

use super::error::CampaignError;
use thetahat_ground::output;

/// Writes a file, whole or not at all.
pub(super) fn replace_file(path: &Path, content: &[u8]) -> Result<(), CampaignError> {
    output::replace_file(path, content).map_err(|e| refuse(path, &e))
}

pub(super) fn refuse(path: &Path, reason: &dyn std::error::Error) -> CampaignError {
    CampaignError::Write { path: path.to_owned(), reason: reason.to_string() }
}
