//! The signals of a bag of any kind.

use std::path::Path;

use super::super::error::RecordingError;
use super::super::format::Format;
#[cfg(feature = "rosbag")]
use super::super::place::file_length;
use super::super::table::Table;
use super::other_topic::OtherTopic;
#[cfg(feature = "rosbag")]
use super::{db3, file, mcap, metadata, ros1, topic::Topic, topics::Topics};
use thetahat_ground::series::Series;

/// The named columns of a topic, one channel each.
#[cfg(feature = "rosbag")]
pub(in super::super) fn channels(
    path: &Path,
    format: Format,
    topic: Option<&str>,
    columns: &[String],
) -> Result<Series, RecordingError> {
    super::channels::of(read(path, format, topic)?, topic, columns)
}

/// All topics that can be read, those of joint states first, then those that name joints; and the names and types of the other topics.
/// Where joint states hold positions and efforts, they are the recording: the others are named, and read where a signal names them.
#[cfg(feature = "rosbag")]
pub(in super::super) fn tables(path: &Path, format: Format) -> Result<(Vec<Table>, Vec<OtherTopic>), RecordingError> {
    tables_of(read(path, format, None)?)
}

#[cfg(feature = "rosbag")]
pub(super) fn tables_of(mut topics: Topics) -> Result<(Vec<Table>, Vec<OtherTopic>), RecordingError> {
    topics.list.sort_by_key(|topic| (!topic.is_joint_state(), !topic.has_joints()));
    let (mut tables, mut others) = (Vec::new(), topics.others);
    let are_enough = topics.list.iter().any(|t| t.is_joint_state() && t.has_field("position") && t.has_field("effort"));
    for topic in &mut topics.list {
        match topic.problem.take() {
            Some(problem) if topic.is_joint_state() => return Err(problem),
            Some(_) => others.push(other(topic, String::new())),
            None => others.extend(left_out(topic)),
        }
        if are_enough && !topic.is_joint_state() && topic.has_signals() {
            let remark = format!(", {} signals: read where topic = {:?} names it", topic.count(), topic.name);
            others.push(other(topic, remark));
        } else if topic.has_signals() {
            tables.extend(super::tables::of(topic));
        }
    }
    Ok((tables, others))
}

/// Messages of a topic that are left out, as a remark for the user.
#[cfg(feature = "rosbag")]
fn left_out(topic: &Topic) -> Vec<OtherTopic> {
    let is_read = super::layouts::is_read(topic);
    let fewer = topic.messages.iter().filter(|message| !is_read[message.layout]).count();
    let mut remarks = Vec::new();
    if !topic.has_signals() && !topic.is_joint_state() {
        remarks.push(other(topic, ", no messages with numbers".to_owned()));
    }
    if fewer > 0 {
        remarks.push(other(topic, format!(", {fewer} messages of another publisher with fewer signals")));
    }
    if topic.without_stamp > 0 {
        let count = topic.without_stamp;
        remarks.push(other(
            topic,
            format!(", {count} messages with stamp 0 at the start, before the simulated clock ran"),
        ));
    }
    remarks
}

#[cfg(feature = "rosbag")]
fn other(topic: &Topic, remark: String) -> OtherTopic {
    OtherTopic { name: topic.name.clone(), kind: topic.kind.clone() + &remark }
}

#[cfg(feature = "rosbag")]
fn read(path: &Path, format: Format, topic: Option<&str>) -> Result<Topics, RecordingError> {
    if format == Format::Metadata {
        return metadata::read(path, topic).map(Topics::in_order_of_time);
    }
    let mut topics = Topics::new(path, file_length(path)?);
    file::add(path, format, topic, &mut topics)?;
    Ok(topics.in_order_of_time())
}

#[cfg(not(feature = "rosbag"))]
pub(in super::super) fn channels(
    path: &Path,
    _: Format,
    _: Option<&str>,
    _: &[String],
) -> Result<Series, RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "ROS bags", feature: "rosbag" })
}

#[cfg(not(feature = "rosbag"))]
pub(in super::super) fn tables(path: &Path, _: Format) -> Result<(Vec<Table>, Vec<OtherTopic>), RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "ROS bags", feature: "rosbag" })
}

/// Reads and discards all messages of a bag in SQLite.
#[cfg(feature = "rosbag")]
pub(in super::super) fn fuzz_db3(bytes: &[u8]) {
    let mut topics = Topics::new(Path::new("fuzz.db3"), bytes.len() as u64);
    let _ = db3::read_bytes(bytes, None, &mut topics).and_then(|()| tables_of(topics.in_order_of_time()));
}

/// Reads and discards all messages of a bag in MCAP.
#[cfg(feature = "rosbag")]
pub(in super::super) fn fuzz_mcap(bytes: &[u8]) {
    let mut topics = Topics::new(Path::new("fuzz.mcap"), bytes.len() as u64);
    let _ = mcap::read_from(bytes, None, &mut topics).and_then(|()| tables_of(topics.in_order_of_time()));
}

/// Reads and discards all messages of a bag of ROS 1.
#[cfg(feature = "rosbag")]
pub(in super::super) fn fuzz_ros1(bytes: &[u8]) {
    let mut topics = Topics::new(Path::new("fuzz.bag"), bytes.len() as u64);
    let read = ros1::read_from(bytes, bytes.len() as u64, None, &mut topics);
    let _ = read.and_then(|()| tables_of(topics.in_order_of_time()));
}
