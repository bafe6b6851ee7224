//! Signals read in pieces, so that a recording may be longer than memory.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::csv::TextPieces;
use super::error::RecordingError;
use super::format::Format;
use super::npy::ArrayPieces;
#[cfg(feature = "parquet")]
use super::parquet::{DatasetInfo, GroupPieces};
use super::place::file_length;
use super::reader::TableOptions;
use super::select;
use super::source::{ChannelSource, require_units_of_file};
use super::table::{Column, MissingValues, RequestedColumns, Table};
use thetahat_ground::series::Series;

/// Signals whose files can be read from any sample on: text, uncompressed NumPy arrays, and Parquet.
///
/// The pieces together equal the result of [`read_channels`](super::read_channels); several pieces may be read at a time.
pub struct SignalPieces {
    files: Vec<FilePieces>,
    signals: Vec<Signal>,
}

struct Signal {
    source: ChannelSource,
    path: PathBuf,
    format: Format,
    /// Its index in the list of files.
    file: usize,
    factors: Vec<f64>,
}

enum FilePieces {
    Text(TextPieces),
    Arrays(Vec<ArrayPieces>),
    #[cfg(feature = "parquet")]
    Groups(Box<GroupPieces>),
}

impl SignalPieces {
    /// Scans the files of some signals; none if one of them cannot be read in pieces.
    ///
    /// # Errors
    /// [`RecordingError`] as [`read_channels`](super::read_channels), for errors at the beginnings of the files.
    pub fn open(sources: &[&ChannelSource], root: &Path) -> Result<Option<Self>, RecordingError> {
        let mut pieces = Self { files: Vec::new(), signals: Vec::new() };
        if !sources.iter().all(|source| source.can_be_read_in_pieces()) {
            return Ok(None);
        }
        for &source in sources {
            source.refuse_repetition()?;
            let format = source.format(root)?;
            source.refuse_useless_settings(format)?;
            let path = source.place(root)?;
            let shared = pieces.signals.iter().find(|s| s.path == path && s.source.dialect() == source.dialect());
            let file = shared.map_or(pieces.files.len(), |s| s.file);
            if file == pieces.files.len() {
                let of_file = |s: &&&ChannelSource| s.file == source.file && s.dialect() == source.dialect();
                let wanted = columns(sources.iter().filter(of_file).copied());
                let options =
                    TableOptions { dialect: source.dialect(), episode: source.episode, root: source.root(root) };
                let Some(opened) = FilePieces::open(&options, format, &path, wanted.as_deref())? else {
                    return Ok(None);
                };
                pieces.files.push(opened);
            }
            let signal = Signal { source: source.clone(), path, format, file, factors: Vec::new() };
            let asked = columns([source].into_iter());
            if pieces.files[file].samples(wanted(asked.as_deref())).is_none_or(|samples| samples == 0) {
                return Ok(None);
            }
            pieces.signals.push(signal);
            let number = pieces.signals.len() - 1;
            let channels = pieces.read(&[number], 0..1)?.first().map_or(0, Series::channels);
            pieces.signals[number].factors = source.factors(channels)?;
        }
        Ok(Some(pieces))
    }

    /// Number of samples of a signal, by its index in the list that was opened.
    #[must_use]
    pub fn samples(&self, signal: usize) -> usize {
        let signal = &self.signals[signal];
        let asked = columns([&signal.source].into_iter());
        self.files[signal.file].samples(wanted(asked.as_deref())).unwrap_or(0)
    }

    /// These samples of some of the signals, in SI units.
    ///
    /// # Errors
    /// [`RecordingError`] as [`read_channels`](super::read_channels).
    pub fn read(&self, signals: &[usize], range: Range<usize>) -> Result<Vec<Series>, RecordingError> {
        let mut all: Vec<Option<Series>> = signals.iter().map(|_| None).collect();
        for (number, file) in self.files.iter().enumerate() {
            let asked: Vec<(usize, &Signal)> = (signals.iter().map(|&s| &self.signals[s]).enumerate())
                .filter(|(_, signal)| signal.file == number)
                .collect();
            if asked.is_empty() {
                continue;
            }
            let names = columns(asked.iter().map(|(_, signal)| &signal.source));
            let table = file.read(range.clone(), wanted(names.as_deref()))?;
            for (place, signal) in asked {
                all[place] = Some(signal.series(&table, range.start)?);
            }
        }
        Ok(all.into_iter().flatten().collect())
    }
}

