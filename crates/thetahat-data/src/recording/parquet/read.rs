//! Columns of a Parquet file, and any rows of them.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, ConvertedType, LogicalType, Type};
use parquet::column::reader::{ColumnReader, get_column_reader};
use parquet::errors::ParquetError;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::file::serialized_reader::SerializedPageReader;
use parquet::schema::types::{ColumnDescPtr, ColumnDescriptor};

use super::super::budget::Budget;
use super::super::error::RecordingError;
use super::super::panic_guard::panics_as_damage;
use super::super::table::{Column, RequestedColumns, Table};
use super::guard::{Guarded, Pages, Source, description};
use super::lerobot::{DatasetInfo, EPISODE, Episode, note_on_units};
use super::numbers::{Number, Values};

/// Names of the repeated group of a list.
const LISTS: [&str; 2] = ["list", "bag"];

/// The columns of a file, or of one of its episodes, and what a user should know of it; missing values are NaN. Columns that are not
/// requested have a name and no values.
pub(in super::super) fn read_episode(
    bytes: Vec<u8>,
    path: &Path,
    info: DatasetInfo,
    episode: Option<u64>,
    wanted: RequestedColumns<'_>,
) -> Result<(Table, Vec<String>), RecordingError> {
    panics_as_damage(path, "Parquet", || {
        let source = Source::Memory(Bytes::from(bytes));
        let described = Described::new(path, &source, info)?;
        let episode = described.episode(path, &source, episode)?;
        described.require_room(path, source.length(), episode.rows.len(), wanted)?;
        let table = described.table(path, &source, episode.rows, wanted, |_| None)?;
        let note_on_units = note_on_units(table.columns.iter().map(|column| column.name.as_str()));
        Ok((table, episode.note.into_iter().chain(note_on_units).collect()))
    })
}

/// The content of a file as its metadata describes it.
pub(super) struct Described {
    metadata: ParquetMetaData,
    /// Rows of each group.
    rows: Vec<usize>,
    /// Number of rows of all groups.
    pub(super) samples: usize,
    /// What the dataset of the file says of its columns.
    info: DatasetInfo,
}

impl Described {
    pub(super) fn new(path: &Path, source: &Source, info: DatasetInfo) -> Result<Self, RecordingError> {
        let refuse = |e: ParquetError| damaged(path, "description", &e);
        let metadata = description(source).and_then(|bytes| ParquetMetaDataReader::decode_metadata(&bytes));
        let metadata = metadata.map_err(refuse)?;
        let rows = metadata.row_groups().iter().map(|group| usize::try_from(group.num_rows()).unwrap_or(usize::MAX));
        let rows: Vec<usize> = rows.collect();
        let samples = rows.iter().fold(0_usize, |sum, rows| sum.saturating_add(*rows));
        Ok(Self { metadata, rows, samples, info })
    }

    /// Rows of the largest group.
    pub(super) fn largest_group(&self) -> usize {
        self.rows.iter().copied().max().unwrap_or_default()
    }

    /// Refuses more values than a file of this size may contain.
    pub(super) fn require_room(
        &self,
        path: &Path,
        bytes: u64,
        rows: usize,
        wanted: RequestedColumns<'_>,
    ) -> Result<(), RecordingError> {
        let mut budget = Budget::of(path, bytes);
        for index in self.indices().filter(|&index| self.is_read(index, wanted)) {
            let channels = self.channels(index).unwrap_or(1);
            budget.take(&format!("column {:?}", self.name(index)), &[rows, channels])?;
        }
        Ok(())
    }

    /// The rows of an episode; all rows of a file without episodes.
    fn episode(&self, path: &Path, source: &Source, asked: Option<u64>) -> Result<Episode, RecordingError> {
        let numbered = |&index: &usize| self.name(index) == EPISODE && self.kind_not_read(index).is_none();
        let Some(index) = self.indices().find(numbered).filter(|&index| self.channels(index) == Some(1)) else {
            return Episode::whole(self.samples, asked, path);
        };
        Budget::of(path, source.length()).take(EPISODE, &[self.samples])?;
        let numbers = self.values(index, source, 0..self.samples, None);
        let numbers = numbers.map_err(|e| damaged(path, &format!("column {EPISODE:?}"), &e))?;
        Episode::among(&numbers.values, asked, path)
    }

