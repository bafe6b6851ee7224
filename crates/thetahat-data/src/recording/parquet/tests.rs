use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int32Type, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use super::super::table::{RequestedColumns, Table};
use super::super::{Format, RecordingError, read_channels, select, written_elsewhere};
use super::*;
use thetahat_testing::Folder;

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

/// A file of so many rows with stamps, missing values, repeated values and text, with small pages.
fn rows(count: usize, of_group: usize, compression: Compression) -> Vec<u8> {
    let properties = WriterProperties::builder()
        .set_compression(compression)
        .set_write_batch_size(16)
        .set_data_page_row_count_limit(50)
        .set_column_dictionary_enabled("q".into(), false)
        .build();
    let schema = "message record {
        REQUIRED INT64 stamp (TIMESTAMP(NANOS, true));
        REQUIRED DOUBLE q;
        OPTIONAL DOUBLE gap;
        REQUIRED INT32 counts (INTEGER(32, false));
        REQUIRED BOOLEAN flag;
        REQUIRED BYTE_ARRAY note (UTF8);
    }";
    let mut writer =
        SerializedFileWriter::new(Vec::new(), Arc::new(parse_message_type(schema).unwrap()), Arc::new(properties))
            .unwrap();
    let all: Vec<i64> = (0..count as i64).collect();
    for group in all.chunks(of_group) {
        let mut rows = writer.next_row_group().unwrap();
        let stamps: Vec<i64> = group.iter().map(|k| 1_700_000_000_000_000_001 + k * 200_003).collect();
        let q: Vec<f64> = group.iter().map(|k| (*k as f64).sin()).collect();
        let levels: Vec<i16> = group.iter().map(|k| i16::from(k % 5 != 3)).collect();
        let present: Vec<f64> = group.iter().filter(|k| *k % 5 != 3).map(|k| *k as f64 / 3.0).collect();
        let counts: Vec<i32> = group.iter().map(|k| (*k % 7) as i32 - 3).collect();
        let flags: Vec<bool> = group.iter().map(|k| k % 3 == 0).collect();
        let notes: Vec<ByteArray> = group.iter().map(|k| format!("{k}").as_str().into()).collect();
        for column in 0..6 {
            let mut one = rows.next_column().unwrap().unwrap();
            match column {
                0 => one.typed::<Int64Type>().write_batch(&stamps, None, None).unwrap(),
                1 => one.typed::<DoubleType>().write_batch(&q, None, None).unwrap(),
                2 => one.typed::<DoubleType>().write_batch(&present, Some(&levels), None).unwrap(),
                3 => one.typed::<Int32Type>().write_batch(&counts, None, None).unwrap(),
                4 => one.typed::<BoolType>().write_batch(&flags, None, None).unwrap(),
                _ => one.typed::<ByteArrayType>().write_batch(&notes, None, None).unwrap(),
            };
            one.close().unwrap();
        }
        rows.close().unwrap();
    }
    writer.into_inner().unwrap()
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// A file of one column without information, of so many rows in each group.
fn zeros(groups: usize, of_group: usize) -> Vec<u8> {
    let schema = Arc::new(parse_message_type("message record { REQUIRED INT32 q; }").unwrap());
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(WriterProperties::default())).unwrap();
    let zeros = vec![0; of_group];
    for _ in 0..groups {
        let mut rows = writer.next_row_group().unwrap();
        let mut column = rows.next_column().unwrap().unwrap();
        column.typed::<Int32Type>().write_batch(&zeros, None, None).unwrap();
        column.close().unwrap();
        rows.close().unwrap();
    }
    writer.into_inner().unwrap()
}

fn read(bytes: Vec<u8>, path: &Path, wanted: RequestedColumns<'_>) -> Result<Table, RecordingError> {
    read_episode(bytes, path, DatasetInfo::default(), None, wanted).map(|(table, _)| table)
}

fn loaded(bytes: &[u8]) -> Result<Table, RecordingError> {
    read(bytes.to_vec(), Path::new(FILE), RequestedColumns::All)
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
}

