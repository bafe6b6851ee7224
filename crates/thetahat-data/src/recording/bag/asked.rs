//! Requested columns: signals by their names, and times.

use super::topic::{Layout, Message, Topic};

/// The content of a requested column.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Asked {
    /// A signal by its full name.
    Signal(String),
    /// A time of the messages that hold a joint, or of all.
    Time(Option<String>, Time),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Time {
    Stamp,
    Log,
}

impl Asked {
    /// A signal if the topic has one of this name, else a time if it is called like one.
    pub(super) fn of(column: &str, topic: &Topic) -> Self {
        let signal = Self::Signal(column.to_owned());
        if topic.layouts.iter().any(|layout| signal.is_in(layout)) {
            return signal;
        }
        if let Some(time) = Time::of(column) {
            return Self::Time(None, time);
        }
        match column.rsplit_once('.').and_then(|(joint, word)| Some((joint, Time::of(word)?))) {
            Some((joint, time)) => Self::Time(Some(joint.to_owned()), time),
            None => signal,
        }
    }

    /// Whether a layout holds it.
    pub(super) fn is_in(&self, layout: &Layout) -> bool {
        match self {
            Self::Signal(name) => layout.columns.iter().any(|column| column.name == *name),
            Self::Time(Some(joint), _) => layout.columns.iter().any(|c| c.joint.as_deref() == Some(joint)),
            Self::Time(None, _) => true,
        }
    }

    /// Its full name.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Signal(name) => name.clone(),
            Self::Time(joint, time) => {
                let word = if *time == Time::Stamp { "stamp" } else { "log_time" };
                joint.as_ref().map_or_else(|| word.to_owned(), |joint| format!("{joint}.{word}"))
            }
        }
    }
}

impl Time {
    fn of(word: &str) -> Option<Self> {
        match word {
            "stamp" | "header.stamp" => Some(Self::Stamp),
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
