//! A text that grows: its beginning shows the dialect, complete lines are read as they come.

use std::path::{Path, PathBuf};

use super::super::error::RecordingError;
use super::super::table::{RequestedColumns, Table};
use super::dialect::{Detected, Dialect};
use super::read::read_columns;
use super::text::without_mark;
use memchr::{memchr_iter, memrchr};

/// Lines from which the dialect is detected.
const LINES: usize = 20;

/// A text of which more and more is known.
pub(in super::super) struct TextStream {
    path: PathBuf,
    dialect: Dialect,
    detected: Option<Detected>,
    /// Bytes that are not read yet.
    waiting: Vec<u8>,
}

impl TextStream {
    pub(in super::super) fn new(path: &Path, dialect: Dialect) -> Self {
        Self { path: path.to_owned(), dialect, detected: None, waiting: Vec::new() }
    }

    /// Takes bytes and reads the complete lines; `None` until the dialect is known, or without a complete line. At the end, a line
    /// without its end is complete.
    pub(in super::super) fn read(
        &mut self,
        bytes: &[u8],
        is_end: bool,
        wanted: RequestedColumns<'_>,
    ) -> Result<Option<Table>, RecordingError> {
        self.waiting.extend_from_slice(bytes);
        if is_end && !self.waiting.is_empty() && !self.waiting.ends_with(b"\n") {
            self.waiting.push(b'\n');
        }
        let Some(last) = memrchr(b'\n', &self.waiting) else { return Ok(None) };
        if self.detected.is_none() && !is_end && memchr_iter(b'\n', &self.waiting).count() < LINES {
            return Ok(None);
        }
        let lines: Vec<u8> = self.waiting.drain(..=last).collect();
        let text = if self.detected.is_none() { without_mark(&lines) } else { &lines };
        let mut detected = match self.detected.take() {
            Some(detected) => Detected { start: 0, ..detected },
            None => self.dialect.detect(text, &self.path)?,
        };
        let count = memchr_iter(b'\n', &text[detected.start..]).count() as u64;
        let table = if text[detected.start..].trim_ascii().is_empty() {
            None
        } else {
            let (columns, numbers, _) = read_columns(text, &self.path, &self.dialect, &detected, wanted)?;
            detected.numbers = numbers;
            Some(Table { name: String::new(), columns })
        };
        detected.line += count;
        self.detected = Some(detected);
        Ok(table)
    }
}
