//! Bags of joint states that tests write themselves.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::PathBuf;

use ::mcap::records::MessageHeader;
use ::mcap::{Compression, WriteOptions};
use rusqlite::Connection;

use super::super::super::{Format, RecordingError};
use super::super::{BagError, channels};
use thetahat_ground::series::Series;
use thetahat_testing::Folder;

pub(super) const START_S: i32 = 1_700_000_000;

/// The bytes of a message, in the order of bytes of `number`.
pub(super) struct Message {
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
pub(super) fn message(big: bool, time_ns: u32, joints: &[&str], fields: [&[f64]; 3]) -> Vec<u8> {
    let mut message = Message { bytes: vec![0, u8::from(!big), 0, 0], big };
    message.word(START_S.cast_unsigned());
    message.word(time_ns);
    message.text("base");
    message.word(joints.len() as u32);
    joints.iter().for_each(|joint| message.text(joint));
    fields.iter().for_each(|field| message.numbers(field));
    message.bytes
}

pub(super) fn states(time_ns: u32, joints: &[&str], position: &[f64]) -> Vec<u8> {
    message(false, time_ns, joints, [position, position, &[]])
}

/// Three messages, of which the second names its joints in another order.
pub(super) fn arm() -> Vec<Vec<u8>> {
    vec![
        states(1, &["shoulder", "elbow"], &[1.0, 2.0]),
        states(8_000_001, &["elbow", "shoulder"], &[4.0, 3.0]),
        states(16_000_002, &["shoulder", "elbow"], &[5.0, 6.0]),
    ]
}

pub(super) const TOPIC: &str = "/joint_states";

/// A bag in SQLite with these messages.
pub(super) fn db3(messages: &[(&str, Vec<u8>)]) -> (Folder, PathBuf) {
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
pub(super) fn mcap(messages: &[(&str, Vec<u8>)], compression: Option<Compression>) -> Vec<u8> {
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

pub(super) fn on_topic(messages: Vec<Vec<u8>>) -> Vec<(&'static str, Vec<u8>)> {
    messages.into_iter().map(|message| (TOPIC, message)).collect()
}

pub(super) fn loaded(
    messages: &[(&str, Vec<u8>)],
    topic: Option<&str>,
    columns: &[&str],
) -> Result<Series, RecordingError> {
    let (_folder, path) = db3(messages);
    let columns: Vec<String> = columns.iter().map(|&c| c.to_owned()).collect();
    channels(&path, Format::Db3, topic, &columns)
}

pub(super) fn problem(messages: &[(&str, Vec<u8>)], topic: Option<&str>, columns: &[&str]) -> BagError {
    match loaded(messages, topic, columns) {
        Err(RecordingError::Bag { problem, .. }) => *problem,
        other => panic!("{other:?}"),
    }
}
