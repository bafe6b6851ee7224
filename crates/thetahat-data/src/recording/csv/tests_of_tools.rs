//! Texts as tools write them.

use std::path::Path;

use thetahat_testing::Folder;

use super::super::{ChannelSource, Contents, RecordingError, SignalPieces, Unit, inspect, read_channels};
use super::*;
use crate::recording::table::RequestedColumns;

const FILE: &str = "log.csv";

fn read_text(text: impl AsRef<[u8]>, keys: &str) -> Result<Vec<f64>, RecordingError> {
    let folder = Folder::with(FILE, text);
    let source = source(keys);
    if let Ok(Some(pieces)) = SignalPieces::open(&[&source], folder.path()) {
        let whole = read_channels(&source, folder.path())?;
        assert_eq!(pieces.read(&[0], 0..whole.len())?[0], whole);
    }
    read_channels(&source, folder.path()).map(|series| series.values().to_vec())
}

fn source(keys: &str) -> ChannelSource {
    let unit = if keys.contains("unit") { "" } else { "unit = '1'" };
    toml::from_str(&format!("file = '{FILE}'\n{unit}\n{keys}")).unwrap()
}

fn columns(text: impl AsRef<[u8]>, names: &str) -> Vec<f64> {
    read_text(text, &format!("columns = {names}")).unwrap()
}

fn inspected(text: impl AsRef<[u8]>) -> Contents {
    let folder = Folder::with(FILE, text);
    inspect(&folder.at(FILE)).unwrap()
}

fn names_in(text: impl AsRef<[u8]>) -> Vec<String> {
    inspected(text).tables[0].columns.iter().map(|column| column.name.clone()).collect()
}

/// Windows PowerShell's redirection.
#[test]
fn utf_16_of_a_shell() {
    let bytes: Vec<u8> = "\u{feff}t,q\r\n0,1.5\r\n1,x\r\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(columns(&bytes, "['t']"), [0.0, 1.0]);
    assert!(matches!(read_text(&bytes, "columns = ['q']"), Err(RecordingError::NotANumber { line: 3, .. })));
}

#[test]
fn titles_and_blocks_of_settings_above_the_table() {
    let text = "Motion log, 5 May\nRobot;UR3\nRate;125\n\nt;q;tau\n0;1,5;2\n1;2,5;x\n";
    assert_eq!(columns(text, "['q', 't']"), [1.5, 0.0, 2.5, 1.0]);
    assert!(matches!(read_text(text, "columns = ['tau']"), Err(RecordingError::NotANumber { line: 7, .. })));
    let contents = inspected(text);
    assert_eq!(contents.dialect.unwrap().skip_lines, Some(4));
    assert_eq!(contents.notes, ["Lines 1 to 4 are not part of the table."]);
    // Settings as long as the rows.
    assert_eq!(columns("Rate;125\nRobot;UR3\nt;q\n0;1,5\n1;2,5\n", "['q']"), [1.5, 2.5]);
    // A sentence above values without names.
    assert_eq!(columns("Log of joint 1\n0;1,5\n1;2,5\n", "['2']"), [1.5, 2.5]);
}

#[test]
fn lines_are_skipped_where_that_is_asked_for() {
    let text = "gains,1,2\nt,q,tau\n0,1,2\n1,2,3\n";
    assert_eq!(read_text(text, "columns = ['tau']\nskip_lines = 1").unwrap(), [2.0, 3.0]);
    assert_eq!(read_text("1,2\n3,4\n5,6\n", "columns = ['2']\nskip_lines = 2").unwrap(), [6.0]);
    assert!(matches!(read_text("1,2\n", "skip_lines = 1"), Err(RecordingError::EmptyFile { .. })));
    let error = read_text("q\n1,2\n3,4\n", "").unwrap_err().to_string();
    assert!(error.contains("`skip_lines`"), "{error}");
}

