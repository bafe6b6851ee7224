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
use parquet::schema::types::ColumnDescriptor;

use super::super::budget::Budget;
use super::super::error::RecordingError;
use super::super::panic_guard::panics_as_damage;
use super::super::table::{Column, RequestedColumns, Table};
use super::guard::{Guarded, Pages, Source, description};
use super::numbers::{Number, Values};

/// The columns of a file; missing values are NaN. Columns that are not requested have a name and no values.
pub(in super::super) fn read(
    bytes: Vec<u8>,
    path: &Path,
    wanted: RequestedColumns<'_>,
) -> Result<Table, RecordingError> {
    panics_as_damage(path, "Parquet", || {
        let source = Source::Memory(Bytes::from(bytes));
        let described = Described::new(path, &source)?;
        described.require_room(path, source.length(), wanted)?;
        described.table(path, &source, 0..described.samples, wanted, |_| None)
    })
}

/// The content of a file as its metadata describes it.
pub(super) struct Described {
    metadata: ParquetMetaData,
    /// Rows of each group.
    rows: Vec<usize>,
    /// Number of rows of all groups.
    pub(super) samples: usize,
}

impl Described {
    pub(super) fn new(path: &Path, source: &Source) -> Result<Self, RecordingError> {
        let refuse = |e: ParquetError| damaged(path, "description", &e);
        let metadata = description(source).and_then(|bytes| ParquetMetaDataReader::decode_metadata(&bytes));
        let metadata = metadata.map_err(refuse)?;
        let rows = metadata.row_groups().iter().map(|group| usize::try_from(group.num_rows()).unwrap_or(usize::MAX));
        let rows: Vec<usize> = rows.collect();
        let samples = rows.iter().fold(0_usize, |sum, rows| sum.saturating_add(*rows));
        Ok(Self { metadata, rows, samples })
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
        wanted: RequestedColumns<'_>,
    ) -> Result<(), RecordingError> {
        let mut budget = Budget::of(path, bytes);
        for index in self.indices().filter(|&index| self.is_read(index, wanted)) {
            budget.take(&format!("column {:?}", self.name(index)), &[self.samples])?;
        }
        Ok(())
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
            if !wanted.includes(&name) {
                return Ok(Column::of_numbers(name, 0, Vec::new()));
            }
            let refuse = |e: ParquetError| damaged(path, &format!("column {name:?}"), &e);
            let values = self.values(index, source, rows.clone(), first(index)).map_err(refuse)?;
            Ok(Column::of_numbers(name, 1, values.values))
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
        let described = self.metadata.file_metadata().schema_descr().column(index);
        let mut values = Values::of(&described, first);
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

    pub(super) fn name(&self, index: usize) -> String {
        self.metadata.file_metadata().schema_descr().column(index).path().parts().join(".")
    }

    /// Whether a column is requested and contains numbers.
    pub(super) fn is_read(&self, index: usize, wanted: RequestedColumns<'_>) -> bool {
        wanted.includes(&self.name(index)) && self.kind_not_read(index).is_none()
    }

    /// Whether a column contains stamps.
    pub(super) fn is_stamps(&self, index: usize) -> bool {
        Number::of(&self.metadata.file_metadata().schema_descr().column(index)).stamps
    }

    /// The kind of a column, if it does not contain numbers that can be read.
    fn kind_not_read(&self, index: usize) -> Option<String> {
        if let Some(kind) = kind_not_read(&self.metadata.file_metadata().schema_descr().column(index)) {
            return Some(kind.to_owned());
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
        let of_group = self.rows[group];
        let guarded = Arc::new(Guarded { source: source.clone(), limit: 16 * (of_group + 1024) });
        let pages = SerializedPageReader::new(guarded, chunk, of_group, None)?;
        let pages = Pages { pages, limit: of_group, has_dictionary: false };
        match get_column_reader(chunk.column_descr_ptr(), Box::new(pages)) {
            ColumnReader::BoolColumnReader(reader) => values.add(reader, rows, |x, _| f64::from(u8::from(x))),
            ColumnReader::Int32ColumnReader(reader) => values.add(reader, rows, |x, number| number.of_i32(x)),
            ColumnReader::Int64ColumnReader(reader) => values.add(reader, rows, |x, number| number.of_i64(x)),
            ColumnReader::FloatColumnReader(reader) => values.add(reader, rows, |x, _| x.into()),
            ColumnReader::DoubleColumnReader(reader) => values.add(reader, rows, |x, _| x),
            ColumnReader::Int96ColumnReader(_)
            | ColumnReader::ByteArrayColumnReader(_)
            | ColumnReader::FixedLenByteArrayColumnReader(_) => {
                Err(ParquetError::General("the column is not one of numbers".to_owned()))
            }
        }
    }
}

fn damaged(path: &Path, what: &str, error: &ParquetError) -> RecordingError {
    RecordingError::damaged(path, format!("{what}: {error}"))
}

/// The kind of a column, if it does not contain numbers.
fn kind_not_read(column: &ColumnDescriptor) -> Option<&'static str> {
    if column.max_rep_level() > 0 {
        return Some("a column of lists");
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
