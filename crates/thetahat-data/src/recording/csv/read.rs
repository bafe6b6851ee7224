//! Reads a text file into a table.

use std::io;
use std::path::Path;

use csv::ByteRecord;
use memchr::memchr;

use super::super::error::RecordingError;
use super::super::table::{Column, Flaw, RequestedColumns, Table, is_plausible};
use super::dialect::Dialect;
use super::number::Numbers;
use super::text::{Text, characters, rows};

/// Most columns of a text: a line with more is a matrix with channels in rows.
const MOST_COLUMNS: usize = 10_000;

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
    let text = Text::of(bytes, path)?;
    let (delimiter, header) = dialect.detect(&text, path)?;
    let prepared = text.prepared(delimiter);
    let mut reader = rows(&prepared, delimiter);
    let numbers = Numbers::new(dialect.decimal, delimiter);
    let mut columns = Columns { path, text: &text, delimiter, numbers, columns: Vec::new(), read: Vec::new() };
    let mut row = ByteRecord::new();
    let (mut first, mut cut_line) = (true, false);
    while reader.read_byte_record(&mut row).map_err(|e| unreadable(path, e))? {
        if first {
            columns.name(&row, header, wanted)?;
        }
        if columns.is_cut(&row, &prepared) {
            cut_line = true;
            if !dialect.drop_cut_line {
                return Err(columns.cut_line(&row));
            }
        } else if !(first && header) {
            columns.add(&row)?;
        }
        first = false;
    }
    let decimal = columns.numbers.decimal();
    let table = Table { name: String::new(), columns: columns.columns };
    Ok((table, Dialect { delimiter: Some(delimiter.into()), decimal, header: Some(header), drop_cut_line: cut_line }))
}

/// The names in the first row; none if it holds numbers.
pub(in super::super) fn names(bytes: &[u8], path: &Path, dialect: &Dialect) -> Result<Vec<String>, RecordingError> {
    let text = Text::of(bytes, path)?;
    let (delimiter, header) = dialect.detect(&text, path)?;
    let prepared = text.prepared(delimiter);
    let mut row = ByteRecord::new();
    rows(&prepared, delimiter).read_byte_record(&mut row).map_err(|e| unreadable(path, e))?;
    Ok(row.iter().filter(|_| header).map(name).collect())
}

fn name(cell: &[u8]) -> String {
    characters(cell).trim().to_owned()
}

/// The columns while their rows are being read.
struct Columns<'a> {
    path: &'a Path,
    text: &'a Text<'a>,
    delimiter: u8,
    numbers: Numbers,
    columns: Vec<Column>,
    /// Indices of the requested columns.
    read: Vec<usize>,
}

impl Columns<'_> {
    /// Creates the columns, with the names in the first row or numbered from 1.
    fn name(&mut self, first: &ByteRecord, header: bool, wanted: RequestedColumns<'_>) -> Result<(), RecordingError> {
        if first.len() > MOST_COLUMNS {
            let (file, line) = (self.path.to_owned(), self.text.line(first));
            return Err(RecordingError::TooManyColumns { file, line, found: first.len(), limit: MOST_COLUMNS });
        }
        let names = first.iter().enumerate().map(|(i, cell)| if header { name(cell) } else { (i + 1).to_string() });
        self.columns = names.map(|name| Column::of_numbers(name, 1, Vec::new())).collect();
        self.read = (0..self.columns.len()).filter(|&i| wanted.includes(&self.columns[i].name)).collect();
        Ok(())
    }

    /// Whether a row is too short and the text ends in it.
    fn is_cut(&self, row: &ByteRecord, text: &[u8]) -> bool {
        let start = row.position().map_or(0, |place| place.byte() as usize);
        row.len() < self.columns.len()
            && text.get(start..).is_some_and(|rest| memchr(b'\n', rest.trim_ascii_start()).is_none())
    }

    fn cut_line(&self, row: &ByteRecord) -> RecordingError {
        let (file, line) = (self.path.to_owned(), self.text.line(row));
        RecordingError::CutLine { file, line, expected: self.columns.len(), found: row.len() }
    }

    fn add(&mut self, row: &ByteRecord) -> Result<(), RecordingError> {
        if row.len() != self.columns.len() {
            return Err(self.row_length(row));
        }
        for &place in &self.read {
            let number = self.numbers.read(&row[place]);
            let column = &mut self.columns[place];
            column.values.push(number.unwrap_or(f64::NAN));
            if column.flaw.is_none() && !number.is_some_and(is_plausible) {
                column.flaw = Some(flaw(number, &row[place], self.text.line(row)));
            }
        }
        Ok(())
    }

    fn row_length(&self, row: &ByteRecord) -> RecordingError {
        RecordingError::RowLength {
            file: self.path.to_owned(),
            line: self.text.line(row),
            expected: self.columns.len(),
            found: row.len(),
            delimiter: self.delimiter.into(),
        }
    }
}

pub(super) fn flaw(number: Option<f64>, cell: &[u8], line: u64) -> Flaw {
    match number {
        Some(found) => Flaw::NotFinite { line, found },
        None => Flaw::Text { line, found: characters(cell) },
    }
}

fn unreadable(path: &Path, error: csv::Error) -> RecordingError {
    RecordingError::Unreadable { file: path.into(), source: io::Error::from(error) }
}