#[test]
fn a_delimiter_after_the_last_column_is_no_column() {
    for text in ["t;q;\n0;1,5;\n1;2,5;\n", "t;q\n0;1,5;\n1;2,5;\n", "t;q;\n0;1,5\n1;2,5\n", "0;1,5;\n1;2,5;\n"] {
        assert_eq!(read_text(text, "").unwrap(), [0.0, 1.5, 1.0, 2.5], "{text:?}");
    }
    // A column whose values are all missing has a name.
    let error = read_text("t;q;note\n0;1,5;\n1;2,5;\n", "columns = ['note']").unwrap_err();
    assert!(matches!(error, RecordingError::NotANumber { line: 2, column, .. } if column == "note"));
    assert!(matches!(read_text("t;q\n0;1\n0;1;2\n", ""), Err(RecordingError::RowLength { line: 3, .. })));
}

#[test]
fn comments_among_the_values() {
    assert_eq!(columns("t,q\n0,1\n# paused, for a while, here\n1,2\n% end", "['q', 't']"), [1.0, 0.0, 2.0, 1.0]);
    assert!(matches!(read_text("t,q\n0,1\nTotal: 3\n1,2\n", ""), Err(RecordingError::RowLength { line: 3, .. })));
}

/// Arrays in cells, as pandas writes those of messages.
#[test]
fn lists_in_cells() {
    let text = "t,q\n0,\"[1.5, 2]\"\n0.1,\"[3, 4]\"\n";
    assert_eq!(read_text(text, "columns = ['t', 'q']").unwrap(), [0.0, 1.5, 2.0, 0.1, 3.0, 4.0]);
    assert_eq!(read_text(text, "columns = ['q[2]']").unwrap(), [2.0, 4.0]);
    assert_eq!(inspected(text).tables[0].columns[1].channels, 2);
    let shorter = "t,q\n0,\"[1.5, 2]\"\n0.1,\"[3]\"\n";
    let error = read_text(shorter, "columns = ['q']").unwrap_err();
    assert!(matches!(&error, RecordingError::NotANumber { line: 3, found, .. } if found == "[3]"), "{error}");
}

/// Loggers that say how the recording ended.
#[test]
fn words_after_the_table() {
    for closing in ["End of file;;\n", "End of file\n\n", "Stopped;\nOperator Jones;;\n"] {
        let text = format!("t;q1;q2\n0;1;2\n0.1;3;4\n{closing}");
        assert_eq!(read_text(&text, "columns = ['t', 'q2']").unwrap(), [0.0, 2.0, 0.1, 4.0], "{closing:?}");
    }
    let between = "t;q1;q2\n0;1;2\nPause;;\n0.1;3;4\n0.2;3;4\n0.3;3;4\n0.4;3;4\n";
    assert!(matches!(read_text(between, "columns = ['t', 'q2']"), Err(RecordingError::NotANumber { line: 3, .. })));
}

/// The column of comments is named, and rows have no cell for it.
#[test]
fn labview_measurements() {
    let text = "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\n***End_of_Header***\t\n\nChannels\t2\t\t\nSamples\t1\t1\t\n\
                ***End_of_Header***\t\t\t\nX_Value\tq\ttau\tComment\n0.0\t1.5\t2.5\n0.1\t3.5\t4.5\n";
    assert_eq!(columns(text, "['q', 'X_Value']"), [1.5, 0.0, 3.5, 0.1]);
}

#[test]
fn words_for_missing_values_are_no_names() {
    let text = "t,q\nn/a,n/a\n0,1\n1,2\n";
    assert!(matches!(read_text(text, "columns = ['q']"), Err(RecordingError::NotANumber { line: 2, .. })));
}

#[test]
fn a_line_that_states_the_delimiter() {
    assert_eq!(read_text("sep=;\nt;q\n0;1,5\n", "columns = ['q']").unwrap(), [1.5]);
    assert_eq!(read_text("sep=;\n0;1,5\n1;2,5\n", "columns = ['2']").unwrap(), [1.5, 2.5]);
}

#[test]
fn names_after_the_sign_of_a_comment() {
    assert_eq!(
        columns("%time,field.position0\n10,1.5\n20,2.5\n", "['field.position0', 'time']"),
        [1.5, 10.0, 2.5, 20.0]
    );
    assert_eq!(columns("%time,q\n10,1.5\n", "['%time']"), [10.0]);
    assert_eq!(columns("# q1 q2\n1.0 2.0\n3.0 4.0\n", "['q2']"), [2.0, 4.0]);
    assert_eq!(columns("# q1 q2\n1.0 2.0\n3.0 4.0\n", "['2']"), [2.0, 4.0]);
    // A remark above names.
    assert_eq!(columns("# made, today\nt,q\n1,2\n", "['q']"), [2.0]);
}

