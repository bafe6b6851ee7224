//! Joints by name over all messages of a topic.

use super::super::checks::require_finite;
use super::super::error::RecordingError;
use super::error::BagError;
use super::topic::{Field, Message, Topic, Topics};
use thetahat_ground::series::Series;

/// The content of a requested column.
#[derive(Debug, Clone, PartialEq)]
enum Asked {
    /// A value of a joint.
    Value(String, Field),
    /// A time of the messages that hold a joint, or of all.
    Time(Option<String>, Time),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Time {
    Stamp,
    Log,
}

impl Asked {
    fn of(column: &str) -> Option<Self> {
        if let Some(time) = Time::of(column) {
            return Some(Self::Time(None, time));
        }
        let (joint, word) = column.rsplit_once('.')?;
        let joint = joint.to_owned();
        match Time::of(word) {
            Some(time) => Some(Self::Time(Some(joint), time)),
            None => Some(Self::Value(joint, field(word)?)),
        }
    }

    fn joint(&self) -> Option<&str> {
        match self {
            Self::Value(joint, _) | Self::Time(Some(joint), _) => Some(joint),
            Self::Time(None, _) => None,
        }
    }
}

impl Time {
    fn of(word: &str) -> Option<Self> {
        match word {
            "stamp" => Some(Self::Stamp),
            "log_time" => Some(Self::Log),
            _ => None,
        }
    }

    pub(super) fn nanoseconds(self, message: &Message) -> i64 {
        match self {
            Self::Stamp => message.stamp_ns,
            Self::Log => message.log_time_ns,
        }
    }
}

fn field(word: &str) -> Option<Field> {
    Field::ALL.into_iter().find(|field| field.name() == word)
}

/// The requested columns, from the messages that contain their joints.
pub(super) fn of(topics: &Topics, topic: Option<&str>, columns: &[String]) -> Result<Series, RecordingError> {
    let chosen = SelectedTopic { topics, topic: topics.topic(topic)? };
    let asked = chosen.asked(columns)?;
    chosen.check_joints(&asked)?;
    let mut values = Vec::new();
    for (number, message) in chosen.topic.messages.iter().enumerate() {
        chosen.add(number + 1, message, &asked, &mut values)?;
    }
    if values.is_empty() {
        return Err(RecordingError::NoSamples { file: topics.path.clone() });
    }
    let series = Series::shaped(asked.len(), values);
    for (channel, column) in asked.iter().enumerate() {
        require_finite(&series.channel(channel), &topics.path, &format!("{column:?}"))?;
    }
    Ok(series)
}

struct SelectedTopic<'a> {
    topics: &'a Topics,
    topic: &'a Topic,
}

