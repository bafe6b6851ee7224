//! Bags of ROS: ROS 2 in SQLite (`.db3`) or MCAP (`.mcap`), alone, compressed, or several in a folder, and ROS 1 (`.bag`).
//!
//! Messages of any type are read whose definition the bag holds, or that is known here. Each number of a message is a column. Where the
//! message names its joints, columns are looked up by the name in every message: `elbow.position`, `elbow.feedback.velocity`. Others are
//! numbered from 0: `motor_state[3].q`. The times are `stamp` (of the header, if there is one) and `log_time` (of the recorder), in seconds
//! from the first message of the topic: whole nanoseconds are subtracted before they become floating-point numbers, since a date in seconds
//! leaves no room for them.
//!
//! Several publishers may share a topic. The messages that are read are those with all requested columns; messages with fewer signals than
//! others are left out, so that all signals of a recording have the same samples. `<joint>.stamp` and `<joint>.log_time` are the times of
//! the messages that contain a joint. Messages with stamp 0 before a simulated clock runs are left out as well.
//!
//! | file | what it does |
//! | --- | --- |
//! | `schema` | the types of messages, linked |
//! | `definition`, `idl`, `idl_tokens` | types from their texts |
//! | `built_in` | types of common messages, for bags without definitions |
//! | `cursor`, `decode` | numbers, lengths and names from the bytes of a message |
//! | `shape`, `naming` | the names of the signals of a message |
//! | `topic`, `topics` | the messages of a topic; the topics of a bag |
//! | `layouts` | which messages are read where several publishers share a topic |
//! | `asked`, `channels` | signals by name across all messages |
//! | `tables` | all columns of a topic, for inspection |
//! | `db3`, `mcap`, `ros1` with `ros1_entry` | the kinds of bags |
//! | `zstd`, `metadata` | compressed files and messages; bags of several files |
//! | `file`, `read` | reads a file, and a bag, by its format |
//! | `other_topic` | topics that are not read |
//! | `error` | what can be wrong with a bag |

#[cfg(feature = "rosbag")]
mod asked;
#[cfg(feature = "rosbag")]
mod built_in;
#[cfg(feature = "rosbag")]
mod channels;
#[cfg(feature = "rosbag")]
mod cursor;
#[cfg(feature = "rosbag")]
mod db3;
#[cfg(feature = "rosbag")]
mod decode;
#[cfg(feature = "rosbag")]
mod definition;
mod error;
#[cfg(feature = "rosbag")]
mod file;
#[cfg(feature = "rosbag")]
mod idl;
#[cfg(feature = "rosbag")]
mod idl_tokens;
#[cfg(feature = "rosbag")]
mod layouts;
#[cfg(feature = "rosbag")]
mod mcap;
#[cfg(feature = "rosbag")]
mod metadata;
#[cfg(feature = "rosbag")]
mod naming;
mod other_topic;
mod read;
#[cfg(feature = "rosbag")]
mod ros1;
#[cfg(feature = "rosbag")]
mod ros1_entry;
#[cfg(feature = "rosbag")]
mod schema;
#[cfg(feature = "rosbag")]
mod shape;
#[cfg(feature = "rosbag")]
mod tables;
#[cfg(feature = "rosbag")]
mod topic;
#[cfg(feature = "rosbag")]
mod topics;
#[cfg(feature = "rosbag")]
mod zstd;

pub use error::BagError;
pub use other_topic::OtherTopic;
pub(super) use read::{channels, tables};
#[cfg(feature = "rosbag")]
pub(super) use read::{fuzz_db3, fuzz_mcap, fuzz_ros1};

#[cfg(all(test, feature = "rosbag"))]
mod tests;