    /// Whether the rows may be of several episodes.
    pub(super) fn has_episodes(&self) -> bool {
        self.indices().any(|index| self.name(index) == EPISODE)
    }

    /// The number of values of each row: one, or that of a list; none if lists have different lengths.
    fn channels(&self, index: usize) -> Option<usize> {
        if self.column(index).max_rep_level() == 0 {
            return Some(1);
        }
        let values =
            self.metadata.row_groups().iter().map(|group| usize::try_from(group.column(index).num_values()).ok());
        let mut of_groups = values
            .zip(&self.rows)
            .filter(|(_, rows)| **rows > 0)
            .map(|(values, rows)| values.filter(|values| values.is_multiple_of(*rows)).map(|values| values / rows));
        let first = of_groups.next()??;
        (first > 0 && of_groups.all(|channels| channels == Some(first))).then_some(first)
    }

    fn column(&self, index: usize) -> ColumnDescPtr {
        self.metadata.file_metadata().schema_descr().column(index)
    }

    fn channel_names(&self, index: usize) -> Vec<String> {
        match self.column(index).max_rep_level() {
            0 => Vec::new(),
            _ => self.info.channel_names(&self.name(index), self.channels(index).unwrap_or_default()),
        }
    }

    /// These rows of all columns. `first` is the origin of a column's stamps; by default the first stamp read.
    pub(super) fn table(
        &self,
        path: &Path,
        source: &Source,
        rows: Range<usize>,
        wanted: RequestedColumns<'_>,
        first: impl Fn(usize) -> Option<i64>,
    ) -> Result<Table, RecordingError> {
        let column = |index: usize| {
            let name = self.name(index);
            if let Some(kind) = self.kind_not_read(index) {
                return Ok(Column::of_kind(name, kind));
            }
            let channel_names = self.channel_names(index);
            if !self.is_read(index, wanted) {
                return Ok(Column { channel_names, ..Column::of_numbers(name, 0, Vec::new()) });
            }
            let refuse = |e: ParquetError| damaged(path, &format!("column {name:?}"), &e);
            let values = self.values(index, source, rows.clone(), first(index)).map_err(refuse)?.values;
            let channels = self.channels(index).unwrap_or(1);
            Ok(Column { channel_names, ..Column::of_numbers(name, channels, by_channel(values, channels)) })
        };
        let columns = self.indices().map(column).collect::<Result<_, _>>()?;
        Ok(Table { name: String::new(), columns })
    }

    /// These rows of a column of numbers.
    pub(super) fn values(
        &self,
        index: usize,
        source: &Source,
        rows: Range<usize>,
        first: Option<i64>,
    ) -> Result<Values, ParquetError> {
        let mut values = Values::of(&self.column(index), first);
        let mut start = 0;
        for (group, &of_group) in self.rows.iter().enumerate() {
            let range = rows.start.max(start)..rows.end.min(start + of_group);
            if !range.is_empty() {
                self.add_group(index, group, source, range.start - start..range.end - start, &mut values)?;
            }
            start += of_group;
        }
        Ok(values)
    }

    pub(super) fn indices(&self) -> Range<usize> {
        0..self.metadata.file_metadata().schema_descr().num_columns()
    }

    /// The path of a column, for lists without that of their elements.
    pub(super) fn name(&self, index: usize) -> String {
        let column = self.column(index);
        let mut parts = column.path().parts();
        if column.max_rep_level() > 0 && parts.len() > 1 {
            parts = &parts[..parts.len() - 1];
            if let [before @ .., last] = parts
                && !before.is_empty()
                && LISTS.contains(&last.as_str())
            {
                parts = before;
            }
        }
        parts.join(".")
    }

    /// Whether a column is requested and contains numbers.
    pub(super) fn is_read(&self, index: usize, wanted: RequestedColumns<'_>) -> bool {
        let is_wanted =
            || wanted.includes(&self.name(index)) || self.channel_names(index).iter().any(|name| wanted.includes(name));
        self.kind_not_read(index).is_none() && is_wanted()
    }

    /// Whether a column contains stamps.
    pub(super) fn is_stamps(&self, index: usize) -> bool {
        Number::of(&self.column(index)).stamps
    }

