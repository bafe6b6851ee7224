//! ROS 2 bags: topics of `sensor_msgs/msg/JointState`, in SQLite (`.db3`) or MCAP (`.mcap`).
//!
//! Each message names its joints. A topic therefore has, for each joint, the columns `<joint>.position`,
//! `<joint>.velocity` and `<joint>.effort`, looked up by name in every message, and the times `stamp` (of the header) and
//! `log_time` (of the recorder), in seconds from the first message of the topic: whole nanoseconds are subtracted before
//! they become floating-point numbers, since a date in seconds leaves no room for them. Several publishers may share a
//! topic; messages that hold none of the joints asked for are passed over, and `<joint>.stamp` and `<joint>.log_time` are
//! the times of the messages that hold a joint.
//!
//! | file | what it does |
//! | --- | --- |
//! | `cdr` | the bytes of a message to joint states |
//! | `topic` | the messages of a topic |
//! | `channels` | joints by name over all messages |
//! | `tables` | all columns of a topic, for inspection |
//! | `db3`, `mcap` | the two kinds of bags |
//! | `error` | what can be wrong with a bag |

#[cfg(feature = "rosbag")]
mod cdr;
#[cfg(feature = "rosbag")]
mod channels;
#[cfg(feature = "rosbag")]
mod db3;
mod error;
#[cfg(feature = "rosbag")]
mod mcap;
#[cfg(feature = "rosbag")]
mod tables;
#[cfg(feature = "rosbag")]
mod topic;

use std::path::Path;

pub use error::BagError;

use super::table::Table;
use super::{Format, RecordingError};
use crate::series::Series;

/// The named columns of a topic, one channel each.
#[cfg(feature = "rosbag")]
pub(super) fn channels(
    path: &Path,
    format: Format,
    topic: Option<&str>,
    columns: &[String],
) -> Result<Series, RecordingError> {
    channels::of(&read(path, format, topic)?, topic, columns)
}

/// All topics with joint states, and the names and types of the other topics.
#[cfg(feature = "rosbag")]
pub(super) fn tables(path: &Path, format: Format) -> Result<(Vec<Table>, Vec<(String, String)>), RecordingError> {
    let topics = read(path, format, None)?;
    Ok((topics.list.iter().flat_map(tables::of).collect(), topics.others))
}

#[cfg(feature = "rosbag")]
fn read(path: &Path, format: Format, topic: Option<&str>) -> Result<topic::Topics, RecordingError> {
    let topics = if format == Format::Mcap { mcap::read(path, topic)? } else { db3::read(path, topic)? };
    Ok(topics.in_order_of_time())
}

#[cfg(not(feature = "rosbag"))]
pub(super) fn channels(path: &Path, _: Format, _: Option<&str>, _: &[String]) -> Result<Series, RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "ROS 2 bags", feature: "rosbag" })
}

#[cfg(not(feature = "rosbag"))]
pub(super) fn tables(path: &Path, _: Format) -> Result<(Vec<Table>, Vec<(String, String)>), RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "ROS 2 bags", feature: "rosbag" })
}

/// Reads all joint states of a bag in SQLite, and forgets them.
#[cfg(feature = "rosbag")]
pub(super) fn fuzz_db3(bytes: &[u8]) {
    let _ = db3::read_bytes(bytes, Path::new("fuzz.db3")).map(|topics| topics.in_order_of_time().list.iter().map(tables::of).count());
}

/// Reads all joint states of a bag in MCAP, and forgets them.
#[cfg(feature = "rosbag")]
pub(super) fn fuzz_mcap(bytes: &[u8]) {
    let topics = mcap::read_from(bytes, bytes.len() as u64, Path::new("fuzz.mcap"), None);
    let _ = topics.map(|topics| topics.in_order_of_time().list.iter().map(tables::of).count());
}

#[cfg(all(test, feature = "rosbag"))]
mod tests;
