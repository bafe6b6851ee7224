//! The content of a file.

use std::path::Path;

use serde::Serialize;
use thetahat::recording::{ColumnSummary, Contents};
use thetahat_report::report::{self, TextWidth};

/// A recording.
#[derive(Serialize)]
pub(super) struct RecordingAnswer {
    path: String,
    /// The lines of the command `inspect`.
    text: String,
    format: String,
    samples: usize,
    rate_hz: Option<f64>,
    channels: Vec<Channel>,
}

/// A column, or a variable of several.
#[derive(Serialize)]
struct Channel {
    /// The name for requests: `NAME`, or `FILE:NAME` if several files have the name.
    name: String,
    rows: usize,
    columns: usize,
    smallest: Option<f64>,
    largest: Option<f64>,
    note: Option<String>,
}

impl RecordingAnswer {
    /// One of several files.
    pub(super) fn of(path: &Path, contents: &Contents, all: &[(&Path, Contents)]) -> Self {
        let shared = |name: &str| all.iter().filter(|(_, other)| columns(other).any(|c| c.name == name)).count() > 1;
        let channel = |column: &ColumnSummary| {
            let name =
                if shared(&column.name) { format!("{}:{}", path.display(), column.name) } else { column.name.clone() };
            Channel::of(column, name)
        };
        let table = contents.tables.iter().max_by_key(|table| table.columns.len());
        Self {
            path: path.display().to_string(),
            text: report::contents_text(contents, TextWidth::default()),
            format: contents.format.to_string(),
            samples: table.map_or(0, |table| table.samples),
            rate_hz: contents.tables.iter().flat_map(|table| &table.times).map(|time| time.rate_hz).next(),
            channels: columns(contents).map(channel).collect(),
        }
    }
}

impl Channel {
    fn of(column: &ColumnSummary, name: String) -> Self {
        let ends = || column.statistics.iter();
        Self {
            name,
            rows: column.samples,
            columns: column.channels,
            smallest: ends().filter_map(|channel| channel.min).reduce(f64::min),
            largest: ends().filter_map(|channel| channel.max).reduce(f64::max),
            note: column.not_numeric.clone(),
        }
    }
}

fn columns(contents: &Contents) -> impl Iterator<Item = &ColumnSummary> {
    contents.tables.iter().flat_map(|table| &table.columns)
}
