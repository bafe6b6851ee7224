//! The dialect of a text file: delimiter, decimal sign, header. Unset parts are detected; an ambiguous one is an error.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::super::error::RecordingError;
use super::joint_states::JointColumns;
use super::names::column_names;
use super::number::{Decimal, Numbers};
use super::sample::Sample;
use super::text::{Line, joined_lines, lines};

/// How a text file is written. Parts that are none are detected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Dialect {
    /// The character between cells; a space stands for any number of spaces.
    pub delimiter: Option<char>,
    /// The decimal sign; still none in a detected dialect if no number has one.
    pub decimal: Option<Decimal>,
    /// Whether a line names the columns.
    pub header: Option<bool>,
    /// Whether an incomplete last line is left out; in a detected dialect, whether one was.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub drop_cut_line: bool,
    /// Number of lines above the table, such as titles and comments; none in a detected dialect if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skip_lines: Option<u64>,
    /// Whether each line, not each column, is a channel.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub channels_in_rows: bool,
    /// Whether the day stands before the month in dates such as `03.05.2024`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub day_first: Option<bool>,
}

/// A detected dialect, and where the table is.
pub(super) struct Detected {
    pub(super) delimiter: u8,
    pub(super) numbers: Numbers,
    /// The names of the columns, each different; none if they are numbered.
    pub(super) names: Option<Vec<String>>,
    /// Number of columns; none if the rows differ.
    pub(super) width: Option<usize>,
    /// The joints of the columns, where every row names them.
    pub(super) joints: JointColumns,
    /// The first byte of the values.
    pub(super) start: usize,
    /// The line of the first values, from 1.
    pub(super) line: u64,
    /// The first line of the table: that of the names, or of the first values.
    pub(super) first_line: u64,
}

/// Delimiters that are detected.
const DELIMITERS: [u8; 5] = *b"\t;|, ";
/// Bytes of a text that are examined to detect its dialect.
const SAMPLE_BYTES: usize = 1 << 16;
const SAMPLE_ROWS: usize = 256;
/// Lines that are examined however long they are.
const LEAST_ROWS: usize = 2;

impl Dialect {
    /// The dialect as set or as detected in a text in UTF-8 or Latin-1.
    pub(super) fn detect(&self, text: &[u8], path: &Path) -> Result<Detected, RecordingError> {
        let candidates = match self.delimiter {
            Some(delimiter) => vec![self.checked(delimiter, path)?],
            None => DELIMITERS.into_iter().filter(|&d| d != b',' || self.decimal != Some(Decimal::Comma)).collect(),
        };
        let lines = joined_lines(text, &self.first_lines(text));
        let header = if self.channels_in_rows { Some(false) } else { self.header };
        let samples: Vec<Sample> =
            candidates.into_iter().map(|d| Sample::of(text, &lines, d, self.decimal, header)).collect();
        let sample = best(&samples, path)?;
        if header.is_none() && sample.begins_unclearly() {
            let line = sample.line(sample.table.values).map_or(1, |line| line.number);
            return Err(RecordingError::UnclearHeader { file: path.to_owned(), line });
        }
        Ok(self.detected(text, sample))
    }

    fn detected(&self, text: &[u8], sample: &Sample<'_>) -> Detected {
        let values = sample.line(sample.table.values);
        let names = sample.table.names.and_then(|row| sample.line(row));
        let line = values.map_or(1, |line| line.number);
        let of_columns = column_names(sample);
        Detected {
            delimiter: sample.delimiter,
            numbers: sample.numbers(self.decimal),
            joints: JointColumns::of(sample, of_columns.as_deref()),
            names: of_columns,
            width: sample.is_consistent().then(|| sample.width()),
            start: values.map_or(text.len(), |line| line.start),
            line,
            first_line: names.map_or(line, |line| line.number),
        }
    }

    /// The first lines that are not empty, after those to be skipped.
    fn first_lines(&self, text: &[u8]) -> Vec<Line> {
        let skipped = usize::try_from(self.skip_lines.unwrap_or_default()).unwrap_or(usize::MAX);
        let is_empty = |line: &Line| line.bytes(text).trim_ascii().is_empty();
        let with_content = lines(text).skip(skipped).filter(|line| !is_empty(line) && !names_delimiter(line, text));
        let first = |(count, line): &(usize, Line)| *count < LEAST_ROWS || line.start < SAMPLE_BYTES;
        with_content.enumerate().take_while(first).map(|(_, line)| line).take(SAMPLE_ROWS).collect()
    }

    fn checked(&self, delimiter: char, path: &Path) -> Result<u8, RecordingError> {
        let within_numbers = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '+' | '-' | '"' | '\n' | '\r');
        match u8::try_from(delimiter) {
            Ok(byte) if byte.is_ascii() && !within_numbers(delimiter) => Ok(byte),
            _ => Err(RecordingError::BadDelimiter { file: path.to_owned(), found: delimiter }),
        }
    }
}

/// Whether a line is the first and only states the delimiter for a spreadsheet: `sep=;`.
fn names_delimiter(line: &Line, text: &[u8]) -> bool {
    let bytes = line.bytes(text).trim_ascii();
    line.number == 1 && bytes.len() <= 5 && bytes.get(..4).is_some_and(|start| start.eq_ignore_ascii_case(b"sep="))
}

impl Detected {
    /// The dialect after a file was read.
    pub(super) fn dialect(&self, set: &Dialect, numbers: Numbers, is_cut: bool) -> Dialect {
        Dialect {
            delimiter: Some(self.delimiter.into()),
            decimal: numbers.decimal(),
            header: Some(self.names.is_some()),
            drop_cut_line: is_cut,
            skip_lines: Some(self.first_line - 1).filter(|skipped| *skipped > 0),
            ..*set
        }
    }
}

/// The one of several readings of a text that is a table of numbers.
fn best<'a, 'b>(samples: &'b [Sample<'a>], path: &Path) -> Result<&'b Sample<'a>, RecordingError> {
    if !samples.iter().any(Sample::has_rows) {
        return Err(RecordingError::EmptyFile { file: path.to_owned() });
    }
    let tables: Vec<&Sample> = samples.iter().filter(|s| s.width() > 1 && s.is_consistent()).collect();
    let most = tables.iter().map(|s| s.numeric()).fold(0.0, f64::max);
    let mut likely = tables.into_iter().filter(|s| s.numeric() == most);
    match (likely.next(), likely.next()) {
        (Some(one), None) => Ok(one),
        (Some(one), Some(other)) => Err(RecordingError::UnclearDelimiter {
            file: path.to_owned(),
            line: one.line(one.table.names.unwrap_or(one.table.values)).map_or(1, |line| line.number),
            found: [one.delimiter.into(), other.delimiter.into()],
        }),
        (None, _) => inconsistent(samples, path),
    }
}

/// If no delimiter gives rows of equal length: a single column, otherwise the best delimiter, whose error then names the row. A comma is
/// then a delimiter, not the decimal sign of a single column, unless that is set.
fn inconsistent<'a, 'b>(samples: &'b [Sample<'a>], path: &Path) -> Result<&'b Sample<'a>, RecordingError> {
    let comma = samples.iter().find(|s| s.delimiter == b',').or(samples.first());
    let column = comma.filter(|s| s.is_one_column());
    let nearest = || samples.iter().filter(|s| s.width() > 1).max_by_key(|s| s.agreeing());
    column.or_else(nearest).or(comma).ok_or_else(|| RecordingError::EmptyFile { file: path.to_owned() })
}
