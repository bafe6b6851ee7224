//! The dialect of a text file: delimiter, decimal sign, header. Unset parts are detected; an ambiguous one is an error.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::super::error::RecordingError;
use super::number::{Decimal, Numbers};
use super::text::{Text, rows};

/// How a text file is written. Parts that are none are detected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Dialect {
    /// The character between cells; a space stands for any number of spaces.
    pub delimiter: Option<char>,
    /// The decimal sign; still none in a detected dialect if no number has one.
    pub decimal: Option<Decimal>,
    /// Whether the first line names the columns.
    pub header: Option<bool>,
    /// Whether an incomplete last line is left out; in a detected dialect, whether one was.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub drop_cut_line: bool,
}

/// Delimiters that are detected.
const DELIMITERS: [u8; 5] = *b"\t;|, ";
/// Bytes of a text that are examined to detect its dialect.
const SAMPLE_BYTES: usize = 1 << 16;
const SAMPLE_ROWS: usize = 64;

impl Dialect {
    /// The delimiter and whether there is a header, as set or as detected.
    pub(super) fn detect(&self, text: &Text<'_>, path: &Path) -> Result<(u8, bool), RecordingError> {
        let beginning = text.beginning(SAMPLE_BYTES);
        let candidates = match self.delimiter {
            Some(delimiter) => vec![self.checked(delimiter, path)?],
            None => DELIMITERS.into_iter().filter(|&d| d != b',' || self.decimal != Some(Decimal::Comma)).collect(),
        };
        let samples: Vec<Sample> = candidates.into_iter().map(|d| Sample::of(&beginning, d, self.decimal)).collect();
        let sample = best(&samples, path)?;
        let header = self.header.map_or_else(|| sample.header(path), Ok)?;
        Ok((sample.delimiter, header))
    }

    fn checked(&self, delimiter: char, path: &Path) -> Result<u8, RecordingError> {
        let within_numbers = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '+' | '-' | '"' | '\n' | '\r');
        match u8::try_from(delimiter) {
            Ok(byte) if byte.is_ascii() && !within_numbers(delimiter) => Ok(byte),
            _ => Err(RecordingError::BadDelimiter { file: path.to_owned(), found: delimiter }),
        }
    }
}

/// The first rows of a text, split at a given delimiter.
struct Sample {
    delimiter: u8,
    rows: Vec<Row>,
    /// Line number of the first row.
    line: u64,
}

/// For each cell, whether it is a number.
type Row = Vec<bool>;

impl Sample {
    fn of(text: &Text<'_>, delimiter: u8, decimal: Option<Decimal>) -> Self {
        let prepared = text.prepared(delimiter);
        let mut sample = Self { delimiter, rows: Vec::new(), line: 0 };
        for row in rows(&prepared, delimiter).byte_records().take(SAMPLE_ROWS).flatten() {
            if sample.rows.is_empty() {
                sample.line = text.line(&row);
            }
            let number = |cell| Numbers::new(decimal, delimiter).read(cell).is_some();
            sample.rows.push(row.iter().map(number).collect());
        }
        sample
    }

    /// The rows below the first, or the first if it is the only one.
    fn data(&self) -> &[Row] {
        if self.rows.len() > 1 { &self.rows[1..] } else { &self.rows }
    }

    fn width(&self) -> usize {
        self.rows.first().map_or(0, Vec::len)
    }

    /// Number of rows as long as the first.
    fn agreeing(&self) -> usize {
        self.rows.iter().filter(|row| row.len() == self.width()).count()
    }

    fn is_consistent(&self) -> bool {
        self.agreeing() == self.rows.len()
    }

    /// The fraction of cells that are numbers.
    fn numeric(&self) -> f64 {
        let cells = self.data().iter().flatten();
        cells.clone().filter(|number| **number).count() as f64 / cells.count().max(1) as f64
    }

    /// Whether every line is one number, judged by the first rows.
    fn is_one_column(&self) -> bool {
        self.width() == 1 && self.is_consistent() && self.data().iter().flatten().all(|number| *number)
    }

    /// Whether the first row names the columns: true if it has text above numbers.
    fn header(&self, path: &Path) -> Result<bool, RecordingError> {
        let Some(first) = self.rows.first() else { return Ok(false) };
        if first.iter().all(|number| *number) {
            return Ok(false);
        }
        let above_numbers = |i: &usize| self.data().iter().all(|row| row.get(*i) == Some(&true));
        let numbers: Vec<usize> = (0..first.len()).filter(above_numbers).collect();
        match (numbers.iter().any(|&i| first[i]), numbers.iter().any(|&i| !first[i])) {
            (true, true) => Err(RecordingError::UnclearHeader { file: path.to_owned(), line: self.line }),
            (numbers_above, _) => Ok(!numbers_above),
        }
    }
}

/// The one of several readings of a text that is a table of numbers.
fn best<'a>(samples: &'a [Sample], path: &Path) -> Result<&'a Sample, RecordingError> {
    let tables: Vec<&Sample> = samples.iter().filter(|s| s.width() > 1 && s.is_consistent()).collect();
    let most = tables.iter().map(|s| s.numeric()).fold(0.0, f64::max);
    let mut likely = tables.into_iter().filter(|s| s.numeric() == most);
    match (likely.next(), likely.next()) {
        (Some(one), None) => Ok(one),
        (Some(one), Some(other)) => Err(RecordingError::UnclearDelimiter {
            file: path.to_owned(),
            line: one.line,
            found: [one.delimiter.into(), other.delimiter.into()],
        }),
        (None, _) => inconsistent(samples, path),
    }
}

/// If no delimiter gives rows of equal length: a single column, otherwise the best delimiter, whose error then names the row. A comma is
/// then a delimiter, not the decimal sign of a single column, unless that is set.
fn inconsistent<'a>(samples: &'a [Sample], path: &Path) -> Result<&'a Sample, RecordingError> {
    let comma = samples.iter().find(|s| s.delimiter == b',').or(samples.first());
    let column = comma.filter(|s| s.is_one_column());
    let nearest = || samples.iter().filter(|s| s.width() > 1).max_by_key(|s| s.agreeing());
    column.or_else(nearest).or(comma).ok_or_else(|| RecordingError::EmptyFile { file: path.to_owned() })
}
