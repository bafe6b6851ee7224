use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use ::mcap::records::MessageHeader;
use ::mcap::{Compression, WriteOptions};
use rusqlite::Connection;

use super::super::{Format, RecordingError};
use super::cdr::joint_state;
use super::*;
use thetahat_ground::series::Series;
use thetahat_testing::Folder;

const START_S: i32 = 1_700_000_000;

/// The bytes of a message, in the order of bytes of `number`.
struct Message {
    bytes: Vec<u8>,
    big: bool,
}

impl Message {
    fn align(&mut self, size: usize) {
        let end = 4 + (self.bytes.len() - 4).next_multiple_of(size);
        self.bytes.resize(end, 0);
    }

    fn word(&mut self, word: u32) {
        self.align(4);
        self.bytes.extend(if self.big { word.to_be_bytes() } else { word.to_le_bytes() });
    }

    fn text(&mut self, text: &str) {
        self.word(text.len() as u32 + 1);
        self.bytes.extend(text.bytes().chain([0]));
    }

    fn numbers(&mut self, numbers: &[f64]) {
        self.word(numbers.len() as u32);
        for number in numbers {
            self.align(8);
            self.bytes.extend(if self.big { number.to_be_bytes() } else { number.to_le_bytes() });
        }
    }
}

/// Joint states at a time in nanoseconds from the start.
fn message(big: bool, time_ns: u32, joints: &[&str], fields: [&[f64]; 3]) -> Vec<u8> {
    let mut message = Message { bytes: vec![0, u8::from(!big), 0, 0], big };
    message.word(START_S.cast_unsigned());
    message.word(time_ns);
    message.text("base");
    message.word(joints.len() as u32);
    joints.iter().for_each(|joint| message.text(joint));
    fields.iter().for_each(|field| message.numbers(field));
    message.bytes
}

fn states(time_ns: u32, joints: &[&str], position: &[f64]) -> Vec<u8> {
    message(false, time_ns, joints, [position, position, &[]])
}

/// Three messages, of which the second names its joints in another order.
fn arm() -> Vec<Vec<u8>> {
    vec![
        states(1, &["shoulder", "elbow"], &[1.0, 2.0]),
        states(8_000_001, &["elbow", "shoulder"], &[4.0, 3.0]),
        states(16_000_002, &["shoulder", "elbow"], &[5.0, 6.0]),
    ]
}

const TOPIC: &str = "/joint_states";

/// A bag in SQLite with these messages.
fn db3(messages: &[(&str, Vec<u8>)]) -> (Folder, PathBuf) {
    let folder = Folder::with("notes.txt", b"");
    let path = folder.path().join("bag #1.db3");
    let connection = Connection::open(&path).unwrap();
    let tables = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
            serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
        CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
            data BLOB NOT NULL);
        INSERT INTO topics VALUES (100, '/rosout', 'rcl_interfaces/msg/Log', 'cdr', '');";
    connection.execute_batch(tables).unwrap();
    for (time, (topic, data)) in messages.iter().enumerate() {
        let insert = "INSERT INTO topics SELECT NULL, ?1, 'sensor_msgs/msg/JointState', 'cdr', ''
            WHERE NOT EXISTS (SELECT 1 FROM topics WHERE name = ?1)";
        connection.execute(insert, [topic]).unwrap();
        let insert = "INSERT INTO messages SELECT NULL, id, ?2, ?3 FROM topics WHERE name = ?1";
        connection.execute(insert, (topic, 1_700_000_000_000_000_000 + 8_000_000 * time as i64, data)).unwrap();
    }
    (folder, path)
}

