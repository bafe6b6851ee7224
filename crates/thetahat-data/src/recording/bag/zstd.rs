//! Zstandard, as rosbag2 compresses whole files or single messages.

use std::io::{self, Read};
use std::path::Path;

use super::super::error::RecordingError;
use super::super::place::{file_length, open};

/// The first bytes of compressed data; no message begins so.
const MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// Decompressed bytes that any file may contain, and the number for each byte of a larger file.
const ANY_FILE: u64 = 1 << 28;
const EXPANSION: u64 = 32;

pub(super) fn is_compressed(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// Whether the name of a file says that it is compressed as a whole.
pub(super) fn is_compressed_file(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("zstd") || extension.eq_ignore_ascii_case("zst"))
}

/// The decompressed bytes; none if there are more than `limit`. Memory grows with the bytes that come, not with the size that they state.
pub(super) fn decompress(
    bytes: impl Read,
    limit: u64,
    path: &Path,
    what: &str,
) -> Result<Option<Vec<u8>>, RecordingError> {
    let damaged = |e: std::io::Error| RecordingError::damaged(path, format!("{what}: Zstandard: {e}"));
    let mut decompressed = Vec::new();
    let reader = ::zstd::stream::read::Decoder::new(bytes).map_err(damaged)?;
    reader.take(limit.saturating_add(1)).read_to_end(&mut decompressed).map_err(damaged)?;
    Ok((decompressed.len() as u64 <= limit).then_some(decompressed))
}

/// A file that was compressed as a whole, opened for reading.
pub(super) fn open_file(path: &Path) -> Result<impl Read, RecordingError> {
    ::zstd::stream::read::Decoder::new(open(path)?).map_err(|e| damaged_file(path, e))
}

/// The error for a compressed file that cannot be read on.
pub(super) fn damaged_file(path: &Path, error: io::Error) -> RecordingError {
    RecordingError::damaged(path, format!("Zstandard: {error}"))
}

/// The bytes of a file that was compressed as a whole.
pub(super) fn decompress_file(path: &Path) -> Result<Vec<u8>, RecordingError> {
    let limit = ANY_FILE.max(file_length(path)?.saturating_mul(EXPANSION));
    decompress(open(path)?, limit, path, "the file")?.ok_or_else(|| RecordingError::TooLarge {
        file: path.to_owned(),
        what: "the decompressed file".to_owned(),
        limit: (limit / 8) as usize,
    })
}