impl Signal {
    fn series(&self, table: &Table, first: usize) -> Result<Series, RecordingError> {
        let in_file = |mut error| {
            if let RecordingError::NotFiniteSample { sample, .. } = &mut error {
                *sample += first;
            }
            error
        };
        let columns = select::columns(table, self.format, &self.source.columns, &self.path)?;
        require_units_of_file(&self.source, &columns, &self.path)?;
        let mut series = columns.series(&self.path, MissingValues::Refused).map_err(in_file)?;
        if !self.factors.is_empty() {
            for sample in series.values_mut().chunks_exact_mut(self.factors.len()) {
                sample.iter_mut().zip(&self.factors).for_each(|(value, factor)| *value *= factor);
            }
        }
        Ok(series)
    }
}

/// The columns that sources name; none if one of them uses all columns.
fn columns<'a>(sources: impl Iterator<Item = &'a ChannelSource>) -> Option<Vec<String>> {
    let mut names = Vec::new();
    for source in sources {
        if source.columns.is_empty() {
            return None;
        }
        names.extend(source.columns.iter().cloned());
    }
    Some(names)
}

fn wanted(columns: Option<&[String]>) -> RequestedColumns<'_> {
    columns.map_or(RequestedColumns::All, RequestedColumns::Named)
}

impl FilePieces {
    fn open(
        options: &TableOptions<'_>,
        format: Format,
        path: &Path,
        columns: Option<&[String]>,
    ) -> Result<Option<Self>, RecordingError> {
        match format {
            Format::Csv => Ok(TextPieces::open(path, &options.dialect, wanted(columns))?.map(Self::Text)),
            Format::Npy => {
                let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                let array = ArrayPieces::open(path, name, 0, file_length(path)?)?;
                Ok(array.map(|array| Self::Arrays(vec![array])))
            }
            Format::Npz => archive(path, wanted(columns)),
            #[cfg(feature = "parquet")]
            Format::Parquet => {
                let info = DatasetInfo::of(path, options.root);
                Ok(GroupPieces::open(path, info, wanted(columns))?.map(|pieces| Self::Groups(Box::new(pieces))))
            }
            // The others are read whole.
            _ => Ok(None),
        }
    }

    /// Number of samples of the requested columns; none if they differ.
    fn samples(&self, wanted: RequestedColumns<'_>) -> Option<usize> {
        match self {
            Self::Text(text) => Some(text.rows()),
            #[cfg(feature = "parquet")]
            Self::Groups(groups) => Some(groups.samples()),
            Self::Arrays(arrays) => {
                let mut samples = arrays.iter().filter(|a| wanted.includes(a.name())).map(ArrayPieces::samples);
                let first = samples.next()?;
                samples.all(|other| other == first).then_some(first)
            }
        }
    }

    fn read(&self, range: Range<usize>, wanted: RequestedColumns<'_>) -> Result<Table, RecordingError> {
        match self {
            Self::Text(text) => text.read(range, wanted),
            #[cfg(feature = "parquet")]
            Self::Groups(groups) => groups.read(range, wanted),
            Self::Arrays(arrays) => {
                let column = |array: &ArrayPieces| match wanted.includes(array.name()) {
                    true => array.read(range.clone()),
                    false => Ok(Column::of_numbers(array.name().to_owned(), 0, Vec::new())),
                };
                let columns = arrays.iter().map(column).collect::<Result<_, _>>()?;
                Ok(Table { name: String::new(), columns })
            }
        }
    }
}

#[cfg(feature = "npz")]
fn archive(path: &Path, wanted: RequestedColumns<'_>) -> Result<Option<FilePieces>, RecordingError> {
    Ok(super::npz::stored_arrays(path, wanted)?.map(FilePieces::Arrays))
}

/// None: the reader of whole files reports the required feature.
#[cfg(not(feature = "npz"))]
fn archive(_: &Path, _: RequestedColumns<'_>) -> Result<Option<FilePieces>, RecordingError> {
    Ok(None)
}

#[cfg(test)]
mod tests {
    use thetahat_testing::Folder;

    use super::super::test_files::npy;
    use super::*;
    use crate::recording::read_channels;

    fn source(text: &str) -> ChannelSource {
        toml::from_str(text).unwrap()
    }

