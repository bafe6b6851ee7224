//! What can be wrong with a bag.

use thiserror::Error;

/// Why the signals of a bag are rejected.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BagError {
    /// No topic of the bag can be read.
    #[error(
        "the bag has no topic whose messages can be read; its topics are {}; record one of joint states, or record with a version of \
         ROS that stores the definitions of messages (MCAP, or SQLite from Iron on), or export the recording to CSV", listed(.found)
    )]
    NoTopic {
        /// The topics of the bag with their types.
        found: Vec<String>,
    },

    /// There is no topic of this name whose messages can be read.
    #[error(
        "there is no topic {topic:?} that can be read; those of the bag are {}; correct `topic`{}", listed(.found), not_read(.others)
    )]
    MissingTopic {
        /// The topic asked for.
        topic: String,
        /// The topics that are read.
        found: Vec<String>,
        /// The topics that are not read, with their types.
        others: Vec<String>,
    },

    /// The type of the messages is not known.
    #[error(
        "topic {topic:?} holds messages of type {kind:?}, whose definition is not in the bag and not known here, or not in CDR; record it in \
         MCAP or with ROS 2 Iron or later, which store definitions, or export the recording to CSV"
    )]
    UnknownType {
        /// The topic asked for.
        topic: String,
        /// The type of its messages.
        kind: String,
    },

    /// Several topics may be meant, and none is named.
    #[error("several topics may hold the signals: {}; name one by `topic = \"...\"`", listed(.found))]
    UnclearTopic {
        /// The topics.
        found: Vec<String>,
    },

    /// The column is in another topic than the one that is read.
    #[error("topic {topic:?} has no column {column:?}, but topic {other:?} has it; name that by `topic = {other:?}`")]
    ColumnOfOtherTopic {
        /// The topic that is read.
        topic: String,
        /// The column asked for.
        column: String,
        /// A topic that has the column.
        other: String,
    },

    /// No message contains all columns.
    #[error(
        "topic {topic:?}: no message that holds {present:?} also holds {column:?}; such a message holds {}; \
         ask for columns that are in the same messages", listed(.found)
    )]
    InDifferentMessages {
        /// The topic.
        topic: String,
        /// The missing column.
        column: String,
        /// A requested column that is present.
        present: String,
        /// The columns of a message with that one.
        found: Vec<String>,
    },

    /// All joints were requested at once, and messages differ in their joints or in the order of them.
    #[error(
        "topic {topic:?}, message {message}: expected the joints of the first message in the same order ({}), found {}; \
         list the columns by their full names, such as {:?}",
        listed(.expected), listed(.found), .expected.first().map_or("joint.position", String::as_str)
    )]
    JointsChange {
        /// The topic.
        topic: String,
        /// The message, counted from 1 in the order of time.
        message: usize,
        /// The columns of the first message.
        expected: Vec<String>,
        /// The columns of this message.
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

    /// A signal is not a number in some messages.
    #[error(
        "topic {topic:?}, column {column:?}: {}; {}", not_finite(*.count, *.of, *.sample, .found), remedy(.joint.as_deref(), .count == .of)
    )]
    NotFinite {
        /// The topic.
        topic: String,
        /// The column.
        column: String,
        /// The joint, if the message names one.
        joint: Option<String>,
        /// The first such sample, counted from 0.
        sample: usize,
        /// The value: NaN, an infinity, or implausibly large.
        found: String,
        /// Number of such samples.
        count: usize,
        /// Number of all samples.
        of: usize,
    },

    /// All stamps of a topic are zero.
    #[error(
        "topic {topic:?}: the stamps of all messages are 0, as its publisher sets none; use the time of the recorder: columns = [\"log_time\"]"
    )]
    NoStamp {
        /// The topic.
        topic: String,
    },

    /// A stamp is not later than the one before it.
    #[error(
        "topic {topic:?}, sample {sample} counted from 0: expected a stamp later than {previous} s, found {found} s ({count} such samples): \
         several publishers write to the topic, or a simulated clock did not run; record without the second publisher, or, \
         where all messages are of one publisher, use the time of the recorder: columns = [\"log_time\"]"
    )]
    StampsRepeat {
        /// The topic.
        topic: String,
        /// The first such sample, counted from 0.
        sample: usize,
        /// The stamp of the sample before it, in seconds.
        previous: String,
        /// Its stamp, in seconds.
        found: String,
        /// Number of such samples.
        count: usize,
    },

    /// The bytes of a message do not fit its type.
    #[error(
        "topic {topic:?}, message {message} in the order of the file: {reason}; record the bag again, or name another topic"
    )]
    BadMessage {
        /// The topic.
        topic: String,
        /// The message, counted from 1 in the order of the file.
        message: usize,
        /// What is wrong.
        reason: String,
    },

    /// A bag in SQLite was not closed: the last changes are in a second file, or what they replaced is.
    #[error(
        "the bag was not closed: there is a file of the same name that ends in {ending}; close it with `sqlite3 FILE vacuum`"
    )]
    NotClosed {
        /// The end of the second file's name.
        ending: &'static str,
    },

    /// The metadata of a bag name no file that can be read.
    #[error(
        "expected .db3 or .mcap files below relative_file_paths in metadata.yaml, found {}; write it anew with `ros2 bag reindex`, or name \
         the files themselves", listed(.found)
    )]
    BadMetadata {
        /// The files that it names.
        found: Vec<String>,
    },
}

fn not_finite(count: usize, of: usize, sample: usize, found: &str) -> String {
    match count == of {
        true => format!("none of its {of} samples is a finite number below 1e30, the first is {found}"),
        false => format!(
            "{count} of {of} samples are not finite numbers below 1e30, the first is sample {sample} counted from 0, {found}"
        ),
    }
}

fn remedy(joint: Option<&str>, is_all: bool) -> String {
    let cut = if is_all { "" } else { "cut the recording to the part without gaps, " };
    match joint {
        Some(joint) => format!("{cut}lock joint {joint:?} (`[locked]`), leave it out, or name another column"),
        None => format!("{cut}leave it out, or name another column"),
    }
}

fn listed(names: &[String]) -> String {
    if names.is_empty() {
        return "none".to_owned();
    }
    names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
}

fn not_read(others: &[String]) -> String {
    if others.is_empty() { String::new() } else { format!("; not read are {}", listed(others)) }
}
