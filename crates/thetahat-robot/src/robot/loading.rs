//! Descriptions from their files, with xacro expanded.

use std::path::{Path, PathBuf};

use super::{
    error::RobotError,
    text_file::{self, RobotFile, TextFile},
    xacro::{ExpandedXacro, XacroOptions, expand_xacro},
};

/// A description as it is parsed.
pub(super) struct Loaded {
    pub(super) text: String,
    /// The files that were read, the description first.
    pub(super) files: Vec<RobotFile>,
    /// Their paths.
    pub(super) paths: Vec<PathBuf>,
    /// Whether the text is that of an expanded xacro.
    pub(super) is_expanded: bool,
}

/// The description at `path`; a xacro is expanded.
pub(super) fn load(path: &Path, options: &XacroOptions) -> Result<Loaded, RobotError> {
    let TextFile { text, file } = text_file::read(path)?;
    if !is_xacro(path, &text) {
        return Ok(Loaded { text, files: vec![file], paths: vec![path.to_owned()], is_expanded: false });
    }
    let ExpandedXacro { text, files, paths } = expand_xacro(path, options)?;
    Ok(Loaded { text, files, paths, is_expanded: true })
}

/// Whether a file is to be expanded. One that only declares the namespace has been expanded before.
fn is_xacro(path: &Path, text: &str) -> bool {
    let named = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("xacro"));
    let uses = || text.contains("<xacro:") || text.contains("${");
    named
        || (text.trim_start_matches('\u{feff}').trim_start().starts_with('<') && text.contains("xmlns:xacro") && uses())
}

/// The name of an expansion in messages, as its lines are not those of the file.
pub(super) fn expanded_name(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(" (expanded)");
    PathBuf::from(name)
}