#[test]
fn columns_that_are_not_wanted_are_not_read() {
    let asked = ["q".to_owned()];
    let table = read(written(Compression::SNAPPY), Path::new(FILE), RequestedColumns::Named(&asked)).unwrap();
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

/// Pieces of every size, that begin and end anywhere in groups and pages.
#[test]
fn parts_are_those_of_the_whole_bit_by_bit() {
    const ROWS: usize = 1200;
    for of_group in [1, 37, 100, 500, ROWS, 2 * ROWS] {
        for compression in [Compression::UNCOMPRESSED, Compression::SNAPPY, Compression::ZSTD(ZstdLevel::default())] {
            let bytes = rows(ROWS, of_group, compression);
            let whole = loaded(&bytes).unwrap();
            let folder = Folder::with(FILE, &bytes);
            let pieces = GroupPieces::open(&folder.path().join(FILE), DatasetInfo::default(), RequestedColumns::All)
                .unwrap()
                .unwrap();
            assert_eq!(pieces.samples(), ROWS);
            for size in [1, 49, 50, 333, 1199, ROWS].into_iter().filter(|size| *size > 1 || of_group == 100) {
                for start in (0..ROWS).step_by(size) {
                    let range = start..(start + size).min(ROWS);
                    let table = pieces.read(range.clone(), RequestedColumns::All).unwrap();
                    for (piece, whole) in table.columns.iter().zip(&whole.columns) {
                        let expected = whole.values.get(range.clone()).unwrap_or_default();
                        assert_eq!(bits(&piece.values), bits(expected), "{of_group} {range:?} {}", piece.name);
                        assert_eq!((&piece.flaw, piece.channels), (&whole.flaw, whole.channels));
                    }
                }
            }
        }
    }
}

#[test]
fn parts_of_columns_that_are_not_wanted_are_not_read() {
    let folder = Folder::with(FILE, rows(300, 100, Compression::SNAPPY));
    let asked = ["q".to_owned()];
    let pieces = GroupPieces::open(&folder.path().join(FILE), DatasetInfo::default(), RequestedColumns::Named(&asked))
        .unwrap()
        .unwrap();
    let table = pieces.read(150..250, RequestedColumns::Named(&asked)).unwrap();
    let read: Vec<usize> = table.columns.iter().map(|column| column.values.len()).collect();
    assert_eq!(read, [0, 100, 0, 0, 0, 0]);
}

#[test]
fn large_groups_are_left_to_the_reader_of_whole_files() {
    let opened = |bytes: &[u8]| {
        let folder = Folder::with(FILE, bytes);
        GroupPieces::open(&folder.path().join(FILE), DatasetInfo::default(), RequestedColumns::All)
    };
    assert!(opened(&zeros(1, 1 << 22)).unwrap().is_some());
    assert!(opened(&zeros(1, (1 << 22) + 1)).unwrap().is_none());
    assert!(opened(&zeros(0, 0)).unwrap().is_none());
    // More rows than the bytes of the file could mean.
    let many = zeros(5, 1 << 22);
    assert!(matches!(opened(&many), Err(RecordingError::TooLarge { .. })));
    assert!(matches!(loaded(&many), Err(RecordingError::TooLarge { .. })));
}

#[test]
fn parts_of_a_damaged_file_never_panic() {
    let whole = rows(120, 40, Compression::SNAPPY);
    let folder = Folder::with(FILE, &whole);
    let path = folder.path().join(FILE);
    let read = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        GroupPieces::open(&path, DatasetInfo::default(), RequestedColumns::All)?
            .map(|pieces| pieces.read(70..90, RequestedColumns::All))
            .transpose()
    };
    assert!(read(&whole).unwrap().is_some());
    for length in 1..whole.len() {
        assert!(matches!(read(&whole[..length]), Err(RecordingError::Damaged { .. })), "{length}");
    }
    for place in 0..whole.len() {
        for damage in [0x00, 0x01, 0x80, 0xff] {
            let mut bytes = whole.clone();
            bytes[place] = damage;
            fuzz_pieces(&bytes);
            if place % 7 == 0 {
                let _ = read(&bytes);
            }
        }
    }
}

