//! Reads a text file into a table.

use std::path::Path;

use csv::ByteRecord;
use memchr::memchr;

use super::super::error::RecordingError;
use super::super::table::{Column, Flaw, RequestedColumns, Table};
use super::dialect::{Detected, Dialect};
use super::encoding::decoded;
use super::number::Numbers;
use super::text::{Body, MOST_COLUMNS, begins_comment, rows, unreadable, without_mark};
use super::transposed;
use super::values::Values;

/// Most lines of words that may follow the table.
const MOST_CLOSING: usize = 4;

/// The columns of a text. Columns that are not requested have a name and no values.
pub(in super::super) fn read(
    bytes: &[u8],
    path: &Path,
    dialect: &Dialect,
    wanted: RequestedColumns<'_>,
) -> Result<Table, RecordingError> {
    read_with_dialect(bytes, path, dialect, wanted).map(|(table, _)| table)
}

/// The columns, and the dialect that was detected.
pub(in super::super) fn read_with_dialect(
    bytes: &[u8],
    path: &Path,
    dialect: &Dialect,
    wanted: RequestedColumns<'_>,
) -> Result<(Table, Dialect), RecordingError> {
    let decoded = decoded(bytes, path)?;
    let text = without_mark(&decoded);
    let channels_in_rows = dialect.channels_in_rows || transposed::is_evident(text, path, dialect);
    let dialect = &Dialect { channels_in_rows, ..*dialect };
    let detected = dialect.detect(text, path)?;
    if channels_in_rows {
        return transposed::read(text, path, dialect, &detected, wanted);
    }
    let (columns, numbers, is_cut) = read_columns(text, path, dialect, &detected, wanted)?;
    Ok((Table { name: String::new(), columns }, detected.dialect(dialect, numbers, is_cut)))
}

/// The columns of a text with a known dialect, how its numbers were read, and whether its last line was cut.
pub(super) fn read_columns(
    text: &[u8],
    path: &Path,
    dialect: &Dialect,
    detected: &Detected,
    wanted: RequestedColumns<'_>,
) -> Result<(Vec<Column>, Numbers, bool), RecordingError> {
    let body = Body { bytes: &text[detected.start..], line: detected.line };
    let prepared = body.prepared(detected.delimiter);
    let mut reader = rows(&prepared, detected.delimiter);
    let mut columns = Columns::of(path, &body, &prepared, detected);
    if let Some(names) = &detected.names {
        columns.name(names.clone(), wanted)?;
    }
    let mut row = ByteRecord::new();
    let mut is_cut = false;
    while reader.read_byte_record(&mut row).map_err(|e| unreadable(path, e))? {
        if columns.names.is_empty() {
            let width = detected.width.filter(|width| *width <= MOST_COLUMNS).unwrap_or(row.len());
            columns.name((1..=width).map(|number| number.to_string()).collect(), wanted)?;
        }
        if columns.is_comment(&row) || columns.is_closing(&row) {
            continue;
        }
        if columns.is_cut(&row) {
            is_cut = true;
            if !dialect.drop_cut_line {
                return Err(columns.cut_line(&row));
            }
        } else {
            columns.add(&row)?;
        }
    }
    let numbers = columns.numbers;
    Ok((columns.finished(dialect.day_first), numbers, is_cut))
}

/// The names of the columns; none if they are numbered.
pub(in super::super) fn names(bytes: &[u8], path: &Path, dialect: &Dialect) -> Result<Vec<String>, RecordingError> {
    let decoded = decoded(bytes, path)?;
    Ok(dialect.detect(without_mark(&decoded), path)?.names.unwrap_or_default())
}

/// The columns while their rows are being read.
struct Columns<'a> {
    path: &'a Path,
    body: &'a Body<'a>,
    prepared: &'a [u8],
    detected: &'a Detected,
    numbers: Numbers,
    names: Vec<String>,
    /// The requested columns by their indices.
    read: Vec<(usize, Values)>,
    /// The first row whose names of joints are others.
    other_order: Option<Flaw>,
}

impl<'a> Columns<'a> {
    fn of(path: &'a Path, body: &'a Body<'a>, prepared: &'a [u8], detected: &'a Detected) -> Self {
        let numbers = detected.numbers;
        Self { path, body, prepared, detected, numbers, names: Vec::new(), read: Vec::new(), other_order: None }
    }

