use std::path::Path;

use super::super::table::{RequestedColumns, Table};
use super::super::{Format, RecordingError, select};
use super::*;
use thetahat_ground::series::Series;

fn with(dialect: Dialect, text: &[u8], columns: &[&str]) -> Result<Series, RecordingError> {
    let (path, columns) = (Path::new("q.csv"), columns.iter().map(|&c| c.to_owned()).collect::<Vec<_>>());
    let wanted = if columns.is_empty() { RequestedColumns::All } else { RequestedColumns::Named(&columns) };
    let table: Table = read(text, path, &dialect, wanted)?;
    select::series(&table, Format::Csv, &columns, path)
}

fn table(text: &str, columns: &[&str]) -> Result<Series, RecordingError> {
    with(Dialect::default(), text.as_bytes(), columns)
}

fn failure(text: &str, columns: &[&str]) -> RecordingError {
    table(text, columns).unwrap_err()
}

/// The dialect detected in a text.
fn detected(text: &str) -> Dialect {
    read_with_dialect(text.as_bytes(), Path::new("q.csv"), &Dialect::default(), RequestedColumns::All).unwrap().1
}

fn values(text: &str) -> Vec<f64> {
    table(text, &[]).unwrap().values().to_vec()
}

#[test]
fn named_columns_in_the_order_of_the_names() {
    let series = table("a,b,c\n1,2,3\n-4e-3,+5.5,6\n", &["c", "a"]).unwrap();
    assert_eq!((series.channels(), series.values()), (2, [3.0, 1.0, 6.0, -4e-3].as_slice()));
}

