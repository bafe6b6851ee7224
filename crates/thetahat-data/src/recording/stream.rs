//! Signals of a text that grows, such as a pipe or a file that a logger writes.

use std::path::Path;

use super::csv::TextStream;
use super::error::RecordingError;
use super::format::Format;
use super::select;
use super::source::{ChannelSource, require_units_of_file};
use super::table::{MissingValues, RequestedColumns, Table};
use thetahat_ground::series::Series;

/// Signals that are columns of one text, read as it grows.
///
/// What it gives together equals the result of [`read_channels_with_missing_values`](super::read_channels_with_missing_values).
///
/// ```
/// use thetahat_data::recording::{ChannelSource, SignalStream, Unit};
/// let source = ChannelSource::csv("-", ["q"], Unit::Degree);
/// let mut stream = SignalStream::new(vec![source], "-".as_ref());
/// assert_eq!(stream.read(b"t,q\n0,1", false)?, []);
/// let q = stream.read(b"80\n1,360", true)?;
/// assert!((q[0].sample(1)[0] - std::f64::consts::TAU).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SignalStream {
    text: TextStream,
    sources: Vec<ChannelSource>,
    /// The columns that are read; none means all.
    columns: Option<Vec<String>>,
}

impl SignalStream {
    /// The signals of a text, whose name is that in messages; its dialect is that of the first source.
    #[must_use]
    pub fn new(sources: Vec<ChannelSource>, name: &Path) -> Self {
        let dialect = sources.first().map(ChannelSource::dialect).unwrap_or_default();
        let names = sources.iter().map(|source| Some(source.columns.clone()).filter(|names| !names.is_empty()));
        let columns = names.collect::<Option<Vec<_>>>().map(|names| names.concat());
        Self { text: TextStream::new(name, dialect), sources, columns }
    }

    /// Whether a signal is read alike from a text that grows: in columns of numbers, a channel each.
    #[must_use]
    pub fn can_read(source: &ChannelSource) -> bool {
        source.can_be_read_in_pieces()
    }

    /// Takes bytes; the samples of each signal in the lines that they complete, in SI units, with NaN where a value is missing. Nothing
    /// until the first lines show the dialect. At the end, a line without its end is complete.
    ///
    /// # Errors
    /// [`RecordingError`] as [`read_channels`](super::read_channels), and for times as dates.
    pub fn read(&mut self, bytes: &[u8], is_end: bool) -> Result<Vec<Series>, RecordingError> {
        let wanted = self.columns.as_deref().map_or(RequestedColumns::All, RequestedColumns::Named);
        let Some(table) = self.text.read(bytes, is_end, wanted)? else { return Ok(Vec::new()) };
        self.sources.iter().map(|source| series(source, &table)).collect()
    }
}

fn series(source: &ChannelSource, table: &Table) -> Result<Series, RecordingError> {
    let path = &source.file;
    let columns = select::columns(table, Format::Csv, &source.columns, path)?;
    if let Some((_, column)) = columns.with_channels().find(|(_, column)| column.in_seconds) {
        let reason = format!("column {:?} has dates or times of day; write seconds to a text that grows", column.name);
        return Err(RecordingError::damaged(path, reason));
    }
    require_units_of_file(source, &columns, path)?;
    let mut series = columns.series(path, MissingValues::Kept)?;
    let factors = source.factors(series.channels())?;
    for sample in series.values_mut().chunks_exact_mut(factors.len().max(1)) {
        sample.iter_mut().zip(&factors).for_each(|(value, factor)| *value *= factor);
    }
    Ok(series)
}

#[cfg(test)]
mod tests {
    use thetahat_testing::Folder;

    use super::*;
    use crate::recording::{Unit, read_channels_with_missing_values};

    /// Cut anywhere, a text gives the samples of the whole file.
    #[test]
    fn pieces_of_any_length_are_the_whole() {
        let rows: String = (0..300).map(|k| format!("{k},{}.5,-{k}e-3\r\n", 3 * k)).collect();
        for text in [format!("\u{feff}t,a,b\n{rows}"), rows.replace(',', ";").replace('.', ","), rows] {
            let folder = Folder::with("q.csv", text.as_bytes());
            let columns = if text.contains('a') { ["a", "b"] } else { ["2", "3"] };
            let source = ChannelSource::csv(folder.path().join("q.csv"), columns, Unit::Millimetre);
            let whole = read_channels_with_missing_values(&source, Path::new("")).unwrap();
            for length in [1, 7, 100, 5000, 1 << 20] {
                let mut stream = SignalStream::new(vec![source.clone()], Path::new("-"));
                let mut values = Vec::new();
                for piece in text.as_bytes().chunks(length) {
                    stream.read(piece, false).unwrap().iter().for_each(|s| values.extend_from_slice(s.values()));
                }
                stream.read(b"", true).unwrap().iter().for_each(|s| values.extend_from_slice(s.values()));
                assert_eq!(values, whole.values(), "pieces of {length}");
            }
        }
    }

    #[test]
    fn a_line_that_cannot_be_read_is_named() {
        let source = ChannelSource::csv("-", ["a"], Unit::Radian);
        let lines: String = (0..50).map(|k| format!("{k},1\n")).collect();
        let mut stream = SignalStream::new(vec![source], Path::new("-"));
        stream.read(format!("t,a\n{lines}").as_bytes(), false).unwrap();
        let Err(RecordingError::NotANumber { line, found, .. }) = stream.read(b"50,1\n51,x\n", false) else {
            panic!("a word is no number");
        };
        assert_eq!((line, found.as_str()), (53, "x"));
        let source = ChannelSource::csv("-", ["a"], Unit::Radian);
        let mut short = SignalStream::new(vec![source], Path::new("-"));
        short.read(format!("t,a\n{lines}").as_bytes(), false).unwrap();
        assert!(matches!(short.read(b"50\n51,1\n", false), Err(RecordingError::RowLength { line: 52, .. })));
    }
}
