//! The messages of a topic.

use std::collections::{HashMap, HashSet};

use super::super::error::RecordingError;
use super::decode::{Decoded, decode};
use super::error::BagError;
use super::naming::{Column, columns};
use super::schema::{Schema, normal};
use super::shape::{self, Part, Shape};

/// The type of messages whose lists are checked: one number for each joint, or none.
pub(super) const JOINT_STATE: &str = "sensor_msgs/JointState";
/// Largest number of different layouts that a topic may have.
const MOST_LAYOUTS: usize = 256;
/// Largest number of bytes that fill a message up to whole words.
const FILLING: usize = 3;

/// A topic with messages that are read.
pub(super) struct Topic {
    pub(super) name: String,
    /// The type of its messages, as the bag states it.
    pub(super) kind: String,
    /// The forms that the type may have. Once a message is read, there is one.
    pub(super) schemas: Vec<Schema>,
    /// The different sets of signals of its messages, in the order in which they appear.
    pub(super) layouts: Vec<Layout>,
    pub(super) messages: Vec<Message>,
    values: Vec<f64>,
    /// Why it cannot be read.
    pub(super) problem: Option<RecordingError>,
    /// Number of messages left out because their stamp is zero.
    pub(super) without_stamp: usize,
}

/// The signals of a message, and the lengths and names that they follow from.
pub(super) struct Layout {
    lengths: Vec<usize>,
    texts: Vec<String>,
    pub(super) columns: Vec<Column>,
}

/// A message: its layout, its times, and where its values start.
#[derive(Clone, Copy)]
pub(super) struct Message {
    pub(super) layout: usize,
    pub(super) stamp_ns: i64,
    pub(super) log_time_ns: i64,
    start: usize,
}

impl Topic {
    pub(super) fn new(name: String, kind: String, schemas: Vec<Schema>) -> Self {
        Self {
            name,
            kind,
            schemas,
            layouts: Vec::new(),
            messages: Vec::new(),
            values: Vec::new(),
            problem: None,
            without_stamp: 0,
        }
    }

    pub(super) fn is_joint_state(&self) -> bool {
        normal(&self.kind) == JOINT_STATE
    }

    /// Whether its messages name joints.
    pub(super) fn has_joints(&self) -> bool {
        self.layouts.iter().flat_map(|layout| &layout.columns).any(|column| column.joint.is_some())
    }

    /// Whether its messages hold numbers.
    pub(super) fn has_signals(&self) -> bool {
        self.layouts.iter().any(|layout| !layout.columns.is_empty())
    }

    /// Number of signals of its first message.
    pub(super) fn count(&self) -> usize {
        self.layouts.first().map_or(0, |layout| layout.columns.len())
    }

    /// Whether its messages hold a field of joints.
    pub(super) fn has_field(&self, field: &str) -> bool {
        self.layouts.iter().flat_map(|layout| &layout.columns).any(|column| column.field == field)
    }

    /// Whether its messages state their time.
    pub(super) fn has_stamp(&self) -> bool {
        self.schemas.first().is_some_and(Schema::has_stamp)
    }

    /// Leaves the topic out, with all that was read of it.
    pub(super) fn give_up(&mut self, problem: RecordingError) {
        (self.layouts, self.messages, self.values) = (Vec::new(), Vec::new(), Vec::new());
        self.problem = Some(problem);
    }

    /// Adds a message and returns the number of values that take as much memory.
    pub(super) fn add(&mut self, log_time_ns: i64, message: &[u8]) -> Result<usize, String> {
        self.choose_form(message);
        let is_joint_state = self.is_joint_state();
        let Some(schema) = self.schemas.first() else { return Err("its type is not known".to_owned()) };
        let decoded = decode(schema, message)?;
        let known = self.layouts.len();
        let layout = match self.layouts.iter().position(|layout| layout.is_of(&decoded)) {
            Some(layout) => layout,
            None if self.layouts.len() == MOST_LAYOUTS => {
                return Err(format!("it is the {}th message of other signals than all before", MOST_LAYOUTS + 1));
            }
            None => {
                let shape = shape::of(schema, &decoded);
                if is_joint_state {
                    check_joint_state(&shape)?;
                }
                self.layouts.push(Layout::of(&decoded, columns(&shape)));
                self.layouts.len() - 1
            }
        };
        let size = if self.layouts.len() > known { self.layouts[layout].size() } else { 0 };
        let start = self.values.len();
        self.values.extend(&decoded.values);
        self.messages.push(Message { layout, stamp_ns: decoded.stamp_ns.unwrap_or(log_time_ns), log_time_ns, start });
        Ok(decoded.values.len() + size)
    }