    fn name(&mut self, names: Vec<String>, wanted: RequestedColumns<'_>) -> Result<(), RecordingError> {
        if names.len() > MOST_COLUMNS {
            let (file, line) = (self.path.to_owned(), self.detected.first_line);
            return Err(RecordingError::TooManyColumns { file, line, found: names.len(), limit: MOST_COLUMNS });
        }
        let is_signal = |i: usize| self.detected.joints.signal(i).is_some_and(|signal| wanted.includes(signal));
        let is_read = |&i: &usize| wanted.includes(&names[i]) || wanted.includes_number(i + 1) || is_signal(i);
        self.read = (0..names.len()).filter(is_read).map(|i| (i, Values::default())).collect();
        self.names = names;
        Ok(())
    }

    fn finished(self, day_first: Option<bool>) -> Vec<Column> {
        let signals = |i: usize| self.detected.joints.signal(i).into_iter().cloned().collect();
        let unread = |(i, name)| Column { channel_names: signals(i), ..Column::of_numbers(name, 1, Vec::new()) };
        let mut columns: Vec<Column> = self.names.into_iter().enumerate().map(unread).collect();
        for (place, values) in self.read {
            let Column { name, channel_names, .. } = columns[place].clone();
            let column = values.into_column(name, day_first);
            let of_order = self.other_order.clone().filter(|_| !channel_names.is_empty());
            columns[place] = Column { flaw: column.flaw.or(of_order), channel_names, ..column };
        }
        columns
    }

    /// Whether a row is a comment among the values: it begins with the sign of one, and has another length.
    fn is_comment(&self, row: &ByteRecord) -> bool {
        row.len() != self.names.len() && row.get(0).is_some_and(begins_comment)
    }

    /// Whether a row is a line of words after the table, such as `End of file;;;`: one cell, which is no value, at the end of the text.
    fn is_closing(&self, row: &ByteRecord) -> bool {
        let mut filled = row.iter().filter(|cell| !cell.trim_ascii().is_empty());
        let (Some(words), None) = (filled.next(), filled.next()) else { return false };
        let mut numbers = self.numbers;
        let are_words = words.trim_ascii()[0].is_ascii_alphabetic() && numbers.read(words).is_none();
        self.names.len() > 1 && are_words && self.lines_from(row) <= MOST_CLOSING
    }

    /// Lines with content from a row to the end of the text; at most one more than [`MOST_CLOSING`] are counted.
    fn lines_from(&self, row: &ByteRecord) -> usize {
        let start = row.position().map_or(0, |place| place.byte() as usize);
        let rest = self.prepared.get(start..).unwrap_or_default();
        rest.split(|byte| *byte == b'\n').filter(|line| !line.trim_ascii().is_empty()).take(MOST_CLOSING + 1).count()
    }

    /// Whether a row is too short and the text ends in it.
    fn is_cut(&self, row: &ByteRecord) -> bool {
        let start = row.position().map_or(0, |place| place.byte() as usize);
        row.len() < self.names.len()
            && self.prepared.get(start..).is_some_and(|rest| memchr(b'\n', rest.trim_ascii_start()).is_none())
    }

    fn line_of(&self, row: &ByteRecord) -> u64 {
        self.body.line_of(row, self.prepared)
    }

    fn cut_line(&self, row: &ByteRecord) -> RecordingError {
        let (file, line) = (self.path.to_owned(), self.line_of(row));
        RecordingError::CutLine { file, line, expected: self.names.len(), found: row.len() }
    }

    fn add(&mut self, row: &ByteRecord) -> Result<(), RecordingError> {
        let is_longer_by_nothing = row.len() == self.names.len() + 1 && row[row.len() - 1].trim_ascii().is_empty();
        if row.len() != self.names.len() && !is_longer_by_nothing {
            return Err(self.row_length(row));
        }
        let (body, prepared) = (self.body, self.prepared);
        if self.other_order.is_none() {
            self.other_order = self.detected.joints.other_order(row, || body.line_of(row, prepared));
        }
        for (place, values) in &mut self.read {
            values.push(&row[*place], &mut self.numbers, || body.line_of(row, prepared));
        }
        Ok(())
    }

    fn row_length(&self, row: &ByteRecord) -> RecordingError {
        RecordingError::RowLength {
            file: self.path.to_owned(),
            line: self.line_of(row),
            first_line: self.detected.first_line,
            expected: self.names.len(),
            found: row.len(),
            delimiter: self.detected.delimiter.into(),
        }
    }
}
