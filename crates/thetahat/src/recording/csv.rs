//! CSV: comma separated, a line of column names, then one line per sample with a point as decimal sign.

use std::io;
use std::path::Path;
use std::str;

use csv::{ByteRecord, Reader, ReaderBuilder};

use super::RecordingError;
use super::source::file_bytes;
use crate::series::Series;

/// The named columns of a CSV file in the order of the names, or all of them if none is named.
pub(super) fn read(path: &Path, columns: &[String]) -> Result<Series, RecordingError> {
    let bytes = file_bytes(path)?;
    let mut reader = ReaderBuilder::new().flexible(true).from_reader(bytes.as_slice());
    let table = Table::of(&mut reader, path, columns)?;
    let values = table.values(&mut reader)?;
    if values.is_empty() {
        return Err(RecordingError::NoSamples { file: path.into() });
    }
    Ok(Series::from_values(table.selected.len(), values))
}

/// What the header says: the names of all columns, and the places of those to read.
struct Table<'a> {
    path: &'a Path,
    names: Vec<String>,
    selected: Vec<usize>,
}

impl<'a> Table<'a> {
    fn of(reader: &mut Reader<&[u8]>, path: &'a Path, columns: &[String]) -> Result<Self, RecordingError> {
        let header = reader.byte_headers().map_err(|e| unreadable(path, e))?;
        let names: Vec<_> = header.iter().map(|name| String::from_utf8_lossy(name).trim().to_owned()).collect();
        let mut table = Self { path, names, selected: Vec::new() };
        table.selected = match columns {
            [] => table.all()?,
            _ => columns.iter().map(|column| table.place(column)).collect::<Result<_, _>>()?,
        };
        Ok(table)
    }

    fn all(&self) -> Result<Vec<usize>, RecordingError> {
        if self.names.is_empty() {
            return Err(RecordingError::EmptyFile { file: self.path.into() });
        }
        if self.names.iter().all(|name| name.parse::<f64>().is_ok()) {
            return Err(RecordingError::MissingHeader { file: self.path.into() });
        }
        Ok((0..self.names.len()).collect())
    }

    fn place(&self, column: &str) -> Result<usize, RecordingError> {
        let mut places = (0..self.names.len()).filter(|&i| self.names[i] == column);
        let (file, column) = (self.path.to_owned(), column.to_owned());
        match (places.next(), places.count()) {
            (None, _) => Err(RecordingError::MissingColumn { file, column, found: self.names.clone() }),
            (Some(place), 0) => Ok(place),
            (Some(_), others) => Err(RecordingError::AmbiguousColumn { file, column, found: others + 1 }),
        }
    }

    /// The selected columns of all rows, row by row.
    fn values(&self, reader: &mut Reader<&[u8]>) -> Result<Vec<f64>, RecordingError> {
        let mut values = Vec::new();
        let mut row = ByteRecord::new();
        while reader.read_byte_record(&mut row).map_err(|e| unreadable(self.path, e))? {
            if row.len() != self.names.len() {
                return Err(self.row_length(&row));
            }
            for &place in &self.selected {
                match number(&row[place]) {
                    Some(value) if value.is_finite() => values.push(value),
                    Some(value) => return Err(self.not_finite(&row, place, value)),
                    None => return Err(self.not_a_number(&row, place)),
                }
            }
        }
        Ok(values)
    }

    fn row_length(&self, row: &ByteRecord) -> RecordingError {
        let (expected, found) = (self.names.len(), row.len());
        RecordingError::RowLength { file: self.path.into(), line: line(row), expected, found }
    }

    fn not_finite(&self, row: &ByteRecord, place: usize, found: f64) -> RecordingError {
        RecordingError::NotFinite { file: self.path.into(), line: line(row), column: self.names[place].clone(), found }
    }

    fn not_a_number(&self, row: &ByteRecord, place: usize) -> RecordingError {
        let found = String::from_utf8_lossy(&row[place]).into_owned();
        RecordingError::NotANumber { file: self.path.into(), line: line(row), column: self.names[place].clone(), found }
    }
}

fn number(cell: &[u8]) -> Option<f64> {
    let text = str::from_utf8(cell).ok()?;
    text.parse().or_else(|_| text.trim().parse()).ok()
}

/// The line on which a row begins, counted from 1.
fn line(row: &ByteRecord) -> u64 {
    row.position().map_or(0, csv::Position::line)
}

fn unreadable(path: &Path, error: csv::Error) -> RecordingError {
    RecordingError::Unreadable { file: path.into(), source: io::Error::from(error) }
}

#[cfg(test)]
mod tests {
    use super::super::test_files::Folder;
    use super::*;

