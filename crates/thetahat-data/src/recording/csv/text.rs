//! Lines, rows and cells of a text, and its preparation for the `csv` crate.

use std::borrow::Cow;
use std::io;
use std::path::Path;

use csv::{ByteRecord, Reader, ReaderBuilder};
use memchr::memchr2;

use super::super::error::RecordingError;

/// Most columns of a text: a line with more is a matrix with channels in rows.
pub(super) const MOST_COLUMNS: usize = 10_000;
/// Most lines of a row whose cells in quotation marks contain ends of lines.
const MOST_LINES_OF_ROW: usize = 8;

/// The characters of a cell: UTF-8, or otherwise Latin-1, as spreadsheets write `°` in many countries.
pub(super) fn characters(cell: &[u8]) -> String {
    str::from_utf8(cell).map_or_else(|_| cell.iter().map(|&byte| char::from(byte)).collect(), str::to_owned)
}

/// Whether a line begins with the sign of a comment.
pub(super) fn begins_comment(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start().first(), Some(b'#' | b'%'))
}

/// The text without its byte order mark.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The place of a line in a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Line {
    /// Its first byte.
    pub(super) start: usize,
    /// The byte after its last, without the end of the line.
    pub(super) end: usize,
    /// The first byte of the next line.
    pub(super) next: usize,
    /// Its number, from 1.
    pub(super) number: u64,
}

impl Line {
    pub(super) fn bytes<'a>(&self, text: &'a [u8]) -> &'a [u8] {
        text.get(self.start..self.end).unwrap_or_default()
    }
}

/// The lines of a text, which end with a line feed, a carriage return or both.
pub(super) fn lines(text: &[u8]) -> impl Iterator<Item = Line> {
    let (mut start, mut number) = (0, 0);
    std::iter::from_fn(move || {
        let rest = text.get(start..).filter(|rest| !rest.is_empty())?;
        let length = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let ending = match rest[length..] {
            [b'\r', b'\n', ..] => 2,
            [_, ..] => 1,
            [] => 0,
        };
        let end = start + length;
        number += 1;
        let line = Line { start, end, next: end + ending, number };
        start = line.next;
        Some(line)
    })
}

/// Lines joined where a cell in quotation marks goes on in the next line, as in names that spreadsheets write.
pub(super) fn joined_lines(text: &[u8], lines: &[Line]) -> Vec<Line> {
    let mut joined = Vec::new();
    let mut first = 0;
    while let Some(line) = lines.get(first) {
        let balanced = |last: &&Line| is_balanced(&text[line.start..last.end]);
        let after = lines[first..].iter().take(MOST_LINES_OF_ROW);
        let count = after.clone().position(|last| balanced(&last)).map_or(1, |place| place + 1);
        joined.push(Line { number: line.number, start: line.start, ..lines[first + count - 1] });
        first += count;
    }
    joined
}

fn is_balanced(bytes: &[u8]) -> bool {
    memchr::memchr_iter(b'"', bytes).count().is_multiple_of(2)
}

/// The text from its first row of values on.
pub(super) struct Body<'a> {
    pub(super) bytes: &'a [u8],
    /// The number of its first line in the file.
    pub(super) line: u64,
}

impl<'a> Body<'a> {
    /// The text prepared for the reader of rows: with the space as delimiter, runs of spaces become one.
    pub(super) fn prepared(&self, delimiter: u8) -> Cow<'a, [u8]> {
        prepared(self.bytes, delimiter)
    }

    /// The line in the file on which a row of the prepared text begins, counted from 1.
    pub(super) fn line_of(&self, row: &ByteRecord, prepared: &[u8]) -> u64 {
        let (byte, line) = row.position().map_or((0, 1), |place| (place.byte() as usize, place.line()));
        // The position is that before empty lines.
        let empty = prepared.get(byte..).unwrap_or_default().iter().take_while(|b| matches!(b, b'\n' | b'\r'));
        self.line + line - 1 + empty.filter(|b| **b == b'\n').count() as u64
    }
}

/// The first cells of a line, as the reader of rows splits them.
pub(super) fn cells(line: &[u8], delimiter: u8, most: usize) -> Vec<Vec<u8>> {
    let line = prepared(line, delimiter);
    let mut cells = vec![Vec::new()];
    let (mut is_quoted, mut begins) = (false, true);
    let mut bytes = line.iter().copied().peekable();
    while let Some(byte) = bytes.next() {
        let last = cells.len() - 1;
        match byte {
            b'"' if is_quoted && bytes.next_if_eq(&b'"').is_some() => cells[last].push(b'"'),
            b'"' if is_quoted => is_quoted = false,
            b'"' if begins => is_quoted = true,
            _ if byte == delimiter && !is_quoted && cells.len() == most => return cells,
            _ if byte == delimiter && !is_quoted => cells.push(Vec::new()),
            _ => cells[last].push(byte),
        }
        begins = byte == delimiter && !is_quoted;
    }
    cells
}

/// A text or line prepared for the reader of rows.
pub(super) fn prepared(bytes: &[u8], delimiter: u8) -> Cow<'_, [u8]> {
    if delimiter == b' ' { Cow::Owned(single_spaces(bytes)) } else { Cow::Borrowed(bytes) }
}

/// A reader of rows of any length.
pub(super) fn rows(prepared: &[u8], delimiter: u8) -> Reader<&[u8]> {
    let mut builder = ReaderBuilder::new();
    builder.flexible(true).has_headers(false).delimiter(delimiter).buffer_capacity(prepared.len().clamp(1, 1 << 16));
    builder.from_reader(prepared)
}

pub(super) fn unreadable(path: &Path, error: csv::Error) -> RecordingError {
    RecordingError::Unreadable { file: path.into(), source: io::Error::from(error) }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_every_ending_have_their_numbers() {
        let text = b"a\nb\r\nc\rd";
        let found: Vec<(&[u8], u64)> = lines(text).map(|line| (line.bytes(text), line.number)).collect();
        assert_eq!(found, [(&b"a"[..], 1), (b"b", 2), (b"c", 3), (b"d", 4)]);
    }

    #[test]
    fn cells_are_those_of_the_reader_of_rows() {
        for line in ["a,b", "", ",", "\"a,\"\"b\",c", "\"a\"b,c", "a\"b\",c", "\"\",\"\"", "\"open, c", "a, \"b\""] {
            let mut row = ByteRecord::new();
            rows(line.as_bytes(), b',').read_byte_record(&mut row).unwrap();
            let expected: Vec<Vec<u8>> = row.iter().map(<[u8]>::to_vec).collect();
            let found = cells(line.as_bytes(), b',', 9);
            assert!(found == expected || line.is_empty(), "{line:?} {found:?} {expected:?}");
        }
    }

    #[test]
    fn a_name_in_quotation_marks_may_have_two_lines() {
        let text = b"t,\"q\n[deg]\"\n0,1\n5\" pipe\n";
        let all: Vec<Line> = lines(text).collect();
        let found: Vec<&[u8]> = joined_lines(text, &all).iter().map(|line| line.bytes(text)).collect();
        assert_eq!(found, [&b"t,\"q\n[deg]\""[..], b"0,1", b"5\" pipe"]);
    }
}
