//! The topics of a bag, and the one that is read.

use std::path::{Path, PathBuf};

use super::super::budget::Budget;
use super::super::error::RecordingError;
use super::error::BagError;
use super::other_topic::OtherTopic;
use super::schema::{Schema, normal};
use super::topic::Topic;
use super::zstd;

/// Decompressed bytes that any file may contain, and the number for each byte of a larger file.
const ANY_FILE: u64 = 1 << 30;
const EXPANSION: u64 = 32;
/// Longest message that is decompressed, in bytes.
const LONGEST_MESSAGE: u64 = 1 << 26;
/// Largest number of topics.
const MOST_TOPICS: usize = 1 << 12;

/// Packages and types whose messages hold no signals of a robot's joints: they are read only where their topic is named.
const NO_SIGNALS: [&str; 19] = [
    "bond/",
    "diagnostic_msgs/",
    "dynamic_reconfigure/",
    "lifecycle_msgs/",
    "rcl_interfaces/",
    "rosbag2_interfaces/",
    "rosgraph_msgs/",
    "tf/",
    "tf2_msgs/",
    "visualization_msgs/",
    "sensor_msgs/CameraInfo",
    "sensor_msgs/CompressedImage",
    "sensor_msgs/Image",
    "sensor_msgs/LaserScan",
    "sensor_msgs/PointCloud",
    "nav_msgs/OccupancyGrid",
    "nav_msgs/Path",
    "std_msgs/Empty",
    "std_msgs/String",
];

fn holds_signals(kind: &str) -> bool {
    let kind = normal(kind);
    !NO_SIGNALS.iter().any(|start| kind.starts_with(start))
}

/// The topics of a bag.
pub(super) struct Topics {
    pub(super) path: PathBuf,
    pub(super) list: Vec<Topic>,
    /// Topics that are not read.
    pub(super) others: Vec<OtherTopic>,
    budget: Budget,
    /// Decompressed bytes still allowed.
    left: u64,
}

impl Topics {
    pub(super) fn new(path: &Path, file_bytes: u64) -> Self {
        let budget = Budget::of(path, file_bytes);
        let left = ANY_FILE.max(file_bytes.saturating_mul(EXPANSION));
        Self { path: path.to_owned(), list: Vec::new(), others: Vec::new(), budget, left }
    }

    /// Adds a topic without messages and returns its index if its messages are to be read: those of the topic `asked`, or of all that can be
    /// read and hold signals.
    pub(super) fn add_topic(
        &mut self,
        name: String,
        kind: String,
        schemas: Vec<Schema>,
        asked: Option<&str>,
    ) -> Option<usize> {
        let is_asked = asked.map_or_else(|| holds_signals(&kind), |asked| asked == name);
        if !is_asked && asked.is_none() {
            self.add_other(name, kind);
            return None;
        }
        self.placed(name, kind, schemas).filter(|_| is_asked)
    }

    fn placed(&mut self, name: String, kind: String, schemas: Vec<Schema>) -> Option<usize> {
        if let Some(place) = self.list.iter().position(|topic| topic.name == name) {
            return (self.list[place].kind == kind).then_some(place);
        }
        let size = schemas.iter().map(Schema::size).sum();
        let has_room = self.list.len() < MOST_TOPICS && self.budget.take("its definitions", &[size]).is_ok();
        if schemas.is_empty() || !has_room {
            self.add_other(name, kind);
            return None;
        }
        self.list.push(Topic::new(name, kind, schemas));
        Some(self.list.len() - 1)
    }

    pub(super) fn add_other(&mut self, name: String, kind: String) {
        let other = OtherTopic { name, kind };
        if self.others.len() < MOST_TOPICS && !self.others.contains(&other) {
            self.others.push(other);
        }
    }

    /// Counts the bytes of a decompressed part.
    pub(super) fn count_bytes(&mut self, bytes: usize) -> Result<(), RecordingError> {
        let left = self.left.checked_sub(bytes as u64);
        self.left = left.ok_or_else(|| self.too_large())?;
        Ok(())
    }

    /// Reserves memory for a text that is kept; whether there is room.
    pub(super) fn has_room_for(&mut self, text: &[u8]) -> bool {
        self.budget.take("its definitions", &[text.len() / 8]).is_ok()
    }

