//! Files for the tests of this room: a folder that vanishes with the test, and MAT files written by hand.

use std::fs;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicUsize, Ordering};

static FOLDERS: AtomicUsize = AtomicUsize::new(0);

/// A folder of its own for one test, removed at its end.
pub(super) struct Folder(PathBuf);

impl Folder {
    /// A new folder with one file.
    pub(super) fn with(name: &str, bytes: &[u8]) -> Self {
        let number = FOLDERS.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("thetahat-recording-{}-{number}", process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join(name), bytes).unwrap();
        Self(folder)
    }

    pub(super) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const CLASS_CHAR: u32 = 4;
const CLASS_DOUBLE: u32 = 6;
const COMPLEX_FLAG: u32 = 0x0800;

/// The bytes of a MAT file of version 5, little endian, not compressed.
pub(super) struct MatBytes(Vec<u8>);

impl MatBytes {
    /// A file without variables.
    pub(super) fn new() -> Self {
        let mut bytes = b"MATLAB 5.0 MAT-file, written by a test".to_vec();
        bytes.resize(124, b' ');
        bytes.extend([0, 1, b'I', b'M']);
        Self(bytes)
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// Adds a real matrix of doubles, given column by column.
    pub(super) fn with(self, name: &str, size: &[u32], values: &[f64]) -> Self {
        self.variable(CLASS_DOUBLE, name, size, &part(DOUBLE, &doubles(values)))
    }

    /// Adds a complex matrix whose real and imaginary parts are the same.
    pub(super) fn with_complex(self, name: &str, size: &[u32], values: &[f64]) -> Self {
        let values = part(DOUBLE, &doubles(values)).repeat(2);
        self.variable(CLASS_DOUBLE | COMPLEX_FLAG, name, size, &values)
    }

    /// Adds a line of text.
    pub(super) fn with_text(self, name: &str, text: &str) -> Self {
        let letters: Vec<_> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        self.variable(CLASS_CHAR, name, &[1, text.len() as u32], &part(UINT16, &letters))
    }

    fn variable(mut self, flags: u32, name: &str, size: &[u32], values: &[u8]) -> Self {
        let flags = part(UINT32, &words(&[flags, 0]));
        let variable = [flags, part(INT32, &words(size)), part(INT8, name.as_bytes()), values.to_vec()].concat();
        self.0.extend(part(MATRIX, &variable));
        self
    }
}

fn part(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = words(&[kind, data.len() as u32]);
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}
