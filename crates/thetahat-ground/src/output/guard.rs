//! Which files a command may replace.

use std::{
    fs::{self, File, Metadata},
    io::{self, Read},
    path::{Path, PathBuf},
};

use super::{
    error::OutputError,
    kind::{FileKind, HEAD, PROPOSAL, names_another_robot},
};

/// Refuses to replace files that a command must not replace.
#[derive(Debug, Clone, Default)]
pub struct OutputGuard {
    inputs: Vec<PathBuf>,
    force: bool,
    robot: Option<String>,
}

impl OutputGuard {
    /// `inputs` are never replaced; files of other programs, and of other kinds than the written one, only with `force`.
    #[must_use]
    pub fn new(inputs: impl IntoIterator<Item = PathBuf>, force: bool) -> Self {
        Self { inputs: inputs.into_iter().filter_map(|path| path.canonicalize().ok()).collect(), force, robot: None }
    }

    /// The same for results of a robot: those of another one are replaced only with `force`.
    #[must_use]
    pub fn of_robot(self, robot: &str) -> Self {
        Self { robot: Some(robot.to_owned()), ..self }
    }

    /// Checks that a file of a kind can be written here.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn file(&self, path: &Path, kind: FileKind) -> Result<(), OutputError> {
        let folder = folder_of(path);
        if !folder.is_dir() {
            return Err(OutputError::NoFolder { path: folder.to_owned() });
        }
        if let Ok(target) = fs::read_link(path) {
            return Err(OutputError::IsLink { path: path.to_owned(), target });
        }
        let Ok(metadata) = fs::metadata(path) else { return Ok(()) };
        if !metadata.is_file() {
            return Err(OutputError::NotAFile { path: path.to_owned(), found: in_words(&metadata) });
        }
        if path.canonicalize().is_ok_and(|real| self.inputs.contains(&real)) {
            return Err(OutputError::IsInput { path: path.to_owned() });
        }
        if self.force { Ok(()) } else { self.replaceable(path, kind) }
    }

    /// Checks that the content of a file is one that the command replaces.
    fn replaceable(&self, path: &Path, kind: FileKind) -> Result<(), OutputError> {
        let path_of = || path.to_owned();
        let head = head(path).map_err(|source| OutputError::Unreadable { path: path_of(), source })?;
        if head.starts_with(PROPOSAL.as_bytes()) {
            return Err(OutputError::MayHoldChanges { path: path_of() });
        }
        if !kind.is_kind_of(&head) {
            return Err(OutputError::NotOurs { path: path_of() });
        }
        match &self.robot {
            Some(robot) if names_another_robot(&head, robot) => {
                Err(OutputError::OfAnotherRobot { path: path_of(), robot: robot.clone() })
            }
            Some(_) | None => Ok(()),
        }
    }

    /// Checks that files of these names and kinds can be written into a folder, which need not exist.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn folder<'n>(
        &self,
        folder: &Path,
        files: impl IntoIterator<Item = (&'n str, FileKind)>,
    ) -> Result<(), OutputError> {
        let there = folder.ancestors().filter(|path| !path.as_os_str().is_empty()).find(|path| path.exists());
        if let Some(path) = there.filter(|path| !path.is_dir()) {
            let found = fs::metadata(path).map_or("a file", |m| in_words(&m));
            return Err(OutputError::NotAFolder { path: path.to_owned(), found });
        }
        if there != Some(folder) {
            return Ok(());
        }
        files.into_iter().try_for_each(|(name, kind)| self.file(&folder.join(name), kind))
    }
}

/// Removes a file if it is of a kind that this program wrote. Returns whether a file was removed.
///
/// # Errors
/// The system's error.
pub fn remove_own(path: &Path, kind: FileKind) -> io::Result<bool> {
    let is_there = path.is_file() && kind.is_kind_of(&head(path)?);
    if is_there {
        fs::remove_file(path)?;
    }
    Ok(is_there)
}

/// The folder of a file.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn head(path: &Path) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    Ok(head)
}

fn in_words(metadata: &Metadata) -> &'static str {
    match (metadata.is_file(), metadata.is_dir()) {
        (true, _) => "a file",
        (_, true) => "a folder",
        (false, false) => "a pipe or a device",
    }
}
