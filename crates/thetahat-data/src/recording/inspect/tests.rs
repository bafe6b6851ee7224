use thetahat_testing::Folder;

use super::super::test_files::MatBytes;
use super::super::{Decimal, Format, RecordingError, Unit};
use super::*;

fn inspected(name: &str, bytes: &[u8]) -> Contents {
    let folder = Folder::with(name, bytes);
    inspect(&folder.path().join(name)).unwrap()
}

fn only(contents: &Contents) -> &TableSummary {
    let [table] = contents.tables.as_slice() else { panic!("{contents:?}") };
    table
}

/// Times of 100 samples at 1 kHz, changed by a closure.
fn times(change: impl Fn(usize) -> f64) -> TimeSummary {
    let rows: String = (0..100).map(|k| format!("{:.6},{}\n", change(k), k % 7)).collect();
    let contents = inspected("q.csv", format!("t,q\n{rows}").as_bytes());
    only(&contents).times[0].clone()
}

/// Rounding of the times in the file, relative to a step.
const ROUNDING: f64 = 1e-2;

#[test]
fn range_and_resolution_of_a_column() {
    let contents = inspected("q.csv", b"q,c\n1.0,5\n1.5,5\n-2.0,5\n1.0,5\n");
    let q = &only(&contents).columns[0].statistics[0];
    assert_eq!((q.min, q.max, q.mean), (Some(-2.0), Some(1.5), Some(0.375)));
    assert!((q.rms.unwrap() - (8.25_f64 / 4.0).sqrt()).abs() < 1e-15);
    assert_eq!((q.resolution, q.constant, q.not_finite), (Some(0.5), false, 0));
    let c = &only(&contents).columns[1].statistics[0];
    assert_eq!((c.resolution, c.constant), (None, true));
}

#[test]
fn text_and_missing_values_are_reported_and_not_refused() {
    let contents = inspected("q.csv", b"q;state\n1,5;run\nNaN;run\n2,5;\n");
    let [q, state] = only(&contents).columns.as_slice() else { panic!("{contents:?}") };
    assert_eq!((q.statistics[0].not_finite, q.statistics[0].mean, &q.not_numeric), (1, Some(2.0), &None));
    assert_eq!(state.not_numeric.as_deref(), Some("text, such as \"run\" in line 2"));
    assert_eq!((state.statistics[0].not_finite, state.statistics[0].min), (3, None));
    let dialect = contents.dialect.unwrap();
    assert_eq!((dialect.delimiter, dialect.decimal, dialect.header), (Some(';'), Some(Decimal::Comma), Some(true)));
}

#[test]
fn even_times() {
    let time = times(|k| 1e-3 * k as f64);
    assert_eq!((time.column.as_str(), time.unit, time.repeated, time.backwards), ("t", Unit::Second, 0, 0));
    assert!((time.rate_hz - 1000.0).abs() < 1e-6 && time.gaps.is_empty() && time.jitter_max < ROUNDING);
}

#[test]
fn lost_samples_are_a_gap_and_not_jitter() {
    let time = times(|k| 1e-3 * (k + if k >= 40 { 3 } else { 0 }) as f64);
    let [gap] = time.gaps.as_slice() else { panic!("{time:?}") };
    assert_eq!((gap.sample, gap.missing), (40, 3));
    assert!((gap.length_s - 4e-3).abs() < 1e-9 && time.jitter_max < ROUNDING);
}

#[test]
fn repeated_and_misplaced_times() {
    let time = times(|k| 1e-3 * if k == 10 { 9.0 } else { k as f64 });
    assert_eq!((time.repeated, time.backwards), (1, 0));
    let time = times(|k| 1e-3 * if k == 10 { 8.5 } else { k as f64 });
    assert_eq!((time.repeated, time.backwards), (0, 1));
}

#[test]
fn jitter_of_alternating_steps() {
    let time = times(|k| 1e-3 * (k as f64 + if k % 2 == 0 { 0.0 } else { 0.1 }));
    assert!((time.rate_hz - 1000.0).abs() < 250.0 && time.jitter_max > 0.1, "{time:?}");
}

#[test]
fn unit_of_a_time_by_its_name_or_its_rate() {
    let unit = |name: &str, step: f64| {
        let rows: String = (0..10).map(|k| format!("{},1\n", step * f64::from(k))).collect();
        only(&inspected("q.csv", format!("{name},q\n{rows}").as_bytes())).times[0].unit
    };
    assert_eq!(unit("t", 0.008), Unit::Second);
    assert_eq!(unit("t", 8.0), Unit::Millisecond);
    assert_eq!(unit("timestamp", 1e6), Unit::Nanosecond);
    assert_eq!(unit("time_ms", 100.0), Unit::Millisecond);
    assert_eq!(unit("time [us]", 8000.0), Unit::Microsecond);
}

#[test]
fn even_column_without_a_name_is_a_time() {
    let rows: String = (0..50).map(|k| format!("{},{}\n", 0.002 * f64::from(k), k % 5)).collect();
    let contents = inspected("q.txt", rows.as_bytes());
    assert_eq!(only(&contents).times.iter().map(|t| t.column.as_str()).collect::<Vec<_>>(), ["1"]);
}

#[test]
fn variables_of_one_length_stand_together() {
    let file = MatBytes::new().with("t", &[3, 1], &[0.0, 0.1, 0.2]).with("kp", &[1, 1], &[5.0]);
    let file = file.with("tau", &[3, 2], &[1.0; 6]).with_text("note", "run");
    let contents = inspected("q.mat", file.bytes());
    let tables: Vec<(usize, usize)> = contents.tables.iter().map(|t| (t.samples, t.columns.len())).collect();
    assert_eq!((contents.format, tables.as_slice()), (Format::Mat, [(3, 2), (1, 1), (0, 1)].as_slice()));
    assert_eq!(contents.tables[0].columns[1].statistics.len(), 2);
    assert_eq!(contents.tables[2].columns[0].not_numeric.as_deref(), Some("text"));
}

#[test]
fn summary_is_data() {
    let json = serde_json::to_value(inspected("q.csv", b"t,q\n0,1\n0.1,NaN\n0.2,3\n0.3,3\n")).unwrap();
    assert_eq!(json["format"], "csv");
    assert_eq!(json["tables"][0]["times"][0]["unit"], "s");
}

#[test]
fn rows_of_different_lengths_are_refused() {
    let folder = Folder::with("q.csv", b"a,b\n1,2\n3\n");
    assert!(matches!(inspect(&folder.path().join("q.csv")), Err(RecordingError::RowLength { line: 3, .. })));
}
