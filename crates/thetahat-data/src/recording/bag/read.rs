//! The joint states of a bag of either kind.

use std::path::Path;

use super::super::error::RecordingError;
use super::super::format::Format;
use super::super::table::Table;
use super::other_topic::OtherTopic;
#[cfg(feature = "rosbag")]
use super::{db3, mcap, topic::Topics};
use thetahat_ground::series::Series;

/// The named columns of a topic, one channel each.
#[cfg(feature = "rosbag")]
pub(in super::super) fn channels(
    path: &Path,
    format: Format,
    topic: Option<&str>,
    columns: &[String],
) -> Result<Series, RecordingError> {
    super::channels::of(&read(path, format, topic)?, topic, columns)
}

/// All topics with joint states, and the names and types of the other topics.
#[cfg(feature = "rosbag")]
pub(in super::super) fn tables(path: &Path, format: Format) -> Result<(Vec<Table>, Vec<OtherTopic>), RecordingError> {
    let topics = read(path, format, None)?;
    Ok((topics.list.iter().flat_map(super::tables::of).collect(), topics.others))
}

#[cfg(feature = "rosbag")]
fn read(path: &Path, format: Format, topic: Option<&str>) -> Result<Topics, RecordingError> {
    let topics = if format == Format::Mcap { mcap::read(path, topic)? } else { db3::read(path, topic)? };
    Ok(topics.in_order_of_time())
}

#[cfg(not(feature = "rosbag"))]
pub(in super::super) fn channels(
    path: &Path,
    _: Format,
    _: Option<&str>,
    _: &[String],
) -> Result<Series, RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "ROS 2 bags", feature: "rosbag" })
}

#[cfg(not(feature = "rosbag"))]
pub(in super::super) fn tables(path: &Path, _: Format) -> Result<(Vec<Table>, Vec<OtherTopic>), RecordingError> {
    Err(RecordingError::FeatureMissing { file: path.to_owned(), format: "ROS 2 bags", feature: "rosbag" })
}

/// Reads and discards all joint states of a bag in SQLite.
#[cfg(feature = "rosbag")]
pub(in super::super) fn fuzz_db3(bytes: &[u8]) {
    let _ = db3::read_bytes(bytes, Path::new("fuzz.db3"))
        .map(|topics| topics.in_order_of_time().list.iter().map(super::tables::of).count());
}

/// Reads and discards all joint states of a bag in MCAP.
#[cfg(feature = "rosbag")]
pub(in super::super) fn fuzz_mcap(bytes: &[u8]) {
    let topics = mcap::read_from(bytes, bytes.len() as u64, Path::new("fuzz.mcap"), None);
    let _ = topics.map(|topics| topics.in_order_of_time().list.iter().map(super::tables::of).count());
}
