//! Prepares the text of a file for the `csv` crate.

use std::borrow::Cow;
use std::path::Path;

use csv::{ByteRecord, Reader, ReaderBuilder};

use super::super::error::RecordingError;

/// The characters of a cell: UTF-8, or otherwise Latin-1, as spreadsheets write `°` in many countries.
pub(super) fn characters(cell: &[u8]) -> String {
    str::from_utf8(cell).map_or_else(|_| cell.iter().map(|&byte| char::from(byte)).collect(), str::to_owned)
}

/// Text from the first line that is neither empty nor a comment.
pub(super) struct Text<'a> {
    body: &'a [u8],
    /// Number of lines before the body.
    skipped: u64,
}

impl<'a> Text<'a> {
    pub(super) fn of(bytes: &'a [u8], path: &Path) -> Result<Self, RecordingError> {
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            return Err(RecordingError::damaged(path, "the text is in UTF-16; save it as UTF-8".to_owned()));
        }
        let mut text = Self { body: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), skipped: 0 };
        while let Some(end) = text.end_of_remark() {
            text.body = &text.body[end..];
            text.skipped += 1;
        }
        if text.body.is_empty() {
            return Err(RecordingError::EmptyFile { file: path.to_owned() });
        }
        Ok(text)
    }

    /// The end of the first line, if it is empty or a comment.
    fn end_of_remark(&self) -> Option<usize> {
        let end = self.body.iter().position(|&b| b == b'\n').map_or(self.body.len(), |newline| newline + 1);
        let line = self.body[..end].trim_ascii();
        let remark = end > 0 && (line.is_empty() || line.starts_with(b"#") || line.starts_with(b"%"));
        remark.then_some(end)
    }

    /// The first bytes of the text, up to the end of a line.
    pub(super) fn beginning(&self, bytes: usize) -> Text<'a> {
        let cut = self.body.get(..bytes).and_then(|start| start.iter().rposition(|&b| b == b'\n'));
        Text { body: cut.map_or(self.body, |newline| &self.body[..=newline]), skipped: self.skipped }
    }

    /// Where the body begins in the original bytes: the byte, and the line from 1.
    pub(super) fn start(&self, bytes: &[u8]) -> (u64, u64) {
        ((bytes.len() - self.body.len()) as u64, self.skipped + 1)
    }

    /// The text prepared for the reader of rows: with the space as delimiter, runs of spaces become one.
    pub(super) fn prepared(&self, delimiter: u8) -> Cow<'a, [u8]> {
        if delimiter == b' ' { Cow::Owned(single_spaces(self.body)) } else { Cow::Borrowed(self.body) }
    }

    /// The line in the file on which a row begins, counted from 1.
    pub(super) fn line(&self, row: &ByteRecord) -> u64 {
        self.skipped + row.position().map_or(0, csv::Position::line)
    }
}

/// A reader of rows of any length.
pub(super) fn rows(prepared: &[u8], delimiter: u8) -> Reader<&[u8]> {
    ReaderBuilder::new().flexible(true).has_headers(false).delimiter(delimiter).from_reader(prepared)
}

/// The text without spaces at the beginnings and ends of lines, and with each run of spaces reduced to one.
fn single_spaces(text: &[u8]) -> Vec<u8> {
    let mut single = Vec::with_capacity(text.len());
    let mut space = false;
    for &byte in text {
        match byte {
            b' ' => space = true,
            b'\n' | b'\r' => {
                space = false;
                single.push(byte);
            }
            _ => {
                let begins = single.last().is_none_or(|last| matches!(last, b'\n' | b'\r'));
                if space && !begins {
                    single.push(b' ');
                }
                space = false;
                single.push(byte);
            }
        }
    }
    single
}
