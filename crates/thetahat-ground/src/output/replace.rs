//! Files written under random names next to their places, and renamed when all of them are whole and on the disk.
//!
//! A killed program leaves unfinished files. The next one that writes the same file removes them: who writes one holds a lock on it.

use std::{
    fs::{self, File},
    io::{self, Write},
    path::Path,
};

use tempfile::{Builder, NamedTempFile, TempDir};

use super::{TEMPORARY, WriteError, guard::folder_of};

/// Writes a file whole, or leaves what was there.
///
/// # Errors
/// The system's error.
pub fn replace_file(path: &Path, content: &[u8]) -> io::Result<()> {
    replace_files([(path, content)]).map_err(|error| error.source)
}

/// Writes files whole. None is replaced before all are on the disk.
///
/// # Errors
/// [`WriteError`] with the file.
pub fn replace_files<'f>(files: impl IntoIterator<Item = (&'f Path, &'f [u8])>) -> Result<(), WriteError> {
    let unfinished = |(path, content)| match write_unfinished(path, content) {
        Ok(file) => Ok((path, file)),
        Err(source) => Err(WriteError { path: path.to_owned(), source }),
    };
    let unfinished = files.into_iter().map(unfinished).collect::<Result<Vec<_>, _>>()?;
    let folders: Vec<&Path> = unfinished.iter().map(|(path, _)| folder_of(path)).collect();
    for (path, file) in unfinished {
        file.persist(path).map_err(|error| WriteError { path: path.to_owned(), source: error.error })?;
    }
    folders.into_iter().for_each(write_names);
    Ok(())
}

fn write_unfinished(path: &Path, content: &[u8]) -> io::Result<NamedTempFile> {
    if path.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?.to_string_lossy();
    let mut file = begun(folder_of(path), &name, |builder, folder| {
        let file = with_usual_permissions(builder).tempfile_in(folder)?;
        lock(file.as_file());
        Ok(file)
    })?;
    file.write_all(content)?;
    file.as_file().sync_all()?;
    Ok(file)
}

/// A folder of files that become visible together; it is removed when it is dropped.
pub struct UnfinishedFolder {
    folder: TempDir,
    /// Holds the lock.
    _handle: Option<File>,
}

impl UnfinishedFolder {
    /// A new one in an existing folder.
    ///
    /// # Errors
    /// The system's error.
    pub fn new(folder: &Path, name: &str) -> io::Result<Self> {
        begun(folder, name, |builder, folder| {
            let folder = builder.tempdir_in(folder)?;
            let handle = File::open(folder.path()).ok();
            handle.iter().for_each(lock);
            Ok(Self { folder, _handle: handle })
        })
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Makes an unfinished file or folder of a random name and removes those that killed programs left. The folder is locked meanwhile, so
/// that none is removed before its maker has locked it.
fn begun<T>(folder: &Path, name: &str, make: impl Fn(&Builder<'_, '_>, &Path) -> io::Result<T>) -> io::Result<T> {
    let locked = File::open(folder).and_then(|folder| folder.lock().map(|()| folder));
    let prefix = format!(".{name}.");
    if locked.is_ok() {
        remove_abandoned(folder, &prefix);
    }
    make(Builder::new().prefix(&prefix).suffix(&format!(".{TEMPORARY}")), folder)
}

/// A file system without locks writes all the same, and nothing is removed there.
fn lock(file: &File) {
    let _ = file.try_lock();
}

/// A folder that cannot be listed is written into all the same.
fn remove_abandoned(folder: &Path, prefix: &str) {
    for path in fs::read_dir(folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path())) {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let is_unfinished = name.starts_with(prefix) && path.extension().is_some_and(|e| e == TEMPORARY);
        if is_unfinished && !path.is_symlink() && is_abandoned(&path) {
            // It may be gone meanwhile.
            let _ = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
        }
    }
}

fn is_abandoned(path: &Path) -> bool {
    File::open(path).is_ok_and(|file| file.try_lock().is_ok())
}

/// Writes the names of a folder to the disk. A system that cannot do so has them in memory, as any program's.
fn write_names(folder: &Path) {
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

/// As of any new file, by the user's mask.
#[cfg(unix)]
fn with_usual_permissions<'a, 'b>(builder: &Builder<'a, 'b>) -> Builder<'a, 'b> {
    use std::os::unix::fs::PermissionsExt;
    let mut builder = builder.clone();
    builder.permissions(fs::Permissions::from_mode(0o666));
    builder
}

#[cfg(not(unix))]
fn with_usual_permissions<'a, 'b>(builder: &Builder<'a, 'b>) -> Builder<'a, 'b> {
    builder.clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let name = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name().to_string_lossy().into_owned();
        let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(name).collect();
        names.sort();
        names
    }

    #[test]
    fn what_a_killed_program_left_is_removed_and_what_another_writes_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let [abandoned, written] = [".a.csv.old.part", ".a.csv.new.part"].map(|name| folder.path().join(name));
        fs::write(&abandoned, "half").unwrap();
        fs::write(folder.path().join(".b.csv.old.part"), "of another file").unwrap();
        let writer = File::create(&written).unwrap();
        writer.lock().unwrap();
        replace_file(&path, b"whole").unwrap();
        assert_eq!(names(folder.path()), [".a.csv.new.part", ".b.csv.old.part", "a.csv"]);
        drop(writer);
        replace_file(&path, b"again").unwrap();
        assert_eq!(names(folder.path()), [".b.csv.old.part", "a.csv"]);
        assert_eq!(fs::read(&path).unwrap(), b"again");
    }

    #[test]
    fn no_file_is_replaced_where_one_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = ["a", "b"].map(|name| folder.path().join(name));
        fs::write(&first, "before").unwrap();
        fs::create_dir(&second).unwrap();
        let error = replace_files([(&*first, &b"after"[..]), (&*second, &b"after"[..])]).unwrap_err();
        assert_eq!((error.path, names(folder.path())), (second, vec!["a".to_owned(), "b".to_owned()]));
        assert_eq!(fs::read(&first).unwrap(), b"before");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_at_the_name_is_replaced_and_its_target_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let [target, link] = ["target", "link"].map(|name| folder.path().join(name));
        fs::write(&target, "kept").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        replace_file(&link, b"new").unwrap();
        assert_eq!((fs::read(&target).unwrap(), fs::read(&link).unwrap()), (b"kept".to_vec(), b"new".to_vec()));
    }

    #[cfg(unix)]
    #[test]
    fn a_new_file_has_the_permissions_of_any() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let [usual, ours] = ["usual", "ours"].map(|name| folder.path().join(name));
        fs::write(&usual, "").unwrap();
        replace_file(&ours, b"").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&usual), mode(&ours));
    }
}
