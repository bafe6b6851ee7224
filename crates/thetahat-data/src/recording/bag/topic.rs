//! The messages of a topic.

use std::path::{Path, PathBuf};

use super::super::budget::Budget;
use super::super::error::RecordingError;
use super::cdr::joint_state;
use super::error::BagError;
use super::other_topic::OtherTopic;

/// The type of messages that is read.
pub(super) const JOINT_STATE: &str = "sensor_msgs/msg/JointState";
/// Different lists of joints that a topic may have.
const MOST_LISTS: usize = 256;

/// The topics of a bag.
pub(super) struct Topics {
    pub(super) path: PathBuf,
    pub(super) list: Vec<Topic>,
    /// Topics that are not read.
    pub(super) others: Vec<OtherTopic>,
    budget: Budget,
}

/// A topic of joint states.
pub(super) struct Topic {
    pub(super) name: String,
    /// The different lists of joints that messages name, in the order in which they appear.
    pub(super) joints: Vec<Vec<String>>,
    pub(super) messages: Vec<Message>,
    values: Vec<f64>,
}

/// A message: its list of joints, its times, and the position of its values.
#[derive(Clone, Copy)]
pub(super) struct Message {
    pub(super) joints: usize,
    pub(super) stamp_ns: i64,
    pub(super) log_time_ns: i64,
    start: usize,
    /// Which of positions, velocities and efforts are present.
    present: [bool; 3],
}

/// A quantity that a message holds for a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Field {
    Position,
    Velocity,
    Effort,
}

impl Field {
    pub(super) const ALL: [Self; 3] = [Self::Position, Self::Velocity, Self::Effort];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Effort => "effort",
        }
    }
}

impl Topics {
    pub(super) fn new(path: &Path, file_bytes: u64) -> Self {
        let budget = Budget::of(path, file_bytes);
        Self { path: path.to_owned(), list: Vec::new(), others: Vec::new(), budget }
    }

    /// Adds a topic without messages and returns its index.
    pub(super) fn add_topic(&mut self, name: String) -> usize {
        if let Some(place) = self.list.iter().position(|topic| topic.name == name) {
            return place;
        }
        self.list.push(Topic { name, joints: Vec::new(), messages: Vec::new(), values: Vec::new() });
        self.list.len() - 1
    }

    /// Adds a message to the topic at an index.
    pub(super) fn add_message(&mut self, place: usize, log_time_ns: i64, message: &[u8]) -> Result<(), RecordingError> {
        // A message takes as much memory as five values, in addition to its own values.
        self.budget.take("its messages", &[5])?;
        match self.list[place].add(log_time_ns, message) {
            Ok(values) => self.budget.take("its messages", &[values]).map(|_| ()),
            Err(reason) => Err(self.bad_message(place, reason)),
        }
    }

    fn bad_message(&self, place: usize, reason: String) -> RecordingError {
        let topic = &self.list[place];
        let (name, message) = (topic.name.clone(), topic.messages.len() + 1);
        self.refuse(BagError::BadMessage { topic: name, message, reason })
    }

    /// Messages in the order in which they were recorded.
    pub(super) fn in_order_of_time(mut self) -> Self {
        for topic in &mut self.list {
            topic.messages.sort_by_key(|message| message.log_time_ns);
        }
        self
    }

    pub(super) fn refuse(&self, problem: BagError) -> RecordingError {
        RecordingError::Bag { file: self.path.clone(), problem: Box::new(problem) }
    }

    /// The topic of a given name, or the only one with joint states.
    pub(super) fn topic(&self, name: Option<&str>) -> Result<&Topic, RecordingError> {
        let found: Vec<String> = self.list.iter().map(|topic| topic.name.clone()).collect();
        let others = || self.others.iter().map(|other| format!("{} ({})", other.name, other.kind)).collect();
        match (name, self.list.as_slice()) {
            (_, []) => Err(self.refuse(BagError::NoJointStates { found: others() })),
            (None, [only]) => Ok(only),
            (None, _) => Err(self.refuse(BagError::UnclearTopic { found })),
            (Some(name), topics) => topics
                .iter()
                .find(|topic| topic.name == name)
                .ok_or_else(|| self.refuse(BagError::MissingTopic { topic: name.to_owned(), found })),
        }
    }
}

impl Topic {
    /// Adds a message and returns the number of its values.
    fn add(&mut self, log_time_ns: i64, message: &[u8]) -> Result<usize, String> {
        let state = joint_state(message)?;
        let joints = self.list_of_joints(&state.names)?;
        let start = self.values.len();
        let present = state.fields.each_ref().map(|field| !field.is_empty());
        state.fields.iter().for_each(|field| self.values.extend(field));
        self.messages.push(Message { joints, stamp_ns: state.stamp_ns, log_time_ns, start, present });
        Ok(self.values.len() - start)
    }

    fn list_of_joints(&mut self, names: &[&str]) -> Result<usize, String> {
        if let Some(place) = self.joints.iter().position(|list| list == names) {
            return Ok(place);
        }
        if self.joints.len() == MOST_LISTS {
            return Err(format!("it is the {}th message of other joints than all before", MOST_LISTS + 1));
        }
        self.joints.push(names.iter().map(|&name| name.to_owned()).collect());
        Ok(self.joints.len() - 1)
    }

    /// The joints of a message.
    pub(super) fn joints_of(&self, message: &Message) -> &[String] {
        &self.joints[message.joints]
    }

    /// A value of the joint at an index of the message's list, if present.
    pub(super) fn value(&self, message: &Message, joint: usize, field: Field) -> Option<f64> {
        let field = field as usize;
        let before = message.present[..field].iter().filter(|present| **present).count();
        let place = message.start + before * self.joints[message.joints].len() + joint;
        if message.present[field] { self.values.get(place).copied() } else { None }
    }
}

/// The difference of two times in nanoseconds, in seconds.
pub(super) fn seconds(time_ns: i64, first_ns: i64) -> f64 {
    (i128::from(time_ns) - i128::from(first_ns)) as f64 * 1e-9
}