/// A bag in MCAP with these messages, of which the first is written last.
fn mcap(messages: &[(&str, Vec<u8>)], compression: Option<Compression>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = WriteOptions::new().compression(compression).create(&mut bytes).unwrap();
    let schema = writer.add_schema("sensor_msgs/msg/JointState", "ros2msg", b"").unwrap();
    let other = writer.add_schema("rcl_interfaces/msg/Log", "ros2msg", b"").unwrap();
    writer.add_channel(other, "/rosout", "cdr", &BTreeMap::new()).unwrap();
    let mut order: Vec<usize> = (0..messages.len()).collect();
    order.rotate_left(1);
    for number in order {
        let (topic, data) = &messages[number];
        let channel_id = writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap();
        let log_time = 1_700_000_000_000_000_000 + 8_000_000 * number as u64;
        let header = MessageHeader { channel_id, sequence: number as u32, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

fn on_topic(messages: Vec<Vec<u8>>) -> Vec<(&'static str, Vec<u8>)> {
    messages.into_iter().map(|message| (TOPIC, message)).collect()
}

fn loaded(messages: &[(&str, Vec<u8>)], topic: Option<&str>, columns: &[&str]) -> Result<Series, RecordingError> {
    let (_folder, path) = db3(messages);
    let columns: Vec<String> = columns.iter().map(|&c| c.to_owned()).collect();
    channels(&path, Format::Db3, topic, &columns)
}

fn problem(messages: &[(&str, Vec<u8>)], topic: Option<&str>, columns: &[&str]) -> BagError {
    match loaded(messages, topic, columns) {
        Err(RecordingError::Bag { problem, .. }) => *problem,
        other => panic!("{other:?}"),
    }
}

#[test]
fn joints_are_found_by_name_in_every_message() {
    let series = loaded(&on_topic(arm()), None, &["elbow.position", "shoulder.velocity"]).unwrap();
    assert_eq!(series.values(), [2.0, 1.0, 4.0, 3.0, 6.0, 5.0]);
}

#[test]
fn times_are_seconds_from_the_first_message_to_the_nanosecond() {
    let series = loaded(&on_topic(arm()), None, &["stamp", "log_time"]).unwrap();
    assert_eq!(
        series.values(),
        [0.0, 0.0, 8_000_000.0 * 1e-9, 8_000_000.0 * 1e-9, 16_000_001.0 * 1e-9, 16_000_000.0 * 1e-9]
    );
}

#[test]
fn bag_in_mcap_says_the_same_as_in_sqlite() {
    let messages = on_topic(arm());
    let columns = ["stamp".to_owned(), "elbow.position".to_owned(), "log_time".to_owned()];
    let expected = loaded(&messages, None, &["stamp", "elbow.position", "log_time"]).unwrap();
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let folder = Folder::with("bag.mcap", mcap(&messages, compression));
        let series = channels(&folder.path().join("bag.mcap"), Format::Mcap, None, &columns).unwrap();
        assert_eq!(series, expected);
    }
}

#[test]
fn both_orders_of_bytes() {
    let fields: [&[f64]; 3] = [&[1.0, 2.0], &[], &[3.0, 4.0]];
    let (little, big) = (message(false, 5, &["a", "bc"], fields), message(true, 5, &["a", "bc"], fields));
    let state = joint_state(&little).unwrap();
    assert_eq!(state, joint_state(&big).unwrap());
    assert_eq!(
        (state.stamp_ns, state.names.as_slice()),
        (i64::from(START_S) * 1_000_000_000 + 5, ["a", "bc"].as_slice())
    );
    assert_eq!(state.fields, [vec![1.0, 2.0], vec![], vec![3.0, 4.0]]);
}

#[test]
fn message_cut_short_or_damaged_never_panics() {
    let whole = message(false, 5, &["a", "bc"], [&[1.0, 2.0], &[], &[3.0, 4.0]]);
    for length in 0..whole.len() {
        assert!(joint_state(&whole[..length]).is_err(), "{length}");
    }
    for place in 0..whole.len() {
        for damage in 0..=255 {
            let mut bytes = whole.clone();
            bytes[place] = damage;
            let _ = joint_state(&bytes);
        }
    }
}

#[test]
fn messages_of_other_publishers_are_passed_over() {
    let mut messages = on_topic(arm());
    messages.insert(1, (TOPIC, states(9, &["gripper"], &[0.1])));
    assert_eq!(loaded(&messages, None, &["elbow.position"]).unwrap().values(), [2.0, 4.0, 6.0]);
    assert_eq!(loaded(&messages, None, &["elbow.stamp"]).unwrap().len(), 3);
    assert!(
        matches!(problem(&messages, None, &["stamp"]), BagError::UnclearTime { example, .. } if example == "shoulder.stamp")
    );
}

#[test]
fn joint_that_one_message_lacks() {
    let mut messages = on_topic(arm());
    messages.push((TOPIC, states(9, &["shoulder"], &[0.1])));
    let problem = problem(&messages, None, &["shoulder.position", "elbow.position"]);
    assert!(matches!(problem, BagError::MissingJoint { message: 4, joint, .. } if joint == "elbow"));
}

#[test]
fn field_that_no_message_has() {
    let problem = problem(&on_topic(arm()), None, &["elbow.effort"]);
    assert!(matches!(problem, BagError::MissingField { message: 1, field: "effort", .. }));
}

#[test]
fn joint_that_is_nowhere() {
    let error = loaded(&on_topic(arm()), None, &["wrist.position"]).unwrap_err();
    assert!(
        matches!(error, RecordingError::MissingColumn { found, .. } if found.contains(&"elbow.position".to_owned()))
    );
}

#[test]
fn all_joints_at_once_only_if_their_order_stays() {
    let problem = problem(&on_topic(arm()), None, &["position"]);
    assert!(matches!(problem, BagError::JointsChange { message: 2, .. }));
    let steady = on_topic(arm().into_iter().step_by(2).collect());
    assert_eq!(loaded(&steady, None, &["position"]).unwrap().values(), [1.0, 2.0, 5.0, 6.0]);
}

#[test]
fn topic_is_named_where_there_are_several() {
    let mut messages = on_topic(arm());
    messages.push(("/other/joint_states", states(9, &["elbow"], &[0.1])));
    assert!(
        matches!(problem(&messages, None, &["elbow.position"]), BagError::UnclearTopic { found } if found.len() == 2)
    );
    let other = Some("/other/joint_states");
    assert_eq!(loaded(&messages, other, &["elbow.position"]).unwrap().values(), [0.1]);
    assert!(matches!(problem(&messages, Some("/absent"), &["elbow.position"]), BagError::MissingTopic { .. }));
}

#[test]
fn bag_without_joint_states() {
    let problem = problem(&[], None, &["elbow.position"]);
    assert!(matches!(problem, BagError::NoJointStates { found } if found == ["/rosout (rcl_interfaces/msg/Log)"]));
}

#[test]
fn message_that_is_damaged() {
    let mut messages = on_topic(arm());
    messages[1].1.truncate(40);
    assert!(matches!(problem(&messages, None, &["elbow.position"]), BagError::BadMessage { message: 2, .. }));
}

#[test]
fn joint_named_twice() {
    let messages = on_topic(vec![states(0, &["elbow", "elbow"], &[1.0, 2.0])]);
    assert!(matches!(problem(&messages, None, &["elbow.position"]), BagError::BadMessage { message: 1, .. }));
}

#[test]
fn position_that_is_nan() {
    let messages = on_topic(vec![states(0, &["elbow"], &[f64::NAN])]);
    let error = loaded(&messages, None, &["elbow.position"]).unwrap_err();
    assert!(matches!(error, RecordingError::NotFiniteSample { sample: 0, .. }));
}

/// The error for a bag whose schema was changed.
fn changed(sql: &str) -> RecordingError {
    let (_folder, path) = db3(&on_topic(arm()));
    Connection::open(&path).unwrap().execute_batch(sql).unwrap();
    channels(&path, Format::Db3, None, &["elbow.position".to_owned()]).unwrap_err()
}

#[test]
fn view_that_stands_in_for_a_table() {
    let error = changed("ALTER TABLE messages RENAME TO m; CREATE VIEW messages AS SELECT * FROM m;");
    assert!(matches!(error, RecordingError::Damaged { reason, .. } if reason.contains("messages")));
}

#[test]
fn view_that_never_ends_is_not_a_table_either() {
    let endless =
        "DROP TABLE messages; CREATE VIEW messages AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c)
        SELECT x AS id, 1 AS topic_id, x AS timestamp, x'00' AS data FROM c;";
    assert!(matches!(changed(endless), RecordingError::Damaged { .. }));
}

#[test]
fn message_that_is_not_a_blob() {
    let error = changed("UPDATE messages SET data = 'text'");
    assert!(matches!(error, RecordingError::Damaged { .. }), "{error}");
}

#[test]
fn bag_that_was_not_closed() {
    let (_folder, path) = db3(&on_topic(arm()));
    fs::write(path.with_file_name("bag #1.db3-wal"), b"log").unwrap();
    let error = channels(&path, Format::Db3, None, &["elbow.position".to_owned()]).unwrap_err();
    assert!(matches!(error, RecordingError::Bag { problem, .. } if *problem == BagError::NotClosed));
}

#[test]
fn reading_leaves_no_file_next_to_the_bag() {
    let (folder, path) = db3(&on_topic(arm()));
    channels(&path, Format::Db3, None, &["elbow.position".to_owned()]).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn other_files() {
    for (name, format) in [("bag.db3", Format::Db3), ("bag.mcap", Format::Mcap)] {
        let folder = Folder::with(name, b"t,q\n0,1\n".repeat(100));
        let error = channels(&folder.path().join(name), format, None, &["elbow.position".to_owned()]).unwrap_err();
        assert!(matches!(error, RecordingError::Damaged { .. }), "{error}");
    }
}

#[test]
fn mcap_cut_short() {
    let whole = mcap(&on_topic(arm()), Some(Compression::Zstd));
    for length in 1..whole.len() {
        let result = mcap::read_from(&whole[..length], length as u64, Path::new("bag.mcap"), None);
        assert!(matches!(result.err(), Some(RecordingError::Damaged { .. })), "{length}");
    }
}

#[test]
fn damaged_bags_never_panic() {
    let (_folder, path) = db3(&on_topic(arm()));
    let (sqlite, mcap) = (fs::read(path).unwrap(), mcap(&on_topic(arm()), Some(Compression::Zstd)));
    let damage = |whole: &[u8], read: fn(&[u8])| {
        for place in (0..whole.len()).filter(|&place| place < 4096 || whole[place] != 0) {
            for damage in [0x00, 0x01, 0x7f, 0xff] {
                let mut bytes = whole.to_vec();
                bytes[place] = damage;
                read(&bytes);
            }
        }
    };
    damage(&sqlite, fuzz_db3);
    damage(&mcap, fuzz_mcap);
}

#[test]
fn summary_has_a_table_for_each_publisher() {
    let mut messages = on_topic(arm());
    messages.insert(1, (TOPIC, states(9, &["gripper"], &[0.1])));
    let (_folder, path) = db3(&messages);
    let (tables, others) = tables(&path, Format::Db3).unwrap();
    let names: Vec<Vec<&str>> = tables.iter().map(|t| t.columns.iter().map(|c| c.name.as_str()).collect()).collect();
    let arm = [
        "shoulder.stamp",
        "shoulder.log_time",
        "shoulder.position",
        "shoulder.velocity",
        "elbow.position",
        "elbow.velocity",
    ];
    assert_eq!(names[0], arm);
    assert_eq!(names[1], ["gripper.stamp", "gripper.log_time", "gripper.position", "gripper.velocity"]);
    assert_eq!(others, [OtherTopic { name: "/rosout".to_owned(), kind: "rcl_interfaces/msg/Log".to_owned() }]);
}
