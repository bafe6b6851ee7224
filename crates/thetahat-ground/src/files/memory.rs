//! Files in memory, in one folder and its subfolders: paths are relative to it, and there are no links.

use std::{
    collections::BTreeMap,
    io::{self, Cursor},
    path::{Component, Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

static FILES: Mutex<BTreeMap<PathBuf, Content>> = Mutex::new(BTreeMap::new());

/// The bytes of a file, shared with those who read it.
#[derive(Clone)]
pub struct Content(Arc<Vec<u8>>);

impl AsRef<[u8]> for Content {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

/// A file opened for reading.
pub type File = Cursor<Content>;

/// Puts a file into memory; it replaces one of the same path.
pub fn put(path: &Path, bytes: Vec<u8>) {
    files().insert(resolved(path), Content(Arc::new(bytes)));
}

/// Removes a file, if it is there.
pub fn remove(path: &Path) {
    files().remove(&resolved(path));
}

/// The files with their sizes in bytes, in the order of their paths.
#[must_use]
pub fn sizes() -> Vec<(PathBuf, usize)> {
    files().iter().map(|(path, content)| (path.clone(), content.0.len())).collect()
}

/// The first bytes of a file, `most` at most.
///
/// # Errors
/// A file that is not there.
pub fn beginning(path: &Path, most: usize) -> io::Result<Vec<u8>> {
    content(path).map(|content| content.0[..content.0.len().min(most)].to_vec())
}

/// All bytes of a file.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    content(path).map(|content| content.0.to_vec())
}

/// A file opened for reading.
pub fn open(path: &Path) -> io::Result<File> {
    content(path).map(Cursor::new)
}

/// The length in bytes of a file.
pub fn length(path: &Path) -> io::Result<u64> {
    if is_folder(&resolved(path)) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a folder"));
    }
    content(path).map(|content| content.0.len() as u64)
}

/// The path of an existing file or folder, without `.` and `..`.
pub fn real(path: &Path) -> io::Result<PathBuf> {
    if exists(path) { Ok(resolved(path)) } else { Err(not_found()) }
}

/// Whether there is a file or a folder.
pub fn exists(path: &Path) -> bool {
    is_file(path) || is_folder(&resolved(path))
}

/// Whether there is a file.
pub fn is_file(path: &Path) -> bool {
    files().contains_key(&resolved(path))
}

fn content(path: &Path) -> io::Result<Content> {
    files().get(&resolved(path)).cloned().ok_or_else(not_found)
}

fn is_folder(resolved: &Path) -> bool {
    resolved.as_os_str().is_empty() || files().keys().any(|file| file != resolved && file.starts_with(resolved))
}

/// Resolves a path from the outermost folder, which is its own parent like the root of a file system.
fn resolved(path: &Path) -> PathBuf {
    let mut resolved = PathBuf::new();
    for component in path.components() {
        match component {
            Component::Normal(name) => resolved.push(name),
            Component::ParentDir => {
                resolved.pop();
            }
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    resolved
}

fn not_found() -> io::Error {
    io::Error::new(io::ErrorKind::NotFound, "there is no such file")
}

fn files() -> MutexGuard<'static, BTreeMap<PathBuf, Content>> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Seek, SeekFrom};

    use super::*;

    #[test]
    fn what_is_put_is_read_until_it_is_removed() {
        let path = Path::new("kept/q.csv");
        put(path, b"q\n1\n".to_vec());
        assert_eq!(read(path).unwrap(), b"q\n1\n");
        assert_eq!((length(path).unwrap(), is_file(path)), (4, true));
        assert_eq!((beginning(path, 2).unwrap(), beginning(path, 9).unwrap()), (b"q\n".to_vec(), b"q\n1\n".to_vec()));
        assert!(sizes().contains(&(path.to_owned(), 4)));
        put(path, b"q\n".to_vec());
        assert_eq!(length(path).unwrap(), 2);
        remove(path);
        assert_eq!(read(path).unwrap_err().kind(), io::ErrorKind::NotFound);
    }

    #[test]
    fn an_open_file_keeps_its_content() {
        let path = Path::new("open/q.csv");
        put(path, b"0123456789".to_vec());
        let mut file = open(path).unwrap();
        remove(path);
        let mut end = String::new();
        file.seek(SeekFrom::Start(7)).unwrap();
        file.read_to_string(&mut end).unwrap();
        assert_eq!(end, "789");
    }

    #[test]
    fn folders_are_where_files_are() {
        put(Path::new("robots/arm.urdf"), b"<robot/>".to_vec());
        assert!(exists(Path::new("")) && exists(Path::new(".")) && exists(Path::new("robots")));
        assert!(!exists(Path::new("robot")) && !is_file(Path::new("robots")));
        assert_eq!(length(Path::new("robots")).unwrap_err().kind(), io::ErrorKind::InvalidInput);
    }

    #[test]
    fn paths_are_resolved() {
        put(Path::new("data/t.csv"), b"t".to_vec());
        for path in ["./data/t.csv", "data/../data/./t.csv", "../data/t.csv", "/data/t.csv"] {
            assert_eq!(real(Path::new(path)).unwrap(), Path::new("data/t.csv"), "{path}");
        }
        assert!(real(Path::new("data/absent.csv")).is_err());
    }
}