    fn table(text: &str, columns: &[&str]) -> Result<Series, RecordingError> {
        let folder = Folder::with("q.csv", text.as_bytes());
        let columns: Vec<_> = columns.iter().map(|&c| c.to_owned()).collect();
        read(&folder.path().join("q.csv"), &columns)
    }

    fn failure(text: &str, columns: &[&str]) -> RecordingError {
        table(text, columns).unwrap_err()
    }

    #[test]
    fn named_columns_in_the_order_of_the_names() {
        let series = table("a,b,c\n1,2,3\n-4e-3,+5.5,6\n", &["c", "a"]).unwrap();
        assert_eq!((series.channels(), series.values()), (2, [3.0, 1.0, 6.0, -4e-3].as_slice()));
    }

    #[test]
    fn all_columns_where_none_is_named() {
        assert_eq!(table("a,b\n1,2\n3,4\n", &[]).unwrap().values(), [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn byte_order_mark_spaces_and_carriage_returns_are_dropped() {
        assert_eq!(table("\u{feff}a , b\r\n 1, 2 \r\n3,4", &["a", "b"]).unwrap().values(), [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn text_in_a_column_that_is_not_read_does_no_harm() {
        assert_eq!(table("a,note\n1,start\n2,end\n", &["a"]).unwrap().values(), [1.0, 2.0]);
    }

    #[test]
    fn columns_named_by_numbers_can_be_asked_for() {
        assert_eq!(table("0,1\n5,6\n", &["1"]).unwrap().values(), [6.0]);
    }

    #[test]
    fn empty_file() {
        assert!(matches!(failure("", &["a"]), RecordingError::EmptyFile { .. }));
    }

    #[test]
    fn blank_file() {
        assert!(matches!(failure("\n\n", &[]), RecordingError::EmptyFile { .. }));
    }

    #[test]
    fn header_without_samples() {
        assert!(matches!(failure("a,b\n", &["a"]), RecordingError::NoSamples { .. }));
    }

    #[test]
    fn numbers_instead_of_names() {
        assert!(matches!(failure("1,2\n3,4\n", &[]), RecordingError::MissingHeader { .. }));
    }

    #[test]
    fn missing_column_lists_those_present() {
        let error = failure("a,b\n1,2\n", &["a", "q7"]);
        assert!(matches!(error, RecordingError::MissingColumn { column, found, .. }
            if column == "q7" && found == ["a", "b"]));
    }

    #[test]
    fn text_of_a_missing_column_names_file_and_column() {
        let text = failure("a,b\n1,2\n", &["q7"]).to_string();
        assert!(text.contains("q.csv") && text.contains("q7"), "{text}");
    }

    #[test]
    fn two_columns_of_one_name() {
        assert!(matches!(failure("a,a\n1,2\n", &["a"]), RecordingError::AmbiguousColumn { found: 2, .. }));
    }

    #[test]
    fn short_row() {
        let error = failure("a,b\n1,2\n3\n", &["a"]);
        assert!(matches!(error, RecordingError::RowLength { line: 3, expected: 2, found: 1, .. }));
    }

    #[test]
    fn long_row() {
        let error = failure("a,b\n1,2\n3,5,4\n", &["a"]);
        assert!(matches!(error, RecordingError::RowLength { line: 3, expected: 2, found: 3, .. }));
    }

    #[test]
    fn cell_that_is_not_a_number() {
        let error = failure("a,b\n1,2\n3,on\n", &[]);
        assert!(matches!(error, RecordingError::NotANumber { line: 3, column, found, .. }
            if column == "b" && found == "on"));
    }

    #[test]
    fn empty_cell() {
        assert!(matches!(failure("a,b\n1,\n", &[]), RecordingError::NotANumber { line: 2, .. }));
    }

    #[test]
    fn cell_that_is_not_text() {
        let folder = Folder::with("q.csv", b"a\n\xff\xfe\n");
        let error = read(&folder.path().join("q.csv"), &[]).unwrap_err();
        assert!(matches!(error, RecordingError::NotANumber { line: 2, .. }));
    }

    #[test]
    fn cell_that_is_nan() {
        let error = failure("a,b\n1,2\n\n3,4\nNaN,6\n", &[]);
        assert!(matches!(error, RecordingError::NotFinite { line: 5, column, .. } if column == "a"));
    }

    #[test]
    fn cell_that_is_infinite() {
        let error = failure("a,b\n1,-inf\n", &[]);
        assert!(matches!(error, RecordingError::NotFinite { line: 2, found: f64::NEG_INFINITY, .. }));
    }
}
