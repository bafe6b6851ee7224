//! The columns of a file as its reader returns them: numbers by name, with the flaw of each column, nothing rejected yet. Reading a signal
//! rejects flawed columns, inspecting a file reports them.

use std::path::Path;

use super::error::RecordingError;

/// Columns that belong together in a file: a CSV file, the variables of a MAT file, a topic.
#[derive(Debug, Clone, Default)]
pub(super) struct Table {
    /// Name of the topic; empty if the file is one table.
    pub(super) name: String,
    pub(super) columns: Vec<Column>,
}

/// One named column, or variable of several columns.
#[derive(Debug, Clone)]
pub(super) struct Column {
    pub(super) name: String,
    /// Number of channels, one for each column of a matrix.
    pub(super) channels: usize,
    /// Channel by channel: all samples of the first, then all of the second, and so on.
    pub(super) values: Vec<f64>,
    pub(super) flaw: Option<Flaw>,
    /// Whether the channels are the rows of a matrix, which was transposed.
    pub(super) in_rows: bool,
    /// Whether the values are seconds, read from dates or times of day.
    pub(super) in_seconds: bool,
    /// Names of the channels; none if they are numbered only.
    pub(super) channel_names: Vec<String>,
}

/// Why a column cannot be read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Flaw {
    /// The first cell that is not a number; such cells are NaN among the values.
    Text { line: u64, found: String },
    /// The first cell that is NaN, infinite or implausibly large, if the file has lines.
    NotFinite { line: u64, found: f64 },
    /// The first of several dates whose order of day and month is not evident.
    UnclearDate { line: u64, found: String },
    /// The first row whose joints are in another order, and a joint where another one was before.
    JointOrder { line: u64, expected: String, found: String },
    /// The whole column is not numeric: a phrase such as `text` or `a cell array`. It has no values.
    Kind(String),
}

impl Flaw {
    /// Whether it is an empty cell or a NaN: a value that the logger did not have.
    pub(super) fn is_missing_value(&self) -> bool {
        match self {
            Self::Text { found, .. } => found.trim().is_empty(),
            Self::NotFinite { found, .. } => found.is_nan(),
            Self::UnclearDate { .. } | Self::JointOrder { .. } | Self::Kind(_) => false,
        }
    }
}

/// What is done with values that a logger did not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MissingValues {
    Refused,
    /// They are NaN.
    Kept,
}

impl Column {
    /// A column of numbers: `channels` times the same number of values.
    pub(super) fn of_numbers(name: String, channels: usize, values: Vec<f64>) -> Self {
        let channel_names = Vec::new();
        Self { name, channels, values, flaw: None, in_rows: false, in_seconds: false, channel_names }
    }

    /// A column without numbers that can be read.
    pub(super) fn of_kind(name: String, kind: impl Into<String>) -> Self {
        Self { flaw: Some(Flaw::Kind(kind.into())), ..Self::of_numbers(name, 0, Vec::new()) }
    }

    /// Number of samples of each channel.
    pub(super) fn samples(&self) -> usize {
        self.values.len().checked_div(self.channels).unwrap_or(0)
    }

    pub(super) fn is_numeric(&self) -> bool {
        !matches!(self.flaw, Some(Flaw::Kind(_)))
    }

    /// The samples of one channel, counted from 0.
    pub(super) fn channel(&self, channel: usize) -> &[f64] {
        let samples = self.samples();
        self.values.get(channel * samples..(channel + 1) * samples).unwrap_or_default()
    }

    /// Makes the rows of a matrix its channels.
    pub(super) fn transpose(&mut self) {
        let (samples, channels) = (self.samples(), self.channels);
        if channels <= 1 {
            return;
        }
        let values = &self.values;
        self.values = (0..samples).flat_map(|row| (0..channels).map(move |c| values[c * samples + row])).collect();
        self.channels = samples;
        self.in_rows = true;
    }

    /// Refuses a flawed column, or one without samples.
    pub(super) fn require_sound(&self, file: &Path, missing: MissingValues) -> Result<(), RecordingError> {
        let is_kept = |flaw: &Flaw| missing == MissingValues::Kept && flaw.is_missing_value();
        let (file, column) = (file.to_owned(), self.name.clone());
        match self.flaw.clone().filter(|flaw| !is_kept(flaw)) {
            None if self.samples() == 0 => Err(RecordingError::NoSamples { file }),
            None => Ok(()),
            Some(Flaw::Text { line, found }) => Err(RecordingError::NotANumber { file, line, column, found }),
            Some(Flaw::NotFinite { line, found }) => Err(RecordingError::NotFinite { file, line, column, found }),
            Some(Flaw::UnclearDate { line, found }) => Err(RecordingError::UnclearDate { file, line, column, found }),
            Some(Flaw::JointOrder { line, expected, found }) => {
                Err(RecordingError::JointOrder { file, line, column, expected, found })
            }
            Some(Flaw::Kind(found)) => Err(RecordingError::NotNumeric { file, column, found }),
        }
    }
}

/// Upper bound of recorded values: counts, stamps in nanoseconds and torques are below it; uninitialised memory often is not.
const LARGEST: f64 = 1e30;

/// Whether a number is plausible as a recorded value.
pub(super) fn is_plausible(value: f64) -> bool {
    value.abs() < LARGEST
}

/// The columns to read, so that a reader can skip the others.
#[derive(Clone, Copy)]
pub(super) enum RequestedColumns<'a> {
    All,
    Named(&'a [String]),
}

impl RequestedColumns<'_> {
    /// Whether a column is requested: by its name with or without its unit, one column of it as `name[3]`, or as a part of a time.
    pub(super) fn includes(self, name: &str) -> bool {
        let is_asked = |asked: &str| {
            asked == name || indexed(asked).is_some_and(|(n, _)| n == name) || is_other_spelling(asked, name)
        };
        self.any(|asked| is_asked(asked) || parts_of_time(asked).any(|(a, b)| is_asked(a) || is_asked(b)))
    }

    /// Whether a column is requested by its number, from 1.
    pub(super) fn includes_number(self, number: usize) -> bool {
        let is_asked = |asked: &str| asked.parse() == Ok(number);
        self.any(|asked| is_asked(asked) || parts_of_time(asked).any(|(a, b)| is_asked(a) || is_asked(b)))
    }

    fn any(self, is_asked: impl Fn(&str) -> bool) -> bool {
        match self {
            Self::All => true,
            Self::Named(asked) => asked.iter().any(|asked| is_asked(asked)),
        }
    }
}

/// Whether a name is meant that is asked for without its unit, or with the sign of a comment before it: `q` or `%q` of `q [deg]`.
pub(super) fn is_other_spelling(asked: &str, name: &str) -> bool {
    let plain = asked.trim_start_matches(['%', '#']).trim_start();
    if plain.len() < asked.len() && plain == name {
        return true;
    }
    !asked.is_empty() && name.strip_prefix(asked).is_some_and(|unit| unit.starts_with(" [") && unit.ends_with(']'))
}

/// The parts of `sec+nanosec`, for each sign.
pub(super) fn parts_of_time(asked: &str) -> impl Iterator<Item = (&str, &str)> {
    let parts = asked.match_indices('+').map(|(place, _)| (&asked[..place], &asked[place + 1..]));
    parts.filter(|(seconds, rest)| !seconds.is_empty() && !rest.is_empty())
}

/// The parts of `name[3]`.
pub(super) fn indexed(asked: &str) -> Option<(&str, usize)> {
    let (name, index) = asked.strip_suffix(']')?.rsplit_once('[')?;
    Some((name, index.parse().ok()?))
}