    /// The kind of a column, if it does not contain numbers that can be read.
    fn kind_not_read(&self, index: usize) -> Option<String> {
        if let Some(kind) = kind_not_read(&self.column(index)) {
            return Some(kind.to_owned());
        }
        if self.channels(index).is_none() {
            return Some("a column of lists of different lengths".to_owned());
        }
        let compression = self.compression_not_read(index)?.to_string();
        Some(format!("a column compressed by {}", compression.split('(').next().unwrap_or_default()))
    }

    /// A compression that is not supported. The library decompresses some of them without a bound.
    fn compression_not_read(&self, index: usize) -> Option<Compression> {
        let compressions = self.metadata.row_groups().iter().map(|group| group.column(index).compression());
        let is_read =
            |c: &Compression| matches!(c, Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_));
        compressions.into_iter().find(|compression| !is_read(compression))
    }

    /// Adds rows of a group, counted within it; pages before them are skipped.
    fn add_group(
        &self,
        index: usize,
        group: usize,
        source: &Source,
        rows: Range<usize>,
        values: &mut Values,
    ) -> Result<(), ParquetError> {
        let chunk = self.metadata.row_group(group).column(index);
        let offsets = [Some(chunk.data_page_offset()), chunk.dictionary_page_offset(), Some(chunk.compressed_size())];
        if offsets.into_iter().flatten().any(|offset| offset < 0) {
            return Err(ParquetError::General("its place in the file is negative".to_owned()));
        }
        let (of_group, channels) = (self.rows[group], self.channels(index).unwrap_or(1));
        let of_chunk = of_group.saturating_mul(channels);
        let limit = of_chunk.saturating_add(1024).saturating_mul(16);
        let guarded = Arc::new(Guarded { source: source.clone(), limit });
        let pages = SerializedPageReader::new(guarded, chunk, of_group, None)?;
        let pages = Pages { pages, limit: of_chunk, has_dictionary: false };
        let lists = (chunk.column_descr().max_rep_level() > 0).then_some(channels);
        match get_column_reader(chunk.column_descr_ptr(), Box::new(pages)) {
            ColumnReader::BoolColumnReader(reader) => values.add(reader, rows, lists, |x, _| f64::from(u8::from(x))),
            ColumnReader::Int32ColumnReader(reader) => values.add(reader, rows, lists, |x, number| number.of_i32(x)),
            ColumnReader::Int64ColumnReader(reader) => values.add(reader, rows, lists, |x, number| number.of_i64(x)),
            ColumnReader::FloatColumnReader(reader) => values.add(reader, rows, lists, |x, _| x.into()),
            ColumnReader::DoubleColumnReader(reader) => values.add(reader, rows, lists, |x, _| x),
            ColumnReader::Int96ColumnReader(_)
            | ColumnReader::ByteArrayColumnReader(_)
            | ColumnReader::FixedLenByteArrayColumnReader(_) => {
                Err(ParquetError::General("the column is not one of numbers".to_owned()))
            }
        }
    }
}

/// Reorders values from sample by sample to channel by channel.
fn by_channel(values: Vec<f64>, channels: usize) -> Vec<f64> {
    if channels == 1 {
        return values;
    }
    (0..channels).flat_map(|channel| values.iter().skip(channel).step_by(channels).copied()).collect()
}

fn damaged(path: &Path, what: &str, error: &ParquetError) -> RecordingError {
    RecordingError::damaged(path, format!("{what}: {error}"))
}

/// The kind of a column, if it does not contain numbers.
fn kind_not_read(column: &ColumnDescriptor) -> Option<&'static str> {
    if column.max_rep_level() > 1 {
        return Some("a column of lists of lists");
    }
    let decimal = matches!(column.converted_type(), ConvertedType::DECIMAL)
        || matches!(column.logical_type_ref(), Some(LogicalType::Decimal(_)));
    match column.physical_type() {
        Type::INT32 | Type::INT64 if decimal => Some("a column of decimals"),
        Type::BOOLEAN | Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE => None,
        Type::INT96 => Some("a column of 96-bit stamps"),
        Type::BYTE_ARRAY => Some("text"),
        Type::FIXED_LEN_BYTE_ARRAY => Some("a column of bytes"),
    }
}
