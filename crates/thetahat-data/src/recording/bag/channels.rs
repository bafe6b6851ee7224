//! Signals by name over all messages of a topic.

use std::collections::HashMap;

use super::super::error::RecordingError;
use super::super::table::is_plausible;
use super::asked::{Asked, Time};
use super::error::BagError;
use super::layouts::{example, groups, is_read};
use super::naming::Column;
use super::topic::{Layout, Message, Topic, seconds};
use super::topics::Topics;
use thetahat_ground::series::Series;

/// The requested columns, from the messages that hold all of them.
pub(super) fn of(mut topics: Topics, topic: Option<&str>, columns: &[String]) -> Result<Series, RecordingError> {
    let file = topics.path.clone();
    let refuse = |problem| RecordingError::Bag { file: file.clone(), problem: Box::new(problem) };
    let place = topics.topic(topic)?;
    let chosen = SelectedTopic { topics: &topics, topic: &topics.list[place], refuse: &refuse };
    if chosen.topic.messages.is_empty() {
        return Err(RecordingError::NoSamples { file: file.clone() });
    }
    let asked = chosen.asked(columns)?;
    let messages = chosen.messages(&asked)?;
    let series = chosen.series(&asked, &messages);
    for (channel, asked) in asked.iter().enumerate() {
        chosen.check(&series.channel(channel), asked, &messages)?;
    }
    Ok(series)
}

struct SelectedTopic<'a> {
    topics: &'a Topics,
    topic: &'a Topic,
    refuse: &'a dyn Fn(BagError) -> RecordingError,
}

