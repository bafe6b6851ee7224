//! Columns of a Parquet file to numbers.

use std::path::Path;
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, ConvertedType, LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::file::serialized_reader::SerializedPageReader;
use parquet::schema::types::ColumnDescriptor;

use super::super::RecordingError;
use super::super::caught::caught;
use super::super::limits::Budget;
use super::super::table::{Column, Table, Wanted};
use super::guard::{Guarded, Pages, check_footer};

/// The columns of a file; missing values are NaN. Those not wanted are there by name, without values.
pub(in super::super) fn read(bytes: Vec<u8>, path: &Path, wanted: Wanted<'_>) -> Result<Table, RecordingError> {
    caught(path, "Parquet", || read_columns(bytes, path, wanted))
}

fn read_columns(bytes: Vec<u8>, path: &Path, wanted: Wanted<'_>) -> Result<Table, RecordingError> {
    check_footer(&bytes).map_err(|reason| RecordingError::damaged(path, reason.to_owned()))?;
    let bytes = Bytes::from(bytes);
    let metadata =
        ParquetMetaDataReader::new().parse_and_finish(&bytes).map_err(|e| damaged(path, "description", &e))?;
    let budget = Budget::of(path, bytes.len() as u64);
    let mut reader = Reader { path, bytes, metadata, budget };
    let columns = (0..reader.metadata.file_metadata().schema_descr().num_columns())
        .map(|index| reader.column(index, wanted))
        .collect::<Result<_, _>>()?;
    Ok(Table { name: String::new(), columns })
}

fn damaged(path: &Path, what: &str, error: &ParquetError) -> RecordingError {
    RecordingError::damaged(path, format!("{what}: {error}"))
}

struct Reader<'a> {
    path: &'a Path,
    bytes: Bytes,
    metadata: ParquetMetaData,
    budget: Budget,
}

impl Reader<'_> {
    fn column(&mut self, index: usize, wanted: Wanted<'_>) -> Result<Column, RecordingError> {
        let described = self.metadata.file_metadata().schema_descr().column(index);
        let name = described.path().parts().join(".");
        if let Some(kind) = kind_not_read(&described) {
            return Ok(Column::of_kind(name, kind));
        }
        if let Some(compression) = self.compression_not_read(index) {
            let compression = compression.to_string();
            let word = compression.split('(').next().unwrap_or_default();
            return Ok(Column::of_kind(name, format!("a column compressed by {word}")));
        }
        if !wanted.includes(&name) {
            return Ok(Column::of_numbers(name, 0, Vec::new()));
        }
        let mut values =
            Values { number: Number::of(&described), present: described.max_def_level(), values: Vec::new() };
        for group in 0..self.metadata.num_row_groups() {
            let rows = self.rows(&name, group)?;
            self.add_group(index, group, rows, &mut values)
                .map_err(|e| damaged(self.path, &format!("column {name:?}"), &e))?;
        }
        Ok(Column::of_numbers(name, 1, values.values))
    }

    /// A compression that is not read. The library decompresses some of them without a bound.
    fn compression_not_read(&self, index: usize) -> Option<Compression> {
        let compressions = self.metadata.row_groups().iter().map(|group| group.column(index).compression());
        let is_read =
            |c: &Compression| matches!(c, Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_));
        compressions.into_iter().find(|compression| !is_read(compression))
    }

    /// Number of rows of a group, for which there must be room.
    fn rows(&mut self, name: &str, group: usize) -> Result<usize, RecordingError> {
        let rows = usize::try_from(self.metadata.row_group(group).num_rows()).unwrap_or(usize::MAX);
        self.budget.take(&format!("column {name:?}"), &[rows])
    }

    fn add_group(&self, index: usize, group: usize, rows: usize, values: &mut Values) -> Result<(), ParquetError> {
        let chunk = self.metadata.row_group(group).column(index);
        let offsets = [Some(chunk.data_page_offset()), chunk.dictionary_page_offset(), Some(chunk.compressed_size())];
        if offsets.into_iter().flatten().any(|offset| offset < 0) {
            return Err(ParquetError::General("its place in the file is negative".to_owned()));
        }
        let limit = 16 * (rows + 1024);
        let guarded = Arc::new(Guarded { bytes: self.bytes.clone(), limit });
        let pages = SerializedPageReader::new(guarded, chunk, rows, None)?;
        let pages = Pages { pages, limit: rows, has_dictionary: false };
        match get_column_reader(chunk.column_descr_ptr(), Box::new(pages)) {
            ColumnReader::BoolColumnReader(reader) => values.add(reader, rows, |x, _| f64::from(u8::from(x))),
            ColumnReader::Int32ColumnReader(reader) => values.add(reader, rows, |x, number| number.of_i32(x)),
            ColumnReader::Int64ColumnReader(reader) => values.add(reader, rows, |x, number| number.of_i64(x)),
            ColumnReader::FloatColumnReader(reader) => values.add(reader, rows, |x, _| x.into()),
            ColumnReader::DoubleColumnReader(reader) => values.add(reader, rows, |x, _| x),
            _ => Err(ParquetError::General("the column is not one of numbers".to_owned())),
        }
    }
}

/// The values of a column while its groups of rows are read.
struct Values {
    number: Number,
    /// The definition level of a value that is present; lower ones are missing.
    present: i16,
    values: Vec<f64>,
}

impl Values {
    fn add<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        rows: usize,
        to_number: fn(T::T, &mut Number) -> f64,
    ) -> Result<(), ParquetError> {
        let (mut levels, mut present) = (Vec::new(), Vec::new());
        let (read, ..) = reader.read_records(rows, Some(&mut levels), None, &mut present)?;
        if read != rows {
            return Err(ParquetError::General(format!("expected {rows} rows, found {read}")));
        }
        let mut present = present.into_iter();
        for row in 0..rows {
            let is_present = self.present == 0 || levels.get(row) == Some(&self.present);
            let value = if is_present { present.next() } else { None };
            self.values.push(value.map_or(f64::NAN, |value| to_number(value, &mut self.number)));
        }
        Ok(())
    }
}

/// How whole numbers are meant.
struct Number {
    unsigned: bool,
    /// Stamps count from a date long ago, and the first is subtracted, before double precision would round them.
    stamps: bool,
    first: Option<i64>,
}

impl Number {
    fn of(column: &ColumnDescriptor) -> Self {
        let logical = column.logical_type_ref();
        let unsigned = matches!(logical, Some(LogicalType::Integer(int)) if !int.is_signed)
            || matches!(column.converted_type(), ConvertedType::UINT_32 | ConvertedType::UINT_64);
        let stamps = matches!(logical, Some(LogicalType::Timestamp(_)))
            || matches!(column.converted_type(), ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIMESTAMP_MICROS);
        Self { unsigned, stamps, first: None }
    }

    fn of_i32(&mut self, number: i32) -> f64 {
        if self.unsigned { number.cast_unsigned().into() } else { number.into() }
    }

    fn of_i64(&mut self, number: i64) -> f64 {
        if self.stamps {
            return number.wrapping_sub(*self.first.get_or_insert(number)) as f64;
        }
        if self.unsigned { number.cast_unsigned() as f64 } else { number as f64 }
    }
}

/// What a column is, if it is not one of numbers.
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