    fn too_large(&self) -> RecordingError {
        let (file, what) = (self.path.clone(), "its compressed parts".to_owned());
        RecordingError::TooLarge { file, what, limit: (ANY_FILE / 8) as usize }
    }

    /// Adds a message to the topic at an index. A topic with a message that cannot be read is left out; its problem is kept for whoever
    /// asks for it.
    pub(super) fn add_message(&mut self, place: usize, log_time_ns: i64, message: &[u8]) -> Result<(), RecordingError> {
        if self.list[place].problem.is_some() {
            return Ok(());
        }
        let decompressed;
        let message = if zstd::is_compressed(message) {
            decompressed = self.decompressed(place, message)?;
            decompressed.as_slice()
        } else {
            message
        };
        // A message takes as much memory as five values, in addition to its own values.
        let added = self.budget.take("its messages", &[5]).and_then(|_| {
            let topic = &mut self.list[place];
            topic.add(log_time_ns, message).map_err(|reason| {
                let problem = Box::new(BagError::of_message(topic, reason));
                RecordingError::Bag { file: self.path.clone(), problem }
            })
        });
        let added = added.and_then(|values| self.budget.take("its messages", &[values]));
        added.map_or_else(|problem| self.list[place].give_up(problem), |_| ());
        Ok(())
    }

    fn decompressed(&mut self, place: usize, message: &[u8]) -> Result<Vec<u8>, RecordingError> {
        let what = format!("a message of topic {:?}", self.list[place].name);
        let bytes = zstd::decompress(message, self.left.min(LONGEST_MESSAGE), &self.path, &what)?
            .ok_or_else(|| self.too_large())?;
        self.count_bytes(bytes.len())?;
        Ok(bytes)
    }

    /// Messages in the order in which they were recorded.
    pub(super) fn in_order_of_time(mut self) -> Self {
        self.list.iter_mut().for_each(Topic::put_in_order);
        self
    }

    pub(super) fn refuse(&self, problem: BagError) -> RecordingError {
        RecordingError::Bag { file: self.path.clone(), problem: Box::new(problem) }
    }

    /// The topic of a given name, or the likeliest: the only one of joint states, else the only one that names joints, else the only one.
    pub(super) fn topic(&mut self, name: Option<&str>) -> Result<usize, RecordingError> {
        let place = match name {
            Some(name) => self.named(name)?,
            None => self.likeliest()?,
        };
        match self.list[place].problem.take() {
            Some(problem) => Err(problem),
            None => Ok(place),
        }
    }

    fn named(&self, name: &str) -> Result<usize, RecordingError> {
        let place = self.list.iter().position(|topic| topic.name == name);
        let topic = name.to_owned();
        let other = self.others.iter().find(|other| other.name == name);
        place.ok_or_else(|| match (other, self.list.is_empty()) {
            (Some(other), _) => self.refuse(BagError::UnknownType { topic, kind: other.kind.clone() }),
            (None, true) => self.refuse(BagError::NoTopic { found: self.others() }),
            (None, false) => {
                let found = self.list.iter().map(|topic| topic.name.clone()).collect();
                self.refuse(BagError::MissingTopic { topic, found, others: self.others() })
            }
        })
    }

    fn likeliest(&self) -> Result<usize, RecordingError> {
        let is_sound = |topic: &Topic| !topic.messages.is_empty();
        let kinds: [fn(&Topic) -> bool; 3] = [Topic::is_joint_state, Topic::has_joints, |_| true];
        for is_of_kind in kinds {
            let is_candidate = |topic: &&Topic| is_of_kind(topic) && (is_sound(topic) || topic.is_joint_state());
            let found: Vec<&Topic> = self.list.iter().filter(is_candidate).collect();
            match found.as_slice() {
                [] => {}
                [only] => return Ok(self.list.iter().position(|topic| topic.name == only.name).unwrap_or(0)),
                several => {
                    let found = several.iter().map(|topic| topic.name.clone()).collect();
                    return Err(self.refuse(BagError::UnclearTopic { found }));
                }
            }
        }
        Err(self.refuse(BagError::NoTopic { found: self.others() }))
    }

    /// Names and types of the topics that are not read.
    fn others(&self) -> Vec<String> {
        self.others.iter().map(|other| format!("{} ({})", other.name, other.kind)).collect()
    }
}
