//! Temporary folders.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

/// A new, empty folder, removed when it goes out of scope.
pub struct Folder(TempDir);

impl Default for Folder {
    fn default() -> Self {
        Self::new()
    }
}

impl Folder {
    /// A new folder.
    #[must_use]
    pub fn new() -> Self {
        Self(TempDir::with_prefix("thetahat-").expect("a temporary folder can be made"))
    }

    /// A new folder with one file.
    #[must_use]
    pub fn with(file: &str, content: impl AsRef<[u8]>) -> Self {
        let folder = Self::new();
        folder.write(file, content);
        folder
    }

    /// The path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// The path of a file in it.
    #[must_use]
    pub fn at(&self, file: impl AsRef<Path>) -> PathBuf {
        self.path().join(file)
    }

    /// Writes a file and creates its parent folders.
    pub fn write(&self, file: impl AsRef<Path>, content: impl AsRef<[u8]>) -> &Self {
        let path = self.at(file);
        path.parent()
            .map_or(Ok(()), fs::create_dir_all)
            .and_then(|()| fs::write(&path, content))
            .expect("it is writable");
        self
    }

    /// Copies a file into the folder under its own name.
    pub fn copy(&self, file: &Path) -> &Self {
        let name = file.file_name().expect("a file has a name");
        self.write(name, fs::read(file).unwrap_or_else(|e| panic!("{}: {e}", file.display())))
    }

    /// The bytes of a file in it.
    #[must_use]
    pub fn bytes(&self, file: impl AsRef<Path>) -> Vec<u8> {
        let path = self.at(file);
        fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    }

    /// The text of a file in it.
    #[must_use]
    pub fn text(&self, file: impl AsRef<Path>) -> String {
        String::from_utf8(self.bytes(file)).expect("the file is text")
    }

    /// A JSON file in it.
    #[must_use]
    pub fn json(&self, file: impl AsRef<Path>) -> Value {
        serde_json::from_slice(&self.bytes(file)).expect("the file is JSON")
    }

    /// Writes `file` to `out` with the first `from` replaced; `from` must occur.
    pub fn replace(&self, file: &str, from: &str, to: &str, out: &str) {
        let text = self.text(file);
        assert!(text.contains(from), "{file} holds no {from:?}");
        self.write(out, text.replacen(from, to, 1));
    }
}
