//! The summaries of a file and its tables, and the walk over a file.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::super::bag::{self, OtherTopic};
use super::super::csv::{self, Dialect};
use super::super::error::RecordingError;
use super::super::format::{Format, Holds};
use super::super::place::file_bytes;
use super::super::reader;
use super::super::table::{Column, Flaw, Table, Wanted};
use super::channel::ChannelSummary;
use super::time::{TimeSummary, times};

/// What a file holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contents {
    /// The file.
    pub file: PathBuf,
    /// Its format.
    pub format: Format,
    /// How a text file is written, as detected.
    pub dialect: Option<Dialect>,
    /// Columns that stand together: a text or Parquet file, variables of equally many samples, or the messages
    /// of a topic that hold the same joints.
    pub tables: Vec<TableSummary>,
    /// Topics of a bag that are not read.
    pub other_topics: Vec<OtherTopic>,
}

/// Columns with equally many samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableSummary {
    /// The topic; empty for other files.
    pub name: String,
    /// Number of samples; zero for variables that are not read.
    pub samples: usize,
    /// The columns or variables.
    pub columns: Vec<ColumnSummary>,
    /// Columns that are times, the likeliest first.
    pub times: Vec<TimeSummary>,
}

/// A column, or a variable of several columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnSummary {
    /// Its name, as a description names it.
    pub name: String,
    /// Number of channels: columns of a matrix.
    pub channels: usize,
    /// Number of samples of each channel.
    pub samples: usize,
    /// What the column holds, if it is not numbers alone.
    pub not_numeric: Option<String>,
    /// A summary of each channel.
    pub statistics: Vec<ChannelSummary>,
}

/// What the file at `path` holds: tables, columns with ranges and resolution, times with rate, jitter and gaps.
///
/// # Errors
/// A [`RecordingError`] if the file cannot be read, is of no known format, is damaged, or has lines of different lengths.
/// Columns of text, values that are not finite and irregular times are not errors but reported.
pub fn inspect(path: &Path) -> Result<Contents, RecordingError> {
    inspect_with_time(path, None)
}

/// The same where the user says which column is the time, as `NAME` or `FILE:NAME`: it is summarised whatever its name.
///
/// # Errors
/// As [`inspect`].
pub fn inspect_with_time(path: &Path, time: Option<&str>) -> Result<Contents, RecordingError> {
    let format = Format::of(path)?;
    let (tables, dialect, other_topics) = match format.holds() {
        Holds::Lines => {
            let bytes = file_bytes(path)?;
            let (table, dialect) = csv::read_with_dialect(&bytes, path, &Dialect::default(), Wanted::All)?;
            (vec![table], Some(dialect), Vec::new())
        }
        Holds::Topics => {
            let (tables, other_topics) = bag::tables(path, format)?;
            (tables, None, other_topics)
        }
        Holds::Arrays => (by_samples(reader::table(path, format, &Dialect::default(), Wanted::All)?), None, Vec::new()),
    };
    Ok(Contents {
        file: path.to_owned(),
        format,
        dialect,
        tables: tables.iter().map(|table| summary(table, format, time)).collect(),
        other_topics,
    })
}

/// Variables of equally many samples together.
fn by_samples(table: Table) -> Vec<Table> {
    let mut tables: Vec<Table> = Vec::new();
    for column in table.columns {
        let samples = column.samples();
        match tables.iter_mut().find(|table| samples_of(table) == samples) {
            Some(table) => table.columns.push(column),
            None => tables.push(Table { name: table.name.clone(), columns: vec![column] }),
        }
    }
    tables
}

fn samples_of(table: &Table) -> usize {
    table.columns.first().map_or(0, Column::samples)
}

fn summary(table: &Table, format: Format, time: Option<&str>) -> TableSummary {
    TableSummary {
        name: table.name.clone(),
        samples: samples_of(table),
        columns: table.columns.iter().map(column_summary).collect(),
        times: times(&table.columns, format.is_bag(), time),
    }
}

fn column_summary(column: &Column) -> ColumnSummary {
    let not_numeric = match &column.flaw {
        Some(Flaw::Kind(kind)) => Some(kind.clone()),
        Some(Flaw::Text { line, found }) => Some(format!("text, such as {found:?} in line {line}")),
        Some(Flaw::NotFinite { .. }) | None => None,
    };
    ColumnSummary {
        name: column.name.clone(),
        channels: column.channels,
        samples: column.samples(),
        not_numeric,
        statistics: (0..column.channels).map(|channel| ChannelSummary::of(column.channel(channel))).collect(),
    }
}
