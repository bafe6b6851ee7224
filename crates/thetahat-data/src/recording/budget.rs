//! Limits the memory that a file may request: a small file cannot make the program allocate without bound.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::error::RecordingError;

/// Values allowed for any file, 128 MiB in double precision. A reader holds them up to five times: decompressed, decoded,
/// as columns, as a series, and once more while a vector grows.
const ANY_FILE: usize = 1 << 24;

/// The number of values that may still be read from a file: 16 million at first, or one for each byte of a larger file.
///
/// A file that is not compressed always fits. Recorded motion compresses by a factor below ten; a file that expands by more is damaged or
/// malicious.
pub(super) struct Budget {
    file: PathBuf,
    limit: usize,
    left: usize,
}

impl Budget {
    pub(super) fn of(file: &Path, file_bytes: u64) -> Self {
        let limit = usize::try_from(file_bytes).unwrap_or(usize::MAX / 8).max(ANY_FILE);
        Self { file: file.to_owned(), limit, left: limit }
    }

    /// Reserves the values of a block with these side lengths.
    pub(super) fn take(&mut self, what: &str, sides: &[usize]) -> Result<usize, RecordingError> {
        let values = sides.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
        match values {
            Some(values) if values <= self.left => {
                self.left -= values;
                Ok(values)
            }
            _ => Err(self.exceeded(what)),
        }
    }

    /// The bytes of a compressed part of the file, decompressed by `reader`, if they fit.
    pub(super) fn decompress(&self, what: &str, reader: impl Read) -> Result<Vec<u8>, DecompressError> {
        let limit = self.left.saturating_mul(8);
        let mut bytes = Vec::new();
        reader.take(limit as u64 + 1).read_to_end(&mut bytes).map_err(DecompressError::Damaged)?;
        if bytes.len() > limit {
            return Err(DecompressError::TooLarge(self.exceeded(what)));
        }
        Ok(bytes)
    }

    #[cfg(feature = "hdf5")]
    pub(super) fn left(&self) -> usize {
        self.left
    }

    pub(super) fn exceeded(&self, what: &str) -> RecordingError {
        RecordingError::TooLarge { file: self.file.clone(), what: what.to_owned(), limit: self.limit }
    }
}

/// Why a part could not be decompressed.
pub(super) enum DecompressError {
    Damaged(io::Error),
    TooLarge(RecordingError),
}

impl DecompressError {
    pub(super) fn at(self, file: &Path, what: &str) -> RecordingError {
        match self {
            Self::TooLarge(error) => error,
            Self::Damaged(error) => RecordingError::damaged(file, format!("{what}: {error}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_file_has_room_for_sixteen_million_values_in_all() {
        let mut budget = Budget::of(Path::new("q.npz"), 100);
        assert_eq!(budget.take("q", &[1 << 12, 1 << 12]).unwrap(), ANY_FILE);
        assert!(matches!(budget.take("dq", &[1]), Err(RecordingError::TooLarge { limit: ANY_FILE, .. })));
    }

    #[test]
    fn large_file_has_room_for_a_value_a_byte() {
        assert_eq!(Budget::of(Path::new("q.npz"), 1 << 30).take("q", &[1 << 30]).unwrap(), 1 << 30);
    }

    #[test]
    fn sides_beyond_all_counting() {
        let mut budget = Budget::of(Path::new("q.npz"), 100);
        assert!(matches!(budget.take("q", &[usize::MAX, 2]), Err(RecordingError::TooLarge { .. })));
    }

    #[test]
    fn part_that_expands_without_end() {
        let result = Budget::of(Path::new("q.npz"), 100).decompress("q", io::repeat(0));
        assert!(matches!(result, Err(DecompressError::TooLarge(_))));
    }
}