#[test]
fn a_file_that_changes_while_it_is_read() {
    let whole = rows(120, 40, Compression::SNAPPY);
    let folder = Folder::with(FILE, &whole);
    let path = folder.path().join(FILE);
    let pieces = GroupPieces::open(&path, DatasetInfo::default(), RequestedColumns::All).unwrap().unwrap();
    std::fs::write(&path, &whole[..whole.len() / 3]).unwrap();
    assert!(matches!(pieces.read(70..120, RequestedColumns::All), Err(RecordingError::Damaged { .. })));
}

/// A dataset with one file.
fn dataset(file: &str, names: &str) -> Folder {
    let folder = Folder::new();
    folder.write(format!("data/chunk-000/{FILE}"), written_elsewhere::bytes(file));
    let info = format!(r#"{{"features": {{"observation.state": {{"names": {names}}}}}}}"#);
    folder.write("meta/info.json", info);
    folder
}

fn of_dataset(folder: &Folder, keys: &str) -> Result<Vec<f64>, RecordingError> {
    let source = format!("file = 'data/chunk-000/{FILE}'\nunit = '1'\n{keys}");
    read_channels(&toml::from_str(&source).unwrap(), folder.path()).map(|series| series.values().to_vec())
}

#[test]
fn lists_are_columns_of_several_channels() {
    let folder = dataset(written_elsewhere::LEROBOT_FIXED, r#"["pan.pos", "lift.pos"]"#);
    let whole: Vec<f64> = (0..10).map(f64::from).collect();
    assert_eq!(of_dataset(&folder, "columns = ['observation.state']").unwrap(), whole);
    assert_eq!(of_dataset(&folder, "columns = ['action[2]']").unwrap(), [0.0, 2.0, 4.0, 6.0, 8.0]);
    assert_eq!(of_dataset(&folder, "columns = ['observation.state.lift.pos']").unwrap(), [1.0, 3.0, 5.0, 7.0, 9.0]);
    assert_eq!(of_dataset(&folder, "columns = ['observation.state']\nepisode = 2").unwrap(), whole);
    let error = of_dataset(&folder, "columns = ['action']\nepisode = 3").unwrap_err();
    assert!(matches!(error, RecordingError::MissingEpisode { episode: 3, .. }));
    assert!(matches!(
        of_dataset(&folder, "columns = ['action[0]']"),
        Err(RecordingError::MissingChannel { found: 2, .. })
    ));
}

#[test]
fn one_episode_of_several_is_read() {
    let folder = dataset(written_elsewhere::LEROBOT_LISTS, r#"{"motors": ["pan", "lift"]}"#);
    assert_eq!(of_dataset(&folder, "columns = ['observation.state.pan']").unwrap(), [0.0, 2.0]);
    assert_eq!(of_dataset(&folder, "columns = ['observation.state.pan']\nepisode = 1").unwrap(), [4.0, 6.0, 8.0]);
    let contents = super::super::inspect(&folder.at(format!("data/chunk-000/{FILE}"))).unwrap();
    let names: Vec<&str> = contents.tables[0].columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names[..3], ["observation.state.pan", "observation.state.lift", "action"]);
    assert!(contents.notes[0].contains("Episode 0 of the episodes 0 to 1"), "{:?}", contents.notes);
    assert!(contents.notes[1].contains("state the unit"), "{:?}", contents.notes);
}

#[test]
fn damaged_lists_never_panic() {
    for file in [written_elsewhere::LEROBOT_FIXED, written_elsewhere::LEROBOT_LISTS] {
        let whole = written_elsewhere::bytes(file);
        for place in 0..whole.len() {
            assert!(matches!(loaded(&whole[..place]), Err(RecordingError::Damaged { .. })), "{place}");
            for damage in [0x00, 0x01, 0x7f, 0xff] {
                let mut bytes = whole.clone();
                bytes[place] = damage;
                let _ = loaded(&bytes);
                fuzz_pieces(&bytes);
            }
        }
    }
}
