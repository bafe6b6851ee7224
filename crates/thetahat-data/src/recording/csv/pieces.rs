//! A text file read from any row on.
//!
//! A first pass finds where lines begin; a piece is then read and parsed independently. If rows can differ from lines (quotes, single
//! carriage returns), the reader of whole files is used.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use memchr::{memchr, memchr_iter};

use super::super::error::RecordingError;
use super::super::place::{open, unreadable};
use super::super::table::{Column, RequestedColumns, Table, is_plausible};
use super::dialect::Dialect;
use super::encoding::is_utf_16;
use super::number::Numbers;
use super::read::read_columns;
use super::text::without_mark;
use super::transposed::{is_evident, is_wide};
use super::values::flaw;
use thetahat_ground::files::{self, File};

/// Number of rows between two stored positions.
const ROWS_PER_MARK: usize = 1024;
/// Size of the beginning from which unset parts of the dialect are detected, and of one step of the first pass.
const BUFFER: usize = 1 << 20;

/// A text file of which any rows can be read.
pub(in super::super) struct TextPieces {
    path: PathBuf,
    delimiter: u8,
    numbers: Numbers,
    names: Vec<String>,
    /// The first line of the table.
    first_line: u64,
    marks: Vec<Mark>,
    rows: usize,
    end: u64,
}

/// A stored position in the file.
#[derive(Clone, Copy)]
struct Mark {
    byte: u64,
    /// Its line, from 1.
    line: u64,
}

impl TextPieces {
    /// Scans a file; none if it must be read whole.
    pub(in super::super) fn open(
        path: &Path,
        dialect: &Dialect,
        wanted: RequestedColumns<'_>,
    ) -> Result<Option<Self>, RecordingError> {
        let mut file = open(path)?;
        let mut beginning = Vec::new();
        Read::by_ref(&mut file).take(BUFFER as u64).read_to_end(&mut beginning).map_err(|e| unreadable(path, e))?;
        if beginning.len() == BUFFER {
            // A line that is incomplete, or longer than the examined beginning.
            let Some(last) = memchr::memrchr(b'\n', &beginning) else { return Ok(None) };
            beginning.truncate(last + 1);
        }
        if is_utf_16(&beginning) {
            return Ok(None);
        }
        let text = without_mark(&beginning);
        if is_evident(text, path, dialect) {
            return Ok(None);
        }
        let detected = match dialect.detect(text, path) {
            Err(RecordingError::EmptyFile { .. }) if beginning.len() + 1 >= BUFFER => return Ok(None),
            detected => detected?,
        };
        let (columns, numbers, _) = read_columns(text, path, dialect, &detected, wanted)?;
        let needs_all = |column: &Column| column.in_seconds || !column.channel_names.is_empty();
        if numbers.decimal().is_none() || columns.iter().any(needs_all) {
            return Ok(None);
        }
        let (delimiter, first_line, line) = (detected.delimiter, detected.first_line, detected.line);
        let names: Vec<String> = columns.into_iter().map(|c| c.name).collect();
        let byte = (beginning.len() - text.len() + detected.start) as u64;
        let scan = Scan { delimiter, marks: Vec::new(), rows: 0, line, line_start: byte, content: false };
        let Some((marks, rows, end)) = scan.run(file, path)?.filter(|(_, rows, _)| !is_wide(names.len(), *rows)) else {
            return Ok(None);
        };
        Ok(Some(Self { path: path.to_owned(), delimiter, numbers, names, first_line, marks, rows, end }))
    }

    pub(in super::super) fn rows(&self) -> usize {
        self.rows
    }

    /// The columns of these rows. Columns that are not requested have a name and no values.
    pub(in super::super) fn read(
        &self,
        range: Range<usize>,
        wanted: RequestedColumns<'_>,
    ) -> Result<Table, RecordingError> {
        let mark = self.marks.get(range.start / ROWS_PER_MARK).copied().unwrap_or(Mark { byte: self.end, line: 0 });
        let end = self.marks.get(range.end.div_ceil(ROWS_PER_MARK)).map_or(self.end, |mark| mark.byte);
        let bytes = self.bytes(mark.byte..end)?;
        let mut columns: Vec<Column> =
            self.names.iter().map(|name| Column::of_numbers(name.clone(), 1, Vec::new())).collect();
        let is_read = |(name, number): (&String, usize)| wanted.includes(name) || wanted.includes_number(number);
        let read: Vec<bool> = self.names.iter().zip(1..).map(is_read).collect();
        let reserve = columns.iter_mut().zip(&read).filter(|(_, read)| **read);
        reserve.for_each(|(column, _)| column.values.reserve_exact(range.len()));
        let mut numbers = self.numbers;
        let lines = Lines { bytes: &bytes }.zip(mark.line..).filter(|(line, _)| has_content(line, self.delimiter));
        let skip = range.start % ROWS_PER_MARK;
        let mut rows = 0;
        for (line, number) in lines.skip(skip).take(range.len()) {
            self.add(line, number, &mut numbers, &read, &mut columns)?;
            rows += 1;
        }
        if rows < range.len() {
            return Err(RecordingError::damaged(&self.path, "it was changed while it was read".to_owned()));
        }
        Ok(Table { name: String::new(), columns })
    }