#[test]
fn units_below_the_names() {
    let text = "Time;Pos elbow;Moment elbow\nms;deg;N m\n0;1,5;2\n8;2,5;3\n";
    assert_eq!(names_in(text), ["Time [ms]", "Pos elbow [deg]", "Moment elbow [N m]"]);
    assert_eq!(columns(text, "['Pos elbow [deg]', 'Time [ms]']"), [1.5, 0.0, 2.5, 8.0]);
    let degrees = read_text(text, "columns = ['Pos elbow']\nunit = 'deg'").unwrap();
    assert!((degrees[1] - 2.5_f64.to_radians()).abs() < 1e-15);
    assert!(matches!(
        read_text(text, "columns = ['Pos elbow']\nunit = 'rad'"),
        Err(RecordingError::OtherUnit { expected: Unit::Degree, found: Unit::Radian, .. })
    ));
    let time = &inspected(format!("{text}16;0;0\n")).tables[0].times[0];
    assert_eq!((time.column.as_str(), time.rate_hz), ("Time [ms]", 125.0));
}

#[test]
fn repeated_names_have_numbers_or_the_names_of_their_groups() {
    assert_eq!(columns("t,tau1,tau1\n0,1,2\n", "['tau1#2', 'tau1#1']"), [2.0, 1.0]);
    assert_eq!(names_in(";Position;;Torque;\nt;j1;j2;j1;j2\n0;1;2;3;4\n1;1;2;3;4\n")[3], "Torque j1");
    // The index of a table of pandas has no name.
    assert_eq!(columns(",t,q\n0,0.5,1\n1,1.5,2\n", "['1', 'q']"), [0.0, 1.0, 1.0, 2.0]);
}

#[test]
fn dates_and_times_of_day_are_seconds_from_the_first() {
    for [first, second] in [
        ["2026-11-25T10:00:00.123Z", "2026-11-25T10:00:00.373Z"],
        ["2026-11-25 23:59:59.900", "2026-11-26 00:00:00.150"],
        ["25.11.2026 10:00:00,5", "25.11.2026 10:00:00,75"],
        ["23:59:59.900", "00:00:00.150"],
        ["03.05.2024 10:00:00", "03.05.2024 10:00:00.25"],
        ["11/25/2026 10:00:00 PM", "11/25/2026 10:00:00.25 PM"],
    ] {
        let text = format!("stamp;q\n{first};1\n{second};2\n");
        let found = read_text(&text, "columns = ['stamp']\nunit = 's'").unwrap();
        assert!(found[0] == 0.0 && (found[1] - 0.25).abs() < 1e-9, "{first} {found:?}");
        assert_eq!(columns(&text, "['q']"), [1.0, 2.0]);
        assert!(matches!(
            read_text(&text, "columns = ['stamp']\nunit = 'ms'"),
            Err(RecordingError::UnitOfStamps { .. })
        ));
    }
}

#[test]
fn dates_of_unknown_order_are_refused_with_a_remedy() {
    let text = "stamp;q\n03.05.2024 23:59:59;1\n06.05.2024 23:59:59;2\n";
    let error = read_text(text, "columns = ['stamp']\nunit = 's'").unwrap_err();
    assert!(matches!(error, RecordingError::UnclearDate { line: 2, .. }), "{error}");
    assert!(error.to_string().contains("`day_first = true`"), "{error}");
    assert_eq!(read_text(text, "columns = ['stamp']\nunit = 's'\nday_first = true").unwrap(), [0.0, 259_200.0]);
    assert!(inspected(text).tables[0].columns[0].not_numeric.as_ref().unwrap().contains("day or the month"));
    let text = "stamp;q\n10:00:00;1\nlater;2\n";
    let error = read_text(text, "columns = ['stamp']\nunit = 's'").unwrap_err();
    assert!(matches!(error, RecordingError::NotANumber { line: 3, found, .. } if found == "later"));
}

