//! What can be wrong with a bag.

use thiserror::Error;

/// Why the joint states of a bag are rejected. Messages of a topic are counted from 1 in the order of time.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BagError {
    /// No topic of the bag has joint states.
    #[error(
        "the bag has no topic of type sensor_msgs/msg/JointState in CDR; its topics are {}; \
         record such a topic, or export the recording to CSV", listed(.found)
    )]
    NoJointStates {
        /// The topics of the bag with their types.
        found: Vec<String>,
    },

    /// There is no topic of this name with joint states.
    #[error("there is no topic {topic:?} of joint states; those of the bag are {}; correct `topic`", listed(.found))]
    MissingTopic {
        /// The topic asked for.
        topic: String,
        /// The topics with joint states.
        found: Vec<String>,
    },

    /// Several topics have joint states, and none is named.
    #[error("several topics hold joint states: {}; name one by `topic = \"...\"`", listed(.found))]
    UnclearTopic {
        /// The topics with joint states.
        found: Vec<String>,
    },

    /// A message contains some of the requested joints, but not all.
    #[error(
        "topic {topic:?}, message {message}: expected joint {joint:?} as well as {present:?}, found {}; \
         ask for joints that are in the same messages", listed(.found)
    )]
    MissingJoint {
        /// The topic.
        topic: String,
        /// The message, counted from 1.
        message: usize,
        /// The missing joint.
        joint: String,
        /// A requested joint that is present.
        present: String,
        /// The joints of the message.
        found: Vec<String>,
    },

    /// A message contains a joint without the requested position, velocity or effort.
    #[error("topic {topic:?}, message {message}: expected the {field} of each joint, found none; leave it out")]
    MissingField {
        /// The topic.
        topic: String,
        /// The message, counted from 1.
        message: usize,
        /// `position`, `velocity` or `effort`.
        field: &'static str,
    },

    /// All joints were requested at once, and messages differ in their joints or in the order of them.
    #[error(
        "topic {topic:?}, message {message}: expected the joints of the first message in the same order ({}), found {}; \
         list the columns by their full names, such as \"{}.position\"",
        listed(.expected), listed(.found), .expected.first().map_or("joint", String::as_str)
    )]
    JointsChange {
        /// The topic.
        topic: String,
        /// The message, counted from 1.
        message: usize,
        /// The joints of the first message.
        expected: Vec<String>,
        /// The joints of this message.
        found: Vec<String>,
    },

    /// The time of messages was requested without a joint, and messages differ in their joints.
    #[error(
        "topic {topic:?} has messages of different joints, from several publishers; \
         ask for the time of those with one joint by \"{example}\""
    )]
    UnclearTime {
        /// The topic.
        topic: String,
        /// A name that is unambiguous.
        example: String,
    },

    /// The bytes of a message do not encode joint states.
    #[error("topic {topic:?}, message {message} in the order of the file: {reason}; record the bag again")]
    BadMessage {
        /// The topic.
        topic: String,
        /// The message, counted from 1 in the order of the file.
        message: usize,
        /// What is wrong.
        reason: String,
    },

    /// A bag in SQLite was not closed: the last changes are in a second file.
    #[error(
        "the bag was not closed: there is a file of the same name that ends in -wal; close it with `sqlite3 FILE vacuum`"
    )]
    NotClosed,
}

fn listed(names: &[String]) -> String {
    if names.is_empty() {
        return "none".to_owned();
    }
    names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
}
