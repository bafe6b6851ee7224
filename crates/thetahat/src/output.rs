//! Where files may be written: never over an input or a device, and over files of others only when forced.
//!
//! Every file of this program is known again by its first bytes.

use std::{
    fs::{self, File, Metadata},
    io::{self, Read},
    path::{Path, PathBuf},
};

/// What files of this program have among their first bytes.
const MARKS: [&[u8]; 14] = [
    b"\"thetahat\": \"",
    b"\"thetahat\":\"",
    b"<meta name=\"generator\" content=\"thetahat\">",
    b".TH thetahat",
    b"thetahat reduction ",
    b"case,method,name,estimate,standard_deviation,",
    b"error,value,method,status,relative_error_percent,rms_change_sd",
    b"time_s,predicted_1",
    RECORD.as_bytes(),
    TRAJECTORY.as_bytes(),
    b"# thetahat trajectory",
    b"# thetahat design",
    b"promised,a_priori,",
    EXPORT.as_bytes(),
];

/// How a simulated record begins: the quotes tell it from a record of others with the same columns, and no reader sees them.
pub(crate) const RECORD: &str = "time_s,\"position_1\"";

/// How a designed trajectory begins, likewise.
pub(crate) const TRAJECTORY: &str = "time_s,\"q_1\"";

/// How the comment of an exported robot begins.
pub(crate) const EXPORT: &str = "thetahat export ";

/// First bytes among which a mark stands.
const HEAD: u64 = 512;

/// Why a file is not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The file is read by the same command.
    #[error("{}: the command reads this file; give another file or folder with --out", path.display())]
    IsInput {
        /// The file.
        path: PathBuf,
    },
    /// Something else than a file is there.
    #[error("{}: expected a file, found {found}; give the name of a file with --out", path.display())]
    NotAFile {
        /// The place.
        path: PathBuf,
        /// A folder, a pipe or a device.
        found: &'static str,
    },
    /// Something else than a folder is there.
    #[error("{}: expected a folder, found {found}; give another folder with --out", path.display())]
    NotAFolder {
        /// The place.
        path: PathBuf,
        /// A file, a pipe or a device.
        found: &'static str,
    },
    /// There is no folder for the file.
    #[error("{}: there is no such folder; make it, or choose another file", path.display())]
    NoFolder {
        /// The folder.
        path: PathBuf,
    },
    /// A file is there that this program did not write.
    #[error(
        "{}: is there already and not known to be written by thetahat; give another place with --out, or replace it \
         with --force",
        path.display()
    )]
    NotOurs {
        /// The file.
        path: PathBuf,
    },
    /// What is there cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// What a command must not replace.
#[derive(Debug, Clone, Default)]
pub struct OutputGuard {
    inputs: Vec<PathBuf>,
    force: bool,
}

impl OutputGuard {
    /// Files that the command reads are never replaced, files of others with `force` only.
    #[must_use]
    pub fn new(inputs: impl IntoIterator<Item = PathBuf>, force: bool) -> Self {
        Self { inputs: inputs.into_iter().filter_map(|path| path.canonicalize().ok()).collect(), force }
    }

    /// Checks that a file can be written here.
    ///
    /// # Errors
    /// [`OutputError`], with the remedy.
    pub fn file(&self, path: &Path) -> Result<(), OutputError> {
        let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(OutputError::NoFolder { path: folder.to_owned() });
        }
        let Ok(metadata) = fs::metadata(path) else { return Ok(()) };
        if !metadata.is_file() {
            return Err(OutputError::NotAFile { path: path.to_owned(), found: kind(&metadata) });
        }
        if path.canonicalize().is_ok_and(|real| self.inputs.contains(&real)) {
            return Err(OutputError::IsInput { path: path.to_owned() });
        }
        let unreadable = |source| OutputError::Unreadable { path: path.to_owned(), source };
        if self.force || is_own(path).map_err(unreadable)? {
            return Ok(());
        }
        Err(OutputError::NotOurs { path: path.to_owned() })
    }

    /// Checks that files of these names can be written into a folder, which need not be there.
    ///
    /// # Errors
    /// [`OutputError`], with the remedy.
    pub fn folder<'n>(&self, folder: &Path, names: impl IntoIterator<Item = &'n str>) -> Result<(), OutputError> {
        let there = folder.ancestors().filter(|path| !path.as_os_str().is_empty()).find(|path| path.exists());
        if let Some(path) = there.filter(|path| !path.is_dir()) {
            let found = fs::metadata(path).map_or("a file", |m| kind(&m));
            return Err(OutputError::NotAFolder { path: path.to_owned(), found });
        }
        if there != Some(folder) {
            return Ok(());
        }
        names.into_iter().try_for_each(|name| self.file(&folder.join(name)))
    }
}

/// Whether this program wrote a file.
fn is_own(path: &Path) -> io::Result<bool> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    Ok(MARKS.iter().any(|mark| memchr::memmem::find(&head, mark).is_some()))
}

/// What is at a place, in words.
fn kind(metadata: &Metadata) -> &'static str {
    match (metadata.is_file(), metadata.is_dir()) {
        (true, _) => "a file",
        (_, true) => "a folder",
        (false, false) => "a pipe or a device",
    }
}

/// Writes under a temporary name beside the file and renames: the file is there as a whole, or as it was.
///
/// # Errors
/// What the system says.
pub fn replace_file(path: &Path, content: &[u8]) -> io::Result<()> {
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?.to_string_lossy();
    if path.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    let temporary = path.with_file_name(format!(".{name}.{}.{TEMPORARY}", std::process::id()));
    let written = fs::write(&temporary, content).and_then(|()| fs::rename(&temporary, path));
    if written.is_err() {
        // Where there is no temporary file, nothing is to be taken away.
        let _ = fs::remove_file(&temporary);
    }
    written
}

/// Extension of files that are being written.
pub(crate) const TEMPORARY: &str = "part";
