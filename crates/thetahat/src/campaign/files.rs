use std::{fs, io, path::Path};

use super::error::CampaignError;

/// Extension of files that are being written.
pub(super) const TEMPORARY: &str = "part";

/// Writes under a temporary name and renames: the file is there as a whole, or as it was.
pub(super) fn replace_file(path: &Path, content: &[u8]) -> Result<(), CampaignError> {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let temporary = path.with_file_name(format!(".{name}.{}.{TEMPORARY}", std::process::id()));
    let written: io::Result<()> = fs::write(&temporary, content).and_then(|()| fs::rename(&temporary, path));
    written.map_err(|e| {
        let _ = fs::remove_file(&temporary);
        refuse(path, &e)
    })
}

pub(super) fn refuse(path: &Path, reason: &dyn std::error::Error) -> CampaignError {
    CampaignError::Write { path: path.to_owned(), reason: reason.to_string() }
}
