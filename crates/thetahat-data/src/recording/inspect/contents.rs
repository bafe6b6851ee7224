//! The summaries of a file and its tables, and the reading of a file for them.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::super::bag::{self, OtherTopic};
use super::super::csv::{self, Dialect};
use super::super::error::RecordingError;
use super::super::format::{Format, Holds};
use super::super::place::file_bytes;
use super::super::reader::{self, TableOptions};
use super::super::source::ChannelSource;
use super::super::split_time;
use super::super::table::{Column, Flaw, RequestedColumns, Table};
use super::channel::ChannelSummary;
use super::time::{TimeSummary, is_named, times};
use thetahat_ground::files;

/// The content of a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contents {
    /// The file.
    pub file: PathBuf,
    /// Its format.
    pub format: Format,
    /// How a text file is written, as detected.
    pub dialect: Option<Dialect>,
    /// Groups of columns: a text or Parquet file, variables of equal length, or the messages of a topic with the same joints.
    pub tables: Vec<TableSummary>,
    /// Topics of a bag that are not read.
    pub other_topics: Vec<OtherTopic>,
    /// What a user should know of the file, in sentences: lines above the table, the episode that is read.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// Columns of equal length.
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
    /// Its name, as used in a description.
    pub name: String,
    /// Number of channels: columns of a matrix.
    pub channels: usize,
    /// Whether the channels are the rows of the matrix: it has far more columns than rows.
    pub in_rows: bool,
    /// Number of samples of each channel.
    pub samples: usize,
    /// What the column contains, if it is not only numbers.
    pub not_numeric: Option<String>,
    /// A summary of each channel.
    pub statistics: Vec<ChannelSummary>,
}

/// The content of the file at `path`: tables, columns with ranges and resolution, times with rate, jitter and gaps.
///
/// # Errors
/// A [`RecordingError`] if the file cannot be read, is of no known format, is damaged, or has lines of different lengths.
/// Columns of text, values that are not finite and irregular times are reported and are not errors.
pub fn inspect(path: &Path) -> Result<Contents, RecordingError> {
    inspect_with_time(path, None)
}

/// [`inspect`] where the user names the column of time, as `NAME` or `FILE:NAME`: it is summarised whatever its name.
///
/// # Errors
/// As [`inspect`].
pub fn inspect_with_time(path: &Path, time: Option<&str>) -> Result<Contents, RecordingError> {
    let format = Format::of(path)?;
    let read = FileTables::read(path, format)?;
    Ok(Contents {
        file: path.to_owned(),
        format,
        dialect: read.dialect,
        tables: read.tables.iter().map(|table| summary(table, format, time)).collect(),
        other_topics: read.other_topics,
        notes: read.notes,
    })
}

fn skipped_lines(count: u64) -> String {
    match count {
        1 => "Line 1 is not part of the table.".to_owned(),
        _ => format!("Lines 1 to {count} are not part of the table."),
    }
}

/// Largest file that is searched for times without being asked.
const SMALL_BYTES: u64 = 1 << 26;
/// Relative difference allowed between a stated rate and that of the times.
const RATE_TOLERANCE: f64 = 0.01;

/// A column of times in the file of a signal whose rate contradicts the stated one, and its rate, Hz.
///
/// Only columns with the name of a time count, and only in files of at most 64 MiB; none if the file cannot be read.
#[must_use]
pub fn contradicting_times(source: &ChannelSource, root: &Path, stated_hz: f64) -> Option<(String, f64)> {
    let path = source.path(root);
    let format = Format::of(&path).ok()?;
    if files::length(&path).ok()? > SMALL_BYTES {
        return None;
    }
    if format.holds() == Holds::Lines {
        let names = csv::names(&file_bytes(&path).ok()?, &path, &Dialect::default()).ok()?;
        // The columns of numbers are read only if one of the names is a time's.
        if !names.iter().any(|name| is_named(name)) {
            return None;
        }
    }
    let tables = FileTables::read(&path, format).ok()?.tables;
    let in_table = |table: &Table| times(&table.columns, format.is_bag(), None);
    let named = tables.iter().flat_map(in_table).find(|time| time.is_named)?;
    ((named.rate_hz / stated_hz - 1.0).abs() > RATE_TOLERANCE).then_some((named.column, named.rate_hz))
}

