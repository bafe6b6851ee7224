//! Locks between programs.

use std::{
    fs::{File, TryLockError},
    io,
    path::Path,
    sync::Arc,
};

/// The lock of a file, held until the last clone is dropped. A file system without locks has none, and every program holds it.
#[derive(Debug, Clone)]
pub struct FileLock {
    _file: Arc<File>,
}

impl FileLock {
    /// The lock of an existing file; none if another program holds it.
    ///
    /// # Errors
    /// A file that cannot be opened.
    pub fn of(path: &Path) -> io::Result<Option<Self>> {
        let file = File::open(path)?;
        Ok(match file.try_lock() {
            Err(TryLockError::WouldBlock) => None,
            Ok(()) | Err(TryLockError::Error(_)) => Some(Self { _file: Arc::new(file) }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_is_held_by_one_until_its_last_clone_is_dropped() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let lock = FileLock::of(file.path()).unwrap().unwrap();
        let clone = lock.clone();
        drop(lock);
        assert!(FileLock::of(file.path()).unwrap().is_none());
        drop(clone);
        assert!(FileLock::of(file.path()).unwrap().is_some());
    }
}