#[test]
fn separators_of_thousands() {
    assert_eq!(columns("t,q\n\"0\",-0.5\n\"8,000\",1.5\n\"1,016,000\",2.5\n", "['t']"), [0.0, 8000.0, 1_016_000.0]);
    assert_eq!(columns("q;a\n\"1,234.5\";1\n\"-2,000.25\";2\n", "['q']"), [1234.5, -2000.25]);
    assert_eq!(columns("q;a\n1.234,5;1\n2.000,25;2\n", "['q']"), [1234.5, 2000.25]);
    assert_eq!(columns("q;a\n1'234.5;1\n0.25;2\n", "['q']"), [1234.5, 0.25]);
    // Settings above the table show nothing.
    assert_eq!(columns("Serial;1.234.567\nt;q\n0;0.5\n1;1.5\n", "['q']"), [0.5, 1.5]);
    // Nothing shows which sign is which: commas may be decimal.
    assert!(matches!(read_text("a,b\n1,\"1,234\"\n", "columns = ['b']"), Err(RecordingError::NotANumber { .. })));
    assert_eq!(read_text("a;b\n1;1.234\n", "columns = ['b']\ndecimal = ','").unwrap(), [1234.0]);
}

/// `ros2 topic echo --csv`: no names, seconds and nanoseconds, joints in each row.
#[test]
fn joint_states_of_ros_2() {
    let text = "1695196914,999000000,base,b,a,1,2,3,4,5,6\n1695196915,7000000,base,b,a,7,8,9,10,11,12\n1695196915,15000000,base,b,a,7,8,9,10,11,12\n";
    let time = [0.0, 0.008, 0.016];
    for keys in ["columns = ['1', '2']\nunit = ['s', 'ns']", "columns = ['1+2']\nunit = 's'"] {
        let found = read_text(text, keys).unwrap();
        assert!(found.iter().zip(time).all(|(a, b)| (a - b).abs() < 1e-9), "{keys} {found:?}");
    }
    assert_eq!(columns(text, "['a.position', 'b.effort', '7']"), [2.0, 5.0, 2.0, 8.0, 11.0, 8.0, 8.0, 11.0, 8.0]);
    // The second of two signals may be the velocity or the effort.
    let names = names_in("10,7,base,b,a,1,2,3,4\n10,8,base,b,a,1,2,3,4\n");
    assert_eq!(names[5..9], ["b.position", "a.position", "8", "9"]);
    let contents = inspected(text);
    assert_eq!(contents.tables[0].columns[5].name, "b.position");
    assert_eq!(contents.tables[0].times[0].column, "1+2");
    assert!((contents.tables[0].times[0].rate_hz - 125.0).abs() < 1e-6);
}

#[test]
fn other_texts_without_names_are_no_joints() {
    let text = "0,1,a,run,5\n1,2,a,stop,6\n";
    assert_eq!(columns(text, "['5']"), [5.0, 6.0]);
    assert_eq!(names_in(text)[4], "5");
    let text = "10,7,base,b,a,1,2\n10,8,base,a,b,3,4\n";
    assert!(matches!(read_text(text, "columns = ['a.position']"), Err(RecordingError::JointOrder { line: 2, .. })));
}

/// As pandas writes an array.
#[test]
fn names_that_are_numbers_from_zero() {
    assert_eq!(columns(",0,1\n0,0.5,2\n1,1.5,3\n", "['1', 'column 1']"), [2.0, 0.0, 3.0, 1.0]);
    assert_eq!(columns("0,1,2,3\n0.5,1.5,2.5,3.5\n0.6,1.6,2.6,3.6\n", "['0']"), [0.5, 0.6]);
    assert_eq!(columns("0,1,2,3\n1,2,3,4\n2,3,4,5\n", "['1']"), [0.0, 1.0, 2.0]);
}

#[test]
fn dates_with_times_of_day_in_another_column() {
    let rows =
        ["25.11.2026;23:59:59,5;1", "25.11.2026;23:59:59,75;2", "26.11.2026;00:00:00,0;3", "26.11.2026;00:00:00,25;4"];
    let contents = inspected(format!("Datum;Uhrzeit;q\n{}\n", rows.join("\n")));
    let times: Vec<&str> = contents.tables[0].times.iter().map(|time| time.column.as_str()).collect();
    assert_eq!(times[0], "Uhrzeit");
    assert!((contents.tables[0].times[0].rate_hz - 4.0).abs() < 1e-9);
}