impl SelectedTopic<'_> {
    fn refuse(&self, problem: BagError) -> RecordingError {
        (self.refuse)(problem)
    }

    fn asked(&self, columns: &[String]) -> Result<Vec<Asked>, RecordingError> {
        if columns.is_empty() {
            return Err(RecordingError::NoColumnListed { file: self.topics.path.clone(), found: self.names() });
        }
        if let [only] = columns
            && let Some(first) = self.first_with_field(only)
        {
            return self.all_joints(only, first);
        }
        let asked: Vec<Asked> = columns.iter().map(|column| Asked::of(column, self.topic)).collect();
        let is_missing = |asked: &Asked| !self.topic.layouts.iter().any(|layout| asked.is_in(layout));
        let has_no_stamp = |asked: &Asked| matches!(asked, Asked::Time(_, Time::Stamp)) && !self.topic.has_stamp();
        match asked.iter().position(|asked| is_missing(asked) || has_no_stamp(asked)) {
            None => Ok(asked),
            Some(place) => Err(self.missing(&columns[place])),
        }
    }

    /// The first message that is read and has a field of several joints or elements, or of one without a name.
    fn first_with_field(&self, field: &str) -> Option<&Message> {
        let is_read = is_read(self.topic);
        let has_field = |layout: &Layout| layout.columns.iter().any(|c| c.field == field && c.name != field);
        let layouts: Vec<bool> =
            self.topic.layouts.iter().zip(&is_read).map(|(l, read)| *read && has_field(l)).collect();
        self.topic.messages.iter().find(|message| layouts[message.layout])
    }

    /// A field of all joints in the order of the first message, which all messages must have.
    fn all_joints(&self, field: &str, first: &Message) -> Result<Vec<Asked>, RecordingError> {
        let is_read = is_read(self.topic);
        let names = |message: &Message| -> Vec<String> {
            let columns = self.topic.columns_of(message).iter().filter(|column| column.field == field);
            columns.map(|column| column.name.clone()).collect()
        };
        let expected = names(first);
        let same: Vec<bool> = self.topic.layouts.iter().map(|layout| in_field(layout, field).eq(&expected)).collect();
        let is_other = |message: &Message| is_read[message.layout] && !same[message.layout];
        match self.topic.messages.iter().position(is_other) {
            None => Ok(expected.into_iter().map(Asked::Signal).collect()),
            Some(place) => Err(self.refuse(BagError::JointsChange {
                topic: self.topic.name.clone(),
                message: place + 1,
                found: names(&self.topic.messages[place]),
                expected,
            })),
        }
    }

    /// The messages that hold all that is asked for.
    fn messages(&self, asked: &[Asked]) -> Result<Vec<&Message>, RecordingError> {
        let holds = |layout: &Layout| asked.iter().all(|asked| asked.is_in(layout));
        let is_read = is_read(self.topic);
        let layouts: Vec<bool> = self.topic.layouts.iter().zip(&is_read).map(|(l, read)| *read && holds(l)).collect();
        let messages: Vec<&Message> = self.topic.messages.iter().filter(|message| layouts[message.layout]).collect();
        if messages.is_empty() {
            return Err(self.in_different_messages(asked));
        }
        if asked.iter().all(|asked| matches!(asked, Asked::Time(None, _))) {
            self.check_one_group()?;
        }
        Ok(messages)
    }

    /// Checks that the time of the messages is that of one set of joints.
    fn check_one_group(&self) -> Result<(), RecordingError> {
        let groups = groups(self.topic);
        let [first, _, ..] = groups.as_slice() else { return Ok(()) };
        let joint = example(self.topic, first, &groups).unwrap_or("joint");
        let (topic, example) = (self.topic.name.clone(), format!("{joint}.stamp"));
        Err(self.refuse(BagError::UnclearTime { topic, example }))
    }

    fn series(&self, asked: &[Asked], messages: &[&Message]) -> Series {
        let places: Vec<HashMap<&str, usize>> = self.topic.layouts.iter().map(Layout::places).collect();
        let value = |message: &Message, asked: &Asked| match asked {
            Asked::Time(_, time) => Some(self.seconds(*time, message)),
            Asked::Signal(name) => self.topic.value(message, *places[message.layout].get(name.as_str())?),
        };
        let sample = |message: &&Message| -> Vec<f64> {
            asked.iter().map(|asked| value(message, asked).unwrap_or(f64::NAN)).collect()
        };
        Series::shaped(asked.len(), messages.iter().flat_map(sample).collect())
    }

    /// Seconds since the first message of the topic.
    fn seconds(&self, time: Time, message: &Message) -> f64 {
        let first = self.topic.messages.first().map_or(0, |first| time.nanoseconds(first));
        seconds(time.nanoseconds(message), first)
    }

    /// Checks that all values of a column are finite, or that its stamps rise.
    fn check(&self, values: &[f64], asked: &Asked, messages: &[&Message]) -> Result<(), RecordingError> {
        match asked {
            Asked::Signal(column) => self.check_finite(values, column, messages),
            Asked::Time(_, Time::Stamp) => self.check_stamps(messages),
            Asked::Time(_, Time::Log) => Ok(()),
        }
    }

    fn check_finite(&self, values: &[f64], column: &str, messages: &[&Message]) -> Result<(), RecordingError> {
        let Some(first) = values.iter().position(|value| !is_plausible(*value)) else { return Ok(()) };
        let known = self.topic.columns_of(messages[first]).iter().find(|known| known.name == column);
        let count = values.iter().filter(|value| !is_plausible(**value)).count();
        Err(self.refuse(BagError::NotFinite {
            topic: self.topic.name.clone(),
            column: column.to_owned(),
            joint: known.and_then(|column| column.joint.clone()),
            sample: first,
            found: values[first].to_string(),
            count,
            of: values.len(),
        }))
    }

    fn check_stamps(&self, messages: &[&Message]) -> Result<(), RecordingError> {
        let does_not_rise = |pair: &[&Message]| pair[1].stamp_ns <= pair[0].stamp_ns;
        let count = messages.windows(2).filter(|pair| does_not_rise(pair)).count();
        let Some(place) = messages.windows(2).position(does_not_rise) else { return Ok(()) };
        let topic = self.topic.name.clone();
        Err(self.refuse(if messages.iter().all(|message| message.stamp_ns == 0) {
            BagError::NoStamp { topic }
        } else {
            let (previous, found) = (messages[place].stamp_ns, messages[place + 1].stamp_ns);
            let text = |time| format!("{:.9}", seconds(time, 0));
            BagError::StampsRepeat { topic, sample: place + 1, previous: text(previous), found: text(found), count }
        }))
    }

    /// The error for a column that no message has.
    fn missing(&self, column: &str) -> RecordingError {
        let others = self.topics.list.iter().filter(|other| other.name != self.topic.name);
        let asked = Asked::of(column, self.topic);
        let holds = |other: &&super::topic::Topic| other.layouts.iter().any(|layout| asked.is_in(layout));
        let other = others.into_iter().find(holds).filter(|_| matches!(asked, Asked::Signal(_)));
        match other {
            Some(other) => self.refuse(BagError::ColumnOfOtherTopic {
                topic: self.topic.name.clone(),
                column: column.to_owned(),
                other: other.name.clone(),
            }),
            None => RecordingError::MissingColumn {
                file: self.topics.path.clone(),
                column: column.to_owned(),
                found: self.names(),
            },
        }
    }

    /// The error for columns of which no message has all.
    fn in_different_messages(&self, asked: &[Asked]) -> RecordingError {
        let holds = |count: usize| self.topic.layouts.iter().any(|l| asked[..count].iter().all(|a| a.is_in(l)));
        let missing = (1..asked.len()).find(|&place| !holds(place + 1)).unwrap_or(0);
        let (topic, present) = (self.topic.name.clone(), missing.saturating_sub(1));
        let layout = self.topic.layouts.iter().find(|l| asked[..=present].iter().all(|a| a.is_in(l)));
        let found = layout.map(|layout| layout.columns.iter().map(|c| c.name.clone()).collect()).unwrap_or_default();
        self.refuse(BagError::InDifferentMessages {
            topic,
            column: asked[missing].name(),
            present: asked[present].name(),
            found,
        })
    }

    /// All columns of the topic.
    fn names(&self) -> Vec<String> {
        let mut names = vec!["log_time".to_owned()];
        if self.topic.has_stamp() {
            names.insert(0, "stamp".to_owned());
        }
        let mut known = std::collections::HashSet::new();
        let columns = self.topic.layouts.iter().flat_map(|layout| &layout.columns);
        names.extend(columns.filter(|column| known.insert(&column.name)).map(|column| column.name.clone()));
        names
    }
}

fn in_field<'a>(layout: &'a Layout, field: &'a str) -> impl Iterator<Item = &'a String> {
    layout.columns.iter().filter(move |column| column.field == field).map(|column: &Column| &column.name)
}
