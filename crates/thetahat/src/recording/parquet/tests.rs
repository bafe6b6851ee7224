use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, ZstdLevel};
use parquet::data_type::{ByteArrayType, DoubleType, Int32Type, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use super::super::table::{Table, Wanted};
use super::super::{Format, RecordingError, select};
use super::*;

const FILE: &str = "q.parquet";

const SCHEMA: &str = "message record {
    REQUIRED INT64 stamp (TIMESTAMP(NANOS, true));
    REQUIRED DOUBLE q;
    OPTIONAL DOUBLE gap;
    REQUIRED INT32 counts (INTEGER(32, false));
    REQUIRED BYTE_ARRAY note (UTF8);
    OPTIONAL GROUP list (LIST) { REPEATED GROUP list { OPTIONAL DOUBLE element; } }
}";

/// Two groups of two rows each.
fn written(compression: Compression) -> Vec<u8> {
    let properties = WriterProperties::builder().set_compression(compression).build();
    let schema = Arc::new(parse_message_type(SCHEMA).unwrap());
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties)).unwrap();
    for group in 0..2_i64 {
        let first = 1_700_000_000_000_000_000 + group * 2_000_001;
        let q = [1.5 + group as f64, -2.0];
        let mut rows = writer.next_row_group().unwrap();
        let mut column = 0;
        while let Some(mut one) = rows.next_column().unwrap() {
            match column {
                0 => one.typed::<Int64Type>().write_batch(&[first, first + 1_000_000], None, None).unwrap(),
                1 => one.typed::<DoubleType>().write_batch(&q, None, None).unwrap(),
                2 => one.typed::<DoubleType>().write_batch(&[7.0], Some(&[0, 1]), None).unwrap(),
                3 => one.typed::<Int32Type>().write_batch(&[-1, 2], None, None).unwrap(),
                4 => one.typed::<ByteArrayType>().write_batch(&["a".into(), "b".into()], None, None).unwrap(),
                _ => one.typed::<DoubleType>().write_batch(&[3.0, 4.0], Some(&[3, 3]), Some(&[0, 0])).unwrap(),
            };
            one.close().unwrap();
            column += 1;
        }
        rows.close().unwrap();
    }
    writer.into_inner().unwrap()
}

fn loaded(bytes: &[u8]) -> Result<Table, RecordingError> {
    read(bytes.to_vec(), Path::new(FILE), Wanted::All)
}

fn failure(column: &str) -> RecordingError {
    let table = loaded(&written(Compression::SNAPPY)).unwrap();
    select::series(&table, Format::Parquet, &[column.to_owned()], Path::new(FILE)).unwrap_err()
}

#[test]
fn numbers_of_all_groups_in_every_compression() {
    for compression in [Compression::UNCOMPRESSED, Compression::SNAPPY, Compression::ZSTD(ZstdLevel::default())] {
        let table = loaded(&written(compression)).unwrap();
        assert_eq!(table.columns[1].values, [1.5, -2.0, 2.5, -2.0]);
        assert_eq!(table.columns[3].values, [f64::from(u32::MAX), 2.0, f64::from(u32::MAX), 2.0]);
    }
}

#[test]
fn stamps_count_from_the_first_so_that_no_nanosecond_is_lost() {
    let table = loaded(&written(Compression::SNAPPY)).unwrap();
    assert_eq!(table.columns[0].values, [0.0, 1_000_000.0, 2_000_001.0, 3_000_001.0]);
}

#[test]
fn missing_value() {
    assert!(matches!(failure("gap"), RecordingError::NotFiniteSample { sample: 0, .. }));
    assert_eq!(loaded(&written(Compression::SNAPPY)).unwrap().columns[2].values[1], 7.0);
}

#[test]
fn columns_that_are_not_numbers_say_what_they_are() {
    assert!(matches!(failure("note"), RecordingError::NotNumeric { found, .. } if found == "text"));
    let list = failure("list.list.element");
    assert!(matches!(list, RecordingError::NotNumeric { found, .. } if found == "a column of lists"));
}

#[test]
fn columns_that_are_not_wanted_are_not_read() {
    let asked = ["q".to_owned()];
    let table = read(written(Compression::SNAPPY), Path::new(FILE), Wanted::Named(&asked)).unwrap();
    assert_eq!((table.columns[1].channels, table.columns[2].channels), (1, 0));
}

#[test]
fn file_cut_short() {
    let whole = written(Compression::SNAPPY);
    for length in 0..whole.len() {
        assert!(matches!(loaded(&whole[..length]), Err(RecordingError::Damaged { .. })), "{length}");
    }
}

#[test]
fn damaged_bytes_never_panic() {
    let whole = written(Compression::SNAPPY);
    for place in 0..whole.len() {
        for damage in [0x00, 0x01, 0x7f, 0x80, 0xff] {
            let mut bytes = whole.clone();
            bytes[place] = damage;
            let _ = loaded(&bytes);
        }
    }
}