    fn bytes(&self, range: Range<u64>) -> Result<Vec<u8>, RecordingError> {
        let refuse = |e| unreadable(&self.path, e);
        let mut file = files::open(&self.path).map_err(refuse)?;
        file.seek(SeekFrom::Start(range.start)).map_err(refuse)?;
        let length = range.end.saturating_sub(range.start);
        let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
        file.take(length).read_to_end(&mut bytes).map_err(refuse)?;
        Ok(bytes)
    }

    fn add(
        &self,
        line: &[u8],
        number: u64,
        numbers: &mut Numbers,
        read: &[bool],
        columns: &mut [Column],
    ) -> Result<(), RecordingError> {
        let mut found = 0;
        let mut last: &[u8] = &[];
        for cell in cells(line, self.delimiter) {
            last = cell;
            if read.get(found) == Some(&true) {
                let (value, column) = (numbers.read(cell), &mut columns[found]);
                column.values.push(value.unwrap_or(f64::NAN));
                if column.flaw.is_none() && !value.is_some_and(is_plausible) {
                    column.flaw = Some(flaw(value, cell, number));
                }
            }
            found += 1;
        }
        let is_longer_by_nothing = found == columns.len() + 1 && last.trim_ascii().is_empty();
        if found == columns.len() || is_longer_by_nothing {
            return Ok(());
        }
        let (expected, delimiter, first_line) = (columns.len(), self.delimiter.into(), self.first_line);
        Err(RecordingError::RowLength { file: self.path.clone(), line: number, first_line, expected, found, delimiter })
    }
}

/// The cells of a line; runs of spaces are one delimiter.
fn cells(line: &[u8], delimiter: u8) -> impl Iterator<Item = &[u8]> {
    let by_space = delimiter == b' ';
    let line = if by_space { line.trim_ascii() } else { line };
    let mut start = 0;
    let ends = memchr_iter(delimiter, line).chain([line.len()]);
    let cells = ends.map(move |end| {
        let cell = &line[start..end];
        start = end + 1;
        cell
    });
    cells.filter(move |cell| !by_space || !cell.is_empty())
}

/// Whether a line is a row.
fn has_content(line: &[u8], delimiter: u8) -> bool {
    line.iter().any(|b| *b != b'\r' && (delimiter != b' ' || *b != b' '))
}

/// Lines without their ends.
struct Lines<'a> {
    bytes: &'a [u8],
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.bytes.is_empty() {
            return None;
        }
        let (line, rest) = match memchr(b'\n', self.bytes) {
            Some(end) => (&self.bytes[..end], &self.bytes[end + 1..]),
            None => (self.bytes, &self.bytes[self.bytes.len()..]),
        };
        self.bytes = rest;
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }
}

/// The first pass.
struct Scan {
    delimiter: u8,
    marks: Vec<Mark>,
    rows: usize,
    line: u64,
    line_start: u64,
    /// Whether an earlier buffer already showed that the line is a row.
    content: bool,
}

impl Scan {
    /// Marks, rows and the end of the file; none if it must be read whole.
    fn run(mut self, mut file: File, path: &Path) -> Result<Option<(Vec<Mark>, usize, u64)>, RecordingError> {
        let refuse = |e| unreadable(path, e);
        file.seek(SeekFrom::Start(self.line_start)).map_err(refuse)?;
        let mut buffer = Vec::with_capacity(BUFFER);
        let mut place = self.line_start;
        let mut ends_with_return = false;
        loop {
            buffer.clear();
            let read = Read::by_ref(&mut file).take(BUFFER as u64).read_to_end(&mut buffer).map_err(refuse)?;
            let splits_ends = ends_with_return && buffer.first() != Some(&b'\n');
            if splits_ends || memchr(b'"', &buffer).is_some() || has_single_returns(&buffer) || has_comments(&buffer) {
                return Ok(None);
            }
            if read == 0 {
                break;
            }
            ends_with_return = buffer.last() == Some(&b'\r');
            self.lines(&buffer, place);
            place += read as u64;
        }
        if self.content {
            self.end_of_line(place);
        }
        Ok(Some((self.marks, self.rows, place)))
    }

    fn lines(&mut self, buffer: &[u8], place: u64) {
        let mut start = 0;
        for end in memchr_iter(b'\n', buffer) {
            self.content |= has_content(&buffer[start..end], self.delimiter);
            self.end_of_line(place + end as u64 + 1);
            start = end + 1;
        }
        self.content |= has_content(&buffer[start..], self.delimiter);
    }

    fn end_of_line(&mut self, next: u64) {
        if self.content {
            if self.rows.is_multiple_of(ROWS_PER_MARK) {
                self.marks.push(Mark { byte: self.line_start, line: self.line });
            }
            self.rows += 1;
        }
        self.content = false;
        self.line += 1;
        self.line_start = next;
    }
}

/// Whether a line begins with the sign of a comment. A line that begins with the buffer is not examined: its row then has another length.
fn has_comments(buffer: &[u8]) -> bool {
    memchr_iter(b'\n', buffer).any(|end| matches!(buffer.get(end + 1), Some(b'#' | b'%')))
}

/// Whether a carriage return stands alone, before the last byte.
fn has_single_returns(buffer: &[u8]) -> bool {
    memchr_iter(b'\r', buffer).any(|i| buffer.get(i + 1).is_some_and(|next| *next != b'\n'))
}