    /// Keeps the first form of the type that takes all bytes of a message.
    fn choose_form(&mut self, message: &[u8]) {
        if self.schemas.len() < 2 {
            return;
        }
        let takes_all = |schema: &Schema| decode(schema, message).is_ok_and(|decoded| decoded.left <= FILLING);
        let form = self.schemas.iter().position(takes_all).unwrap_or(0);
        self.schemas = vec![self.schemas.swap_remove(form)];
    }

    pub(super) fn columns_of(&self, message: &Message) -> &[Column] {
        &self.layouts[message.layout].columns
    }

    /// The value of a column of the message's layout.
    pub(super) fn value(&self, message: &Message, column: usize) -> Option<f64> {
        self.values.get(message.start + column).copied()
    }

    /// Sorts messages by the time at which they were recorded, and leaves out those before a simulated clock ran.
    pub(super) fn put_in_order(&mut self) {
        self.messages.sort_by_key(|message| message.log_time_ns);
        if self.has_stamp() {
            self.without_stamp = before_the_clock(&self.messages);
            self.messages.drain(..self.without_stamp);
        }
    }
}

/// Number of messages at the beginning whose stamp is zero: several, or one long before the next. A single one soon before the next is the
/// start of a clock at zero.
fn before_the_clock(messages: &[Message]) -> usize {
    const LONG_NS: i64 = 1_000_000_000;
    let zeros = messages.iter().take_while(|message| message.stamp_ns == 0).count();
    match (zeros, messages.get(zeros)) {
        (_, None) => 0,
        (1, Some(next)) if next.stamp_ns < LONG_NS => 0,
        (zeros, Some(_)) => zeros,
    }
}

impl Layout {
    fn of(decoded: &Decoded<'_>, columns: Vec<Column>) -> Self {
        let texts = decoded.texts.iter().map(|&text| text.to_owned()).collect();
        Self { lengths: decoded.lengths.clone(), texts, columns }
    }

    fn is_of(&self, decoded: &Decoded<'_>) -> bool {
        self.lengths == decoded.lengths && self.texts == decoded.texts
    }

    /// The number of values that take as much memory.
    fn size(&self) -> usize {
        const COLUMN: usize = 128;
        let names = self.columns.iter().map(|column| COLUMN + 2 * column.name.len() + column.field.len());
        let texts = self.texts.iter().map(|text| size_of::<String>() + text.len());
        names.chain(texts).sum::<usize>() / 8 + self.lengths.len()
    }

    /// The place of each column by its name.
    pub(super) fn places(&self) -> HashMap<&str, usize> {
        self.columns.iter().enumerate().map(|(place, column)| (column.name.as_str(), place)).collect()
    }

    /// The joints in the order in which the message names them, each once.
    pub(super) fn joints(&self) -> Vec<&str> {
        let mut known = HashSet::new();
        self.columns.iter().filter_map(|column| column.joint.as_deref()).filter(|joint| known.insert(*joint)).collect()
    }
}

/// Checks that joint states name each joint once and hold one number for each, or none. Without names, numbers stand for them.
fn check_joint_state(message: &[Part<'_>]) -> Result<(), String> {
    let names = message.iter().find_map(|part| if let Shape::Texts(names) = &part.shape { Some(names) } else { None });
    let Some(names) = names.filter(|names| !names.is_empty()) else { return Ok(()) };
    if let Some(i) = (1..names.len()).find(|&i| names[..i].contains(&names[i])) {
        return Err(format!("joint {:?} is named twice", names[i]));
    }
    for part in message {
        if let Shape::Numbers(found) = part.shape
            && found != 0
            && found != names.len()
        {
            let expected = names.len();
            return Err(format!("expected {expected} numbers of {}, one for each joint, found {found}", part.name));
        }
    }
    Ok(())
}

/// The difference of two times in nanoseconds, in seconds.
pub(super) fn seconds(time_ns: i64, first_ns: i64) -> f64 {
    (i128::from(time_ns) - i128::from(first_ns)) as f64 * 1e-9
}

impl BagError {
    /// What is wrong with the message after those that were read.
    pub(super) fn of_message(topic: &Topic, reason: String) -> Self {
        Self::BadMessage { topic: topic.name.clone(), message: topic.messages.len() + 1, reason }
    }
}