#[test]
fn all_columns_where_none_is_named() {
    assert_eq!(table("a,b\n1,2\n3,4\n", &[]).unwrap().values(), [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn byte_order_mark_spaces_and_carriage_returns_are_dropped() {
    assert_eq!(table("\u{feff}a , b\r\n 1, 2 \r\n3,4", &["a", "b"]).unwrap().values(), [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn text_in_a_column_that_is_not_read_does_no_harm() {
    assert_eq!(table("a,note\n1,start\n2,end\n", &["a"]).unwrap().values(), [1.0, 2.0]);
}

#[test]
fn empty_file() {
    assert!(matches!(failure("", &["a"]), RecordingError::EmptyFile { .. }));
}

#[test]
fn blank_file() {
    assert!(matches!(failure("\n\n", &[]), RecordingError::EmptyFile { .. }));
}

#[test]
fn header_without_samples() {
    assert!(matches!(failure("a,b\n", &["a"]), RecordingError::NoSamples { .. }));
}

#[test]
fn missing_column_lists_those_present() {
    let error = failure("a,b\n1,2\n", &["a", "q7"]);
    assert!(matches!(error, RecordingError::MissingColumn { column, found, .. }
        if column == "q7" && found == ["a", "b"]));
}

#[test]
fn text_of_a_missing_column_names_file_and_column() {
    let text = failure("a,b\n1,2\n", &["q7"]).to_string();
    assert!(text.contains("q.csv") && text.contains("q7"), "{text}");
}

#[test]
fn the_second_column_of_a_name_has_a_number() {
    assert_eq!(table("a,a,b\n1,2,3\n", &["a#2", "a#1"]).unwrap().values(), [2.0, 1.0]);
}

#[test]
fn short_row() {
    let error = failure("a,b\n1,2\n3\n", &["a"]);
    assert!(matches!(error, RecordingError::RowLength { line: 3, expected: 2, found: 1, .. }));
}

#[test]
fn long_row() {
    let error = failure("a,b\n1,2\n3,5,4\n", &["a"]);
    assert!(matches!(error, RecordingError::RowLength { line: 3, expected: 2, found: 3, .. }));
}

#[test]
fn cell_that_is_not_a_number() {
    let error = failure("a,b\n1,2\n3,on\n", &[]);
    assert!(matches!(error, RecordingError::NotANumber { line: 3, column, found, .. }
        if column == "b" && found == "on"));
}

#[test]
fn empty_cell() {
    assert!(matches!(failure("a,b\n1,\n", &[]), RecordingError::NotANumber { line: 2, .. }));
}

#[test]
fn cell_that_is_nan() {
    let error = failure("a,b\n1,2\n\n3,4\nNaN,6\n", &[]);
    assert!(matches!(error, RecordingError::NotFinite { line: 5, column, .. } if column == "a"));
}

#[test]
fn cell_that_is_infinite() {
    let error = failure("a,b\n1,-inf\n", &[]);
    assert!(matches!(error, RecordingError::NotFinite { line: 2, found: f64::NEG_INFINITY, .. }));
}

#[test]
fn cell_that_is_not_text() {
    let error = with(Dialect::default(), b"a\n\xff\xfe\n", &[]).unwrap_err();
    assert!(matches!(error, RecordingError::NotANumber { line: 2, .. }));
}

#[test]
fn columns_without_names_are_numbered() {
    assert_eq!(table("0,1\n5,6\n", &["2"]).unwrap().values(), [1.0, 6.0]);
}

#[test]
fn columns_named_by_numbers_where_a_header_is_set() {
    let dialect = Dialect { header: Some(true), ..Dialect::default() };
    assert_eq!(with(dialect, b"0,1\n5,6\n", &["1"]).unwrap().values(), [6.0]);
}

#[test]
fn every_delimiter_is_detected() {
    for delimiter in [',', ';', '\t', '|', ' '] {
        let text = "t,q1\n0.5,1\n1,-2e-3\n".replace(',', &delimiter.to_string());
        assert_eq!(detected(&text).delimiter, Some(delimiter));
        assert_eq!(values(&text), [0.5, 1.0, 1.0, -2e-3], "{delimiter:?}");
    }
}

#[test]
fn decimal_comma_with_every_other_delimiter() {
    for delimiter in [';', '\t', '|', ' '] {
        let text = "t_q1\n0,5_1\n1_-2,5e-3\n".replace('_', &delimiter.to_string());
        let dialect = detected(&text);
        assert_eq!((dialect.delimiter, dialect.decimal), (Some(delimiter), Some(Decimal::Comma)));
        assert_eq!(values(&text), [0.5, 1.0, 1.0, -2.5e-3], "{delimiter:?}");
    }
}

#[test]
fn commas_alone_are_delimiters() {
    assert_eq!(values("1,2,3\n4,5,6\n"), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(
        detected("1,2\n3,4\n"),
        Dialect { delimiter: Some(','), decimal: Some(Decimal::Point), header: Some(false), ..Dialect::default() }
    );
}

#[test]
fn decimal_comma_may_begin_late() {
    assert_eq!(values("0;0\n1;1\n0,5;2\n"), [0.0, 0.0, 1.0, 1.0, 0.5, 2.0]);
}

#[test]
fn one_column_with_a_decimal_comma_has_to_say_so() {
    assert!(matches!(failure("q\n1,5\n2,5\n", &[]), RecordingError::RowLength { line: 2, delimiter: ',', .. }));
    let dialect = Dialect { decimal: Some(Decimal::Comma), ..Dialect::default() };
    assert_eq!(with(dialect, b"q\n1,5\n2,5\n", &[]).unwrap().values(), [1.5, 2.5]);
}

#[test]
fn point_and_comma_in_one_file() {
    assert!(matches!(failure("a;b\n1.5;2\n2,5;3\n", &[]), RecordingError::NotANumber { line: 3, .. }));
}

#[test]
fn quoted_cells_with_decimal_commas() {
    let dialect = Dialect { delimiter: Some(','), decimal: Some(Decimal::Comma), ..Dialect::default() };
    assert_eq!(with(dialect, b"\"a\",\"b\"\n\"1,5\",\"2,5\"\n", &[]).unwrap().values(), [1.5, 2.5]);
}

#[test]
fn runs_of_spaces_are_one_delimiter() {
    assert_eq!(values("  t    q1\r\n  0.0   1 \r\n 10.0  -2\r\n"), [0.0, 1.0, 10.0, -2.0]);
}

#[test]
fn comments_and_empty_lines_before_the_table_are_dropped_and_counted() {
    let text = "# robot 3\n\n% at 1 kHz, 2 joints; raw\nt,q\n0,1\n1,on\n";
    assert_eq!(table(text, &["t"]).unwrap().values(), [0.0, 1.0]);
    assert!(matches!(failure(text, &["q"]), RecordingError::NotANumber { line: 6, .. }));
}

#[test]
fn only_comments() {
    assert!(matches!(failure("# robot 3\n", &[]), RecordingError::EmptyFile { .. }));
}

#[test]
fn text_columns_do_not_hide_the_header() {
    assert_eq!(table("t,state,q\n0,run,1\n1,run,2\n", &["q"]).unwrap().values(), [1.0, 2.0]);
}

#[test]
fn text_columns_without_a_header() {
    assert_eq!(table("0,run,1\n1,run,2\n", &["3"]).unwrap().values(), [1.0, 2.0]);
}

#[test]
fn line_that_may_be_names_or_values() {
    assert!(matches!(failure("t,1,2\n0,1,2\n", &[]), RecordingError::UnclearHeader { line: 1, .. }));
    let dialect = Dialect { header: Some(true), ..Dialect::default() };
    assert_eq!(with(dialect, b"t,1,2\n0,1,2\n", &["2"]).unwrap().values(), [2.0]);
}

#[test]
fn text_that_two_delimiters_explain() {
    let error = failure("1;x,2\n2;x,3\n", &[]);
    assert!(matches!(error, RecordingError::UnclearDelimiter { line: 1, found: [';', ','], .. }), "{error}");
    let dialect = Dialect { delimiter: Some(';'), ..Dialect::default() };
    assert_eq!(with(dialect, b"1;x,2\n2;x,3\n", &["1"]).unwrap().values(), [1.0, 2.0]);
}

#[test]
fn delimiter_that_is_part_of_numbers() {
    for delimiter in ['.', '-', 'e', '5', '\u{2502}'] {
        let dialect = Dialect { delimiter: Some(delimiter), ..Dialect::default() };
        assert!(matches!(with(dialect, b"1,2\n", &[]), Err(RecordingError::BadDelimiter { .. })), "{delimiter:?}");
    }
}

#[test]
fn damaged_bytes_never_panic() {
    let whole = b"# c\nt;q\n0,5;\"1\"\n1;2\n";
    for place in 0..whole.len() {
        for damage in 0..=255 {
            let mut bytes = whole.to_vec();
            bytes[place] = damage;
            let _ = with(Dialect::default(), &bytes, &[]);
        }
    }
}

/// Spreadsheets of many countries write Latin-1: degrees, micro and the dot of a product are still recognised.
#[test]
fn names_in_latin_1_are_read() {
    let header = |text: &[u8]| names(text, Path::new("q.csv"), &Dialect::default()).unwrap();
    assert_eq!(header(b"q [\xb0];tau [N\xb7m]\n1,5;2\n2,5;3\n"), ["q [°]", "tau [N·m]"]);
    assert_eq!(header("q [°];tau [N·m]\n1,5;2\n2,5;3\n".as_bytes()), ["q [°]", "tau [N·m]"]);
}
