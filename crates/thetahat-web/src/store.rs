//! Storage of the session's files: in memory in a page, and in a folder on systems with files.

use std::path::Path;

use crate::session::Outcome;

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub(crate) fn put(path: &Path, bytes: Vec<u8>) -> Outcome<()> {
    thetahat_ground::files::put(path, bytes);
    Ok(())
}

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub(crate) fn remove(path: &Path) -> Outcome<()> {
    thetahat_ground::files::remove(path);
    Ok(())
}

/// The beginning of a file.
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub(crate) fn beginning(path: &Path, most: usize) -> Outcome<Vec<u8>> {
    Ok(thetahat_ground::files::beginning(path, most)?)
}

#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
pub(crate) fn put(path: &Path, bytes: Vec<u8>) -> Outcome<()> {
    path.parent().map_or(Ok(()), std::fs::create_dir_all)?;
    Ok(std::fs::write(path, bytes)?)
}

#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
pub(crate) fn remove(path: &Path) -> Outcome<()> {
    Ok(std::fs::remove_file(path)?)
}

/// The beginning of a file.
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
pub(crate) fn beginning(path: &Path, most: usize) -> Outcome<Vec<u8>> {
    use std::io::Read;
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(most as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}
