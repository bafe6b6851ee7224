//! A text with a channel in each line, and its name in the first cell or its number.

use std::path::Path;

use csv::ByteRecord;

use super::super::error::RecordingError;
use super::super::table::{Column, RequestedColumns, Table};
use super::dialect::{Detected, Dialect};
use super::number::Numbers;
use super::stamp::Stamp;
use super::text::{Body, characters, lines, rows, unreadable};
use super::values::Values;

/// Most lines of a text that is taken to have channels in lines.
const MOST_LINES: usize = 100;
/// Least ratio of the cells of its first line to its lines.
const WIDER: usize = 4;
/// Least number of cells of its first line.
const LEAST_CELLS: usize = 100;

/// The lines of a text as columns. Columns that are not requested have a name and no values.
pub(super) fn read(
    text: &[u8],
    path: &Path,
    dialect: &Dialect,
    detected: &Detected,
    wanted: RequestedColumns<'_>,
) -> Result<(Table, Dialect), RecordingError> {
    let body = Body { bytes: &text[detected.start..], line: detected.line };
    let prepared = body.prepared(detected.delimiter);
    let mut reader = rows(&prepared, detected.delimiter);
    let (mut row, mut numbers) = (ByteRecord::new(), detected.numbers);
    let mut table = Table::default();
    let mut length = None;
    while reader.read_byte_record(&mut row).map_err(|e| unreadable(path, e))? {
        let line = body.line_of(&row, &prepared);
        let expected = *length.get_or_insert(row.len());
        if row.len() != expected {
            let (file, found, delimiter) = (path.to_owned(), row.len(), detected.delimiter.into());
            let first_line = detected.line;
            return Err(RecordingError::RowLength { file, line, first_line, expected, found, delimiter });
        }
        table.columns.push(channel(&row, table.columns.len() + 1, dialect, wanted, &mut numbers, line));
    }
    Ok((table, detected.dialect(dialect, numbers, false)))
}

fn channel(
    row: &ByteRecord,
    number: usize,
    dialect: &Dialect,
    wanted: RequestedColumns<'_>,
    numbers: &mut Numbers,
    line: u64,
) -> Column {
    let name = row.get(0).map(|cell| characters(cell).trim().to_owned()).filter(|cell| is_name(cell, *numbers));
    let first = usize::from(name.is_some());
    let name = name.unwrap_or_else(|| number.to_string());
    let mut values = Values::default();
    if wanted.includes(&name) || wanted.includes_number(number) {
        row.iter().skip(first).for_each(|cell| values.push(cell, numbers, || line));
    }
    Column { in_rows: true, ..values.into_column(name, dialect.day_first) }
}

fn is_name(cell: &str, mut numbers: Numbers) -> bool {
    !cell.is_empty() && numbers.read(cell.as_bytes()).is_none() && Stamp::parse(cell).is_none()
}

/// Whether a text has few lines of many cells, unless its first line is said to name columns.
pub(super) fn is_evident(text: &[u8], path: &Path, dialect: &Dialect) -> bool {
    let with_content = lines(text).filter(|line| !line.bytes(text).trim_ascii().is_empty());
    let count = with_content.take(MOST_LINES + 1).count();
    if count > MOST_LINES || dialect.header == Some(true) {
        return false;
    }
    let in_rows = Dialect { channels_in_rows: true, ..*dialect };
    let Ok(detected) = in_rows.detect(text, path) else { return false };
    let body = Body { bytes: &text[detected.start..], line: detected.line };
    let prepared = body.prepared(detected.delimiter);
    let mut row = ByteRecord::new();
    let is_read = rows(&prepared, detected.delimiter).read_byte_record(&mut row).is_ok();
    is_read && is_wide(row.len(), count)
}

/// Whether cells of a line are so many more than the lines that these are channels.
pub(super) fn is_wide(cells: usize, lines: usize) -> bool {
    cells > LEAST_CELLS && cells >= WIDER * lines
}