/// The tables of a file, and what else is known of it.
struct FileTables {
    tables: Vec<Table>,
    dialect: Option<Dialect>,
    other_topics: Vec<OtherTopic>,
    notes: Vec<String>,
}

impl FileTables {
    fn read(path: &Path, format: Format) -> Result<Self, RecordingError> {
        match format.holds() {
            Holds::Lines => Self::of_lines(path),
            Holds::Topics => {
                let (tables, other_topics) = bag::tables(path, format)?;
                Ok(Self { tables, dialect: None, other_topics, notes: Vec::new() })
            }
            Holds::Arrays => Self::of_arrays(path, format),
        }
    }

    fn of_lines(path: &Path) -> Result<Self, RecordingError> {
        let bytes = file_bytes(path)?;
        let tolerant = Dialect { drop_cut_line: true, ..Dialect::default() };
        let (mut table, dialect) = csv::read_with_dialect(&bytes, path, &tolerant, RequestedColumns::All)?;
        split_time::add_evident(&mut table);
        table.columns = table.columns.into_iter().flat_map(by_channel_names).collect();
        let notes = dialect.skip_lines.map(skipped_lines).into_iter().collect();
        Ok(Self { tables: vec![table], dialect: Some(dialect), other_topics: Vec::new(), notes })
    }

    fn of_arrays(path: &Path, format: Format) -> Result<Self, RecordingError> {
        let options = TableOptions::default();
        let (mut table, notes) = reader::table_with_notes(path, format, &options, RequestedColumns::All)?;
        table.columns.iter_mut().for_each(set_upright);
        table.columns = table.columns.into_iter().flat_map(by_channel_names).collect();
        split_time::add_evident(&mut table);
        Ok(Self { tables: by_samples(table), dialect: None, other_topics: Vec::new(), notes })
    }
}

/// Number of columns beyond which a matrix with far fewer rows has its channels in the rows.
const WIDE: usize = 100;
/// Least ratio of columns to rows of such a matrix.
const WIDER: usize = 4;

/// Transposes a matrix that has its channels in rows.
fn set_upright(column: &mut Column) {
    if column.channels > WIDE && column.channels >= WIDER * column.samples() {
        column.transpose();
    }
}

/// A column of each named channel; an unnamed column as it is.
fn by_channel_names(column: Column) -> Vec<Column> {
    if column.channel_names.is_empty() || column.channel_names.len() != column.channels {
        return vec![column];
    }
    let of_channel = |(name, channel): (&String, usize)| Column {
        flaw: column.flaw.clone(),
        ..Column::of_numbers(name.clone(), 1, column.channel(channel).to_vec())
    };
    column.channel_names.iter().zip(0..).map(of_channel).collect()
}

/// Groups variables of equal length.
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
    let not_numeric = match column.flaw.as_ref().filter(|flaw| !flaw.is_missing_value()) {
        Some(Flaw::Kind(kind)) => Some(kind.clone()),
        Some(Flaw::Text { line, found }) => Some(format!("text, such as {found:?} in line {line}")),
        Some(Flaw::UnclearDate { line, found }) => Some(format!(
            "dates that may begin with the day or the month, such as {found:?} in line {line}: set day_first"
        )),
        Some(Flaw::JointOrder { line, .. }) => Some(format!("values of another joint from line {line} on")),
        Some(Flaw::NotFinite { .. }) | None => None,
    };
    ColumnSummary {
        name: column.name.clone(),
        channels: column.channels,
        in_rows: column.in_rows,
        samples: column.samples(),
        not_numeric,
        statistics: (0..column.channels).map(|channel| ChannelSummary::of(column.channel(channel))).collect(),
    }
}