#[test]
fn joint_states_of_ros_1_in_changing_order() {
    let text = "%time,field.name0,field.name1,field.position0,field.position1\n1,b,a,1,2\n2,b,a,3,4\n";
    assert_eq!(columns(text, "['a.position', 'field.position0']"), [2.0, 1.0, 4.0, 3.0]);
    let text = text.replace("2,b,a", "2,a,b");
    let error = read_text(&text, "columns = ['a.position']").unwrap_err();
    assert!(matches!(error, RecordingError::JointOrder { line: 3, .. }), "{error}");
    assert_eq!(columns(&text, "['time']"), [1.0, 2.0]);
}

#[test]
fn channels_in_lines() {
    let cells = |of: &dyn Fn(usize) -> String| (0..200).map(of).collect::<Vec<_>>().join(",");
    let text = format!("t,{}\nq1,{}\n", cells(&|k| format!("{}", 0.01 * k as f64)), cells(&|k| (k % 7).to_string()));
    let found = read_text(&text, "columns = ['q1', '1']\nchannels_in_rows = true").unwrap();
    assert_eq!((found.len(), found[2], found[4]), (400, 1.0, 2.0));
    // Far more cells than lines show it, so that what is listed can be read.
    assert_eq!(read_text(&text, "columns = ['q1']").unwrap().len(), 200);
    let contents = inspected(&text);
    let table = &contents.tables[0];
    assert_eq!((table.samples, table.columns[1].name.as_str(), table.columns[1].in_rows), (200, "q1", true));
    assert_eq!(table.times[0].column, "t");
    let wide = ["t", "q1"].map(|name| format!("{name}{}\n", ",1.5".repeat(12_000))).concat();
    let (folder, source) = (Folder::with(FILE, &wide), source("columns = ['q1']"));
    assert!(SignalPieces::open(&[&source], folder.path()).unwrap().is_none());
    assert_eq!(columns(&wide, "['q1']").len(), 12_000);
    let short = "q1,1,2,3\nq2,1,2\n";
    let error = read_text(short, "columns = ['q1']\nchannels_in_rows = true").unwrap_err();
    assert!(matches!(error, RecordingError::RowLength { line: 2, first_line: 1, expected: 4, found: 3, .. }));
    assert_eq!(read_text("1 2 3\n4 5 6\n", "columns = ['2']\nchannels_in_rows = true").unwrap(), [4.0, 5.0, 6.0]);
}

#[test]
fn lines_in_errors_are_those_of_the_file() {
    let text = "title of all\n\n# remark\nt;q\ns;rad\n\n0;1\n\n\n1;x\n";
    assert!(matches!(read_text(text, "columns = ['q [rad]']"), Err(RecordingError::NotANumber { line: 10, .. })));
    let text = text.replace("1;x", "1;2;3");
    let error = read_text(text, "columns = ['q [rad]']").unwrap_err();
    assert!(matches!(error, RecordingError::RowLength { line: 10, first_line: 4, .. }), "{error}");
}

#[test]
fn damaged_texts_never_panic() {
    let texts: [&[u8]; 7] = [
        b"\xff\xfet\0;\0q\0\n\x000\0;\x001\0\n\0",
        b"Title of it\nA;1\nt;q\ns;[\xb0]\n0;1.234,5\n1;2\n",
        b"%t,f.name0,f.position0\n1,a,2\n2,a,3\n",
        b"1695196914,999000000,,a,1,2,3\n1695196915,7000000,,a,7,8,9\n",
        b"t;q\n25.11.2026 10:00:00;1\n25.11.2026 10:00:01,5;2\n",
        b"t,q\n\"1,234.5\",1'234\n\"a\n\",2\n",
        b"t,1,2,3,4\nq,5,6,7,8\n",
    ];
    for whole in texts {
        for place in 0..whole.len() {
            for damage in [0x00, b'\n', b'"', b',', b';', b' ', b'#', b'+', b'9', 0xa0, 0xff] {
                let mut bytes = whole.to_vec();
                bytes[place] = damage;
                let (all, bytes) = (RequestedColumns::All, [&bytes[..], &bytes[..place]]);
                for (bytes, channels_in_rows) in bytes.into_iter().zip([false, true]) {
                    let dialect = Dialect { channels_in_rows, ..Dialect::default() };
                    let _ = read(bytes, Path::new(FILE), &dialect, all);
                }
            }
        }
    }
}