impl SelectedTopic<'_> {
    fn asked(&self, columns: &[String]) -> Result<Vec<Asked>, RecordingError> {
        if let [only] = columns
            && let Some(field) = field(only)
        {
            return self.all_joints(field);
        }
        let file = || self.topics.path.clone();
        if columns.is_empty() {
            return Err(RecordingError::NoColumnListed { file: file(), found: self.names() });
        }
        let missing = |column: &String| RecordingError::MissingColumn {
            file: file(),
            column: column.clone(),
            found: self.names(),
        };
        columns.iter().map(|column| Asked::of(column).ok_or_else(|| missing(column))).collect()
    }

    /// A field of all joints in the order of the first message, which all messages must have.
    fn all_joints(&self, field: Field) -> Result<Vec<Asked>, RecordingError> {
        let messages = &self.topic.messages;
        let Some(first) = messages.first() else {
            return Err(RecordingError::NoSamples { file: self.topics.path.clone() });
        };
        let joints = self.topic.joints_of(first);
        match messages.iter().position(|message| message.joints != first.joints) {
            None if joints.is_empty() => Err(RecordingError::NoSamples { file: self.topics.path.clone() }),
            None => Ok(joints.iter().map(|joint| Asked::Value(joint.clone(), field)).collect()),
            Some(place) => Err(self.topics.refuse(BagError::JointsChange {
                topic: self.topic.name.clone(),
                message: place + 1,
                expected: joints.to_vec(),
                found: self.topic.joints_of(&messages[place]).to_vec(),
            })),
        }
    }

    /// Checks that each joint occurs in some message, and that a time without a joint is unambiguous.
    fn check_joints(&self, asked: &[Asked]) -> Result<(), RecordingError> {
        let is_known = |joint: &str| self.topic.joints.iter().flatten().any(|known| known == joint);
        if let Some(joint) = asked.iter().filter_map(Asked::joint).find(|joint| !is_known(joint)) {
            let (file, column) = (self.topics.path.clone(), joint.to_owned());
            return Err(RecordingError::MissingColumn { file, column, found: self.names() });
        }
        if asked.iter().any(|asked| asked.joint().is_some()) || self.has_one_set_of_joints() {
            return Ok(());
        }
        let joint = self.topic.joints.iter().flatten().next().map_or("joint", String::as_str);
        Err(self
            .topics
            .refuse(BagError::UnclearTime { topic: self.topic.name.clone(), example: format!("{joint}.stamp") }))
    }

    fn has_one_set_of_joints(&self) -> bool {
        let [first, others @ ..] = self.topic.joints.as_slice() else { return true };
        others.iter().all(|list| list.len() == first.len() && list.iter().all(|joint| first.contains(joint)))
    }

    fn names(&self) -> Vec<String> {
        let mut joints: Vec<&String> = Vec::new();
        for joint in self.topic.joints.iter().flatten() {
            if !joints.contains(&joint) {
                joints.push(joint);
            }
        }
        let of_joint = |joint: &&String| Field::ALL.map(|field| format!("{joint}.{}", field.name()));
        ["stamp".to_owned(), "log_time".to_owned()].into_iter().chain(joints.iter().flat_map(of_joint)).collect()
    }

    /// Adds one sample, unless the message holds none of the joints.
    fn add(
        &self,
        number: usize,
        message: &Message,
        asked: &[Asked],
        values: &mut Vec<f64>,
    ) -> Result<(), RecordingError> {
        let joints = self.topic.joints_of(message);
        let place = |joint: &str| joints.iter().position(|known| known == joint);
        let present = asked.iter().filter_map(Asked::joint).find(|joint| place(joint).is_some());
        if present.is_none() && asked.iter().any(|asked| asked.joint().is_some()) {
            return Ok(());
        }
        for asked in asked {
            let joint = match asked.joint() {
                Some(joint) => place(joint).ok_or_else(|| self.missing_joint(number, joint, present, joints))?,
                None => 0,
            };
            values.push(self.value(number, message, asked, joint)?);
        }
        Ok(())
    }

    fn value(&self, number: usize, message: &Message, asked: &Asked, joint: usize) -> Result<f64, RecordingError> {
        match asked {
            Asked::Time(_, time) => Ok(self.seconds(*time, message)),
            Asked::Value(_, field) => self.topic.value(message, joint, *field).ok_or_else(|| {
                let (topic, field) = (self.topic.name.clone(), field.name());
                self.topics.refuse(BagError::MissingField { topic, message: number, field })
            }),
        }
    }

    /// Seconds since the first message of the topic.
    fn seconds(&self, time: Time, message: &Message) -> f64 {
        let first = self.topic.messages.first().map_or(0, |first| time.nanoseconds(first));
        super::topic::seconds(time.nanoseconds(message), first)
    }

    fn missing_joint(&self, message: usize, joint: &str, present: Option<&str>, found: &[String]) -> RecordingError {
        self.topics.refuse(BagError::MissingJoint {
            topic: self.topic.name.clone(),
            message,
            joint: joint.to_owned(),
            present: present.unwrap_or_default().to_owned(),
            found: found.to_vec(),
        })
    }
}
