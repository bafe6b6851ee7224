//! The numbers of a column of any type.

use std::ops::Range;

use parquet::basic::{ConvertedType, LogicalType};
use parquet::column::reader::ColumnReaderImpl;
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::schema::types::ColumnDescriptor;

/// The values of a column while its row groups are read.
pub(super) struct Values {
    number: Number,
    /// The definition level of a present value; values of lower levels are missing.
    present: i16,
    pub(super) values: Vec<f64>,
}

impl Values {
    /// For a column whose stamps count from `first`, or otherwise from the first stamp read.
    pub(super) fn of(column: &ColumnDescriptor, first: Option<i64>) -> Self {
        let number = Number { first, ..Number::of(column) };
        Self { number, present: column.max_def_level(), values: Vec::new() }
    }

    /// Adds rows of a group, counted within it; pages before them are skipped. Rows may be lists of as many values each.
    pub(super) fn add<T: DataType>(
        &mut self,
        reader: ColumnReaderImpl<T>,
        rows: Range<usize>,
        lists: Option<usize>,
        to_number: fn(T::T, &mut Number) -> f64,
    ) -> Result<(), ParquetError> {
        match lists {
            None => self.add_values(reader, rows, to_number),
            Some(channels) => self.add_lists(reader, rows, channels, to_number),
        }
    }

    fn add_values<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        rows: Range<usize>,
        to_number: fn(T::T, &mut Number) -> f64,
    ) -> Result<(), ParquetError> {
        let (mut levels, mut present) = (Vec::new(), Vec::new());
        let passed = reader.skip_records(rows.start)?;
        let (read, ..) = reader.read_records(rows.len(), Some(&mut levels), None, &mut present)?;
        if (passed, read) != (rows.start, rows.len()) {
            return Err(ParquetError::General(format!("expected {} rows, found {}", rows.end, passed + read)));
        }
        let mut present = present.into_iter();
        for row in 0..rows.len() {
            let is_present = self.present == 0 || levels.get(row) == Some(&self.present);
            let value = if is_present { present.next() } else { None };
            self.values.push(value.map_or(f64::NAN, |value| to_number(value, &mut self.number)));
        }
        Ok(())
    }
}

impl Values {
    /// Adds rows of a group that are lists of `channels` values each, sample by sample.
    fn add_lists<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        rows: Range<usize>,
        channels: usize,
        to_number: fn(T::T, &mut Number) -> f64,
    ) -> Result<(), ParquetError> {
        let (mut levels, mut beginnings, mut present) = (Vec::new(), Vec::new(), Vec::new());
        let passed = reader.skip_records(rows.start)?;
        let (read, ..) = reader.read_records(rows.len(), Some(&mut levels), Some(&mut beginnings), &mut present)?;
        let is_regular = |(place, level): (usize, &i16)| (*level == 0) == place.is_multiple_of(channels);
        let are_regular = beginnings.len() == rows.len() * channels && beginnings.iter().enumerate().all(is_regular);
        if (passed, read) != (rows.start, rows.len()) || !are_regular {
            return Err(ParquetError::General(format!("expected {} lists of {channels} values", rows.end)));
        }
        let mut present = present.into_iter();
        for place in 0..rows.len() * channels {
            let value = if levels.get(place) == Some(&self.present) { present.next() } else { None };
            self.values.push(value.map_or(f64::NAN, |value| to_number(value, &mut self.number)));
        }
        Ok(())
    }

    /// The first stamp read, from which the others count.
    pub(super) fn first_stamp(&self) -> Option<i64> {
        self.number.first
    }
}

/// The meaning of integers.
pub(super) struct Number {
    unsigned: bool,
    /// Stamps count from a distant date; the first is subtracted before double precision would round them.
    pub(super) stamps: bool,
    first: Option<i64>,
}

impl Number {
    pub(super) fn of(column: &ColumnDescriptor) -> Self {
        let logical = column.logical_type_ref();
        let unsigned = matches!(logical, Some(LogicalType::Integer(int)) if !int.is_signed)
            || matches!(column.converted_type(), ConvertedType::UINT_32 | ConvertedType::UINT_64);
        let stamps = matches!(logical, Some(LogicalType::Timestamp(_)))
            || matches!(column.converted_type(), ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIMESTAMP_MICROS);
        Self { unsigned, stamps, first: None }
    }

    pub(super) fn of_i32(&mut self, number: i32) -> f64 {
        if self.unsigned { number.cast_unsigned().into() } else { number.into() }
    }

    pub(super) fn of_i64(&mut self, number: i64) -> f64 {
        if self.stamps {
            return number.wrapping_sub(*self.first.get_or_insert(number)) as f64;
        }
        if self.unsigned { number.cast_unsigned() as f64 } else { number as f64 }
    }
}
