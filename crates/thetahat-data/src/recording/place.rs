//! Where a file may be: inside the folder of the data, whatever the description of a recording states.

use std::io;
use std::path::{Component, Path, PathBuf};

use super::error::RecordingError;
use thetahat_ground::files::{self, File};

/// The path of `file` inside `root`.
///
/// # Errors
/// [`RecordingError::OutsideData`] if the path is absolute, leaves the folder by `..`, or leads out of it by a link;
/// [`RecordingError::FileNotFound`] if there is no such file.
pub(super) fn inside(root: &Path, file: &Path) -> Result<PathBuf, RecordingError> {
    let path = root.join(file);
    let outside = || RecordingError::OutsideData { file: file.to_owned(), root: root.to_owned() };
    if !stays_below(file) {
        return Err(outside());
    }
    length(&path)?;
    let folder = if root.as_os_str().is_empty() { Path::new(".") } else { root };
    let real = |path: &Path| files::real(path).map_err(|e| unreadable(path, e));
    if real(&path)?.starts_with(real(folder)?) { Ok(path) } else { Err(outside()) }
}

/// Whether a path is relative and never leaves its starting folder.
fn stays_below(file: &Path) -> bool {
    let depth = file.components().try_fold(0_usize, |depth, component| match component {
        Component::Normal(_) => Some(depth + 1),
        Component::CurDir => Some(depth),
        Component::ParentDir => depth.checked_sub(1),
        Component::RootDir | Component::Prefix(_) => None,
    });
    depth.is_some()
}

/// All bytes of a file, which must not be empty.
pub(super) fn file_bytes(path: &Path) -> Result<Vec<u8>, RecordingError> {
    file_length(path)?;
    files::read(path).map_err(|e| unreadable(path, e))
}

/// A file opened for reading, which must not be empty.
pub(super) fn open(path: &Path) -> Result<File, RecordingError> {
    file_length(path)?;
    files::open(path).map_err(|e| unreadable(path, e))
}

/// The length in bytes of a file, which must not be empty.
pub(super) fn file_length(path: &Path) -> Result<u64, RecordingError> {
    match length(path)? {
        0 => Err(RecordingError::EmptyFile { file: path.to_owned() }),
        length => Ok(length),
    }
}

/// The length in bytes of an ordinary file, which may be empty.
fn length(path: &Path) -> Result<u64, RecordingError> {
    files::length(path).map_err(|e| unreadable(path, e))
}

pub(super) fn unreadable(path: &Path, source: io::Error) -> RecordingError {
    let file = path.to_owned();
    if matches!(source.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) {
        RecordingError::FileNotFound { file }
    } else {
        RecordingError::Unreadable { file, source }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use thetahat_testing::Folder;

    use super::*;

    fn folder() -> Folder {
        let folder = Folder::with("secret.csv", b"q\n1\n");
        fs::create_dir(folder.path().join("data")).unwrap();
        fs::write(folder.path().join("data/q.csv"), b"q\n1\n").unwrap();
        folder
    }

    fn refused(file: &Path) {
        let error = inside(&folder().path().join("data"), file).unwrap_err();
        assert!(matches!(error, RecordingError::OutsideData { .. }), "{error}");
    }

    #[test]
    fn file_of_the_folder() {
        let folder = folder();
        let root = folder.path().join("data");
        assert_eq!(inside(&root, Path::new("q.csv")).unwrap(), root.join("q.csv"));
        inside(folder.path(), Path::new("data/../data/q.csv")).unwrap();
    }

    #[test]
    fn absolute_path() {
        let folder = folder();
        refused(&folder.path().join("data/q.csv"));
    }

    #[test]
    fn path_that_leaves_by_its_parent() {
        refused(Path::new("../secret.csv"));
        refused(Path::new("../data/q.csv"));
    }

    #[test]
    fn path_that_leaves_is_refused_whether_or_not_the_file_exists() {
        refused(Path::new("../absent.csv"));
    }

    #[cfg(unix)]
    #[test]
    fn link_that_leaves() {
        let folder = folder();
        let root = folder.path().join("data");
        std::os::unix::fs::symlink(folder.path().join("secret.csv"), root.join("link.csv")).unwrap();
        let error = inside(&root, Path::new("link.csv")).unwrap_err();
        assert!(matches!(error, RecordingError::OutsideData { .. }), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn link_inside_the_folder() {
        let folder = folder();
        let root = folder.path().join("data");
        std::os::unix::fs::symlink("q.csv", root.join("link.csv")).unwrap();
        inside(&root, Path::new("link.csv")).unwrap();
    }

    #[test]
    fn folder_instead_of_a_file() {
        let folder = folder();
        assert!(matches!(inside(folder.path(), Path::new("data")), Err(RecordingError::Unreadable { .. })));
    }
}