    /// Every piece of a file equals that piece of the whole.
    fn assert_same(file: &str, bytes: &[u8], sources: &[&str]) {
        let folder = Folder::with(file, bytes);
        let sources: Vec<ChannelSource> =
            sources.iter().map(|s| source(&format!("file = '{file}'\nunit = 'mm'\n{s}"))).collect();
        let pieces = SignalPieces::open(&sources.iter().collect::<Vec<_>>(), folder.path()).unwrap().unwrap();
        let all: Vec<usize> = (0..sources.len()).collect();
        let whole: Vec<Series> = sources.iter().map(|s| read_channels(s, folder.path()).unwrap()).collect();
        let samples = whole[0].len();
        assert_eq!(pieces.samples(0), samples);
        for range in [0..samples, 0..1, samples - 1..samples, samples / 3..samples / 2 + 1, 1023..1025, 1024..2048] {
            if range.end > samples {
                continue;
            }
            for (piece, whole) in pieces.read(&all, range.clone()).unwrap().iter().zip(&whole) {
                assert_eq!(*piece, whole.window(range.clone()), "{file} {range:?}");
            }
        }
    }

    fn rows(count: usize, line: impl Fn(usize) -> String) -> String {
        (0..count).map(line).collect()
    }

    #[test]
    fn text_in_all_dialects() {
        let body = rows(3000, |k| format!("{k}.5,{},-1e-3\n", 2 * k));
        let columns = ["columns = ['a', 'b']", "columns = ['c']"];
        assert_same("q.csv", format!("a,b,c\n{body}").as_bytes(), &columns);
        assert_same("q.csv", format!("\u{feff}# made\n\n% by\na,b,c\r\n{body}\r\n\n").as_bytes(), &columns);
        assert_same("q.csv", format!("a,b,c\n{}", body.replace('\n', "\r\n")).as_bytes(), &columns);
        assert_same("q.csv", body.trim_end().as_bytes(), &["", "columns = ['2']"]);
        let semicolons = rows(2500, |k| format!("{k},5;{k}\n\n"));
        assert_same("q.csv", semicolons.as_bytes(), &[""]);
        let spaces = rows(2100, |k| format!("  {k}.25   {k}  \n   \n"));
        assert_same("q.txt", format!("a  b \n{spaces}").as_bytes(), &["columns = ['b']", "columns = ['a']"]);
        let tabs = rows(2100, |k| format!("{k}.25\t{k}\n"));
        assert_same("q.tsv", tabs.as_bytes(), &[""]);
    }

    #[test]
    fn lines_longer_than_the_buffer_of_the_first_pass_together() {
        let body = rows(60_000, |k| format!("{k}.123456789012345,{k}.5\n"));
        assert_same("q.csv", format!("a,b\n{body}").as_bytes(), &["columns = ['b']"]);
    }

    #[test]
    fn arrays() {
        let values: Vec<u8> = (0..6000).flat_map(|k| f64::from(k).to_le_bytes()).collect();
        for fortran in [false, true] {
            assert_same("q.npy", &npy("<f8", fortran, "(3000, 2)", &values), &["", "columns = ['q[2]']"]);
        }
        let floats: Vec<u8> = (0..6000).flat_map(|k| (k as f32).to_be_bytes()).collect();
        assert_same("q.npy", &npy(">f4", false, "(2000, 3)", &floats), &[""]);
    }

    #[test]
    fn what_needs_the_whole_file_is_left_to_its_reader() {
        for (name, text) in [("q.csv", "a,b\n\"1.5\",2\n"), ("q.csv", "a,b\r1.5,2\r"), ("q.mat", "MATLAB")] {
            let folder = Folder::with(name, text.as_bytes());
            let source = source(&format!("file = '{name}'\nunit = 'mm'"));
            assert!(SignalPieces::open(&[&source], folder.path()).unwrap().is_none(), "{text:?}");
        }
    }

    #[test]
    fn what_is_wrong_is_found_where_it_is() {
        // Longer than the part that is examined first.
        let good = rows(5000, |k| format!("{k}.5,{:>300}\n", 1));
        let of = |bad: &str| {
            let folder = Folder::with("q.csv", format!("{good}{bad}\n{good}").as_bytes());
            let source = source("file = 'q.csv'\nunit = 'mm'");
            let pieces = SignalPieces::open(&[&source], folder.path()).unwrap().unwrap();
            pieces.read(&[0], 4990..5010).unwrap_err()
        };
        assert!(matches!(of("x,1"), RecordingError::NotANumber { line: 5001, .. }));
        assert!(matches!(of("nan,1"), RecordingError::NotFinite { line: 5001, .. }));
        assert!(matches!(of("1"), RecordingError::RowLength { line: 5001, expected: 2, found: 1, .. }));
    }
}
