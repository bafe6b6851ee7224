//! ROS 2 bags: topics of `sensor_msgs/msg/JointState`, in SQLite (`.db3`) or MCAP (`.mcap`).
//!
//! Each message names its joints. A topic therefore has, for each joint, the columns `<joint>.position`,
//! `<joint>.velocity` and `<joint>.effort`, looked up by name in every message, and the times `stamp` (of the header) and
//! `log_time` (of the recorder), in seconds from the first message of the topic: whole nanoseconds are subtracted before
//! they become floating-point numbers, since a date in seconds leaves no room for them. Several publishers may share a
//! topic; messages without any of the requested joints are skipped, and `<joint>.stamp` and `<joint>.log_time` are the times of the
//! messages that contain a joint.
//!
//! | file | what it does |
//! | --- | --- |
//! | `cdr` | converts the bytes of a message to joint states |
//! | `topic` | the messages of a topic |
//! | `channels` | joints by name across all messages |
//! | `tables` | all columns of a topic, for inspection |
//! | `db3`, `mcap` | the two kinds of bags |
//! | `read` | reads a bag by its format |
//! | `other_topic` | topics that are not read |
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
mod other_topic;
mod read;
#[cfg(feature = "rosbag")]
mod tables;
#[cfg(feature = "rosbag")]
mod topic;

pub use error::BagError;
pub use other_topic::OtherTopic;
pub(super) use read::{channels, tables};
#[cfg(feature = "rosbag")]
pub(super) use read::{fuzz_db3, fuzz_mcap};

#[cfg(all(test, feature = "rosbag"))]
mod tests;
