//! The names of the signals of a message.
//!
//! Where an array of texts is as long as an array next to it or deeper inside, its texts name the elements: `elbow.position`,
//! `elbow.feedback.position`. Other elements are numbered from 0, as ROS and the makers of robots do: `motor_state[3].q`, `position[2]`.

use super::shape::{Part, Shape};

/// A signal of a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Column {
    /// Its full name, as `elbow.feedback.position`.
    pub(super) name: String,
    /// The joint, as `elbow`: any name that the message gives to its elements.
    pub(super) joint: Option<String>,
    /// What it is of each joint or element, as `feedback.position` or `motor_state.q`.
    pub(super) field: String,
}

/// Words for several quantities that become one where a joint is named.
const SINGULAR: [(&str, &str); 9] = [
    ("positions", "position"),
    ("velocities", "velocity"),
    ("accelerations", "acceleration"),
    ("efforts", "effort"),
    ("torques", "torque"),
    ("forces", "force"),
    ("currents", "current"),
    ("voltages", "voltage"),
    ("temperatures", "temperature"),
];

/// The signals in the order of the fields. Names that would occur twice become numbers.
pub(super) fn columns(message: &[Part<'_>]) -> Vec<Column> {
    let named = Naming { with_names: true, columns: Vec::new() }.all(message);
    if is_unique(&named) { named } else { Naming { with_names: false, columns: Vec::new() }.all(message) }
}

fn is_unique(columns: &[Column]) -> bool {
    let mut names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    names.sort_unstable();
    names.windows(2).all(|pair| pair[0] != pair[1])
}

/// Where a part is: the joint, the path with numbers of elements, and the path without.
#[derive(Clone, Default)]
struct Place {
    joint: Option<String>,
    path: String,
    field: String,
}

impl Place {
    fn at(&self, name: &str) -> Self {
        Self { joint: self.joint.clone(), path: joined(&self.path, name), field: joined(&self.field, name) }
    }

    fn element(&self, name: &str, number: usize) -> Self {
        let at = self.at(name);
        Self { path: format!("{}[{number}]", at.path), ..at }
    }

    /// The element that a message calls `joint`; a second name inside says which quantity it is.
    fn of_joint(&self, field: &str, joint: &str) -> Self {
        let field = if says_only_values(field) { "" } else { singular(field) };
        match self.joint {
            None => Self { joint: Some(joint.to_owned()), ..self.at(field) },
            Some(_) => self.at(joint).at(field),
        }
    }

    fn column(self) -> Column {
        let name = joined(self.joint.as_deref().unwrap_or_default(), &self.path);
        Column { name, joint: self.joint, field: self.field }
    }
}

fn joined(path: &str, name: &str) -> String {
    match (path, name) {
        ("", name) => name.to_owned(),
        (path, "") => path.to_owned(),
        (path, name) => format!("{path}.{name}"),
    }
}

fn singular(field: &str) -> &str {
    SINGULAR.iter().find(|(several, _)| *several == field).map_or(field, |(_, one)| one)
}

/// Whether a field is called after what any field holds, as `values` or `interface_values`.
fn says_only_values(field: &str) -> bool {
    matches!(field, "value" | "values") || field.ends_with("_values")
}

/// Names for elements, nearest last.
type Names<'a> = Vec<&'a [&'a str]>;

struct Naming {
    with_names: bool,
    columns: Vec<Column>,
}

impl Naming {
    fn all(mut self, message: &[Part<'_>]) -> Vec<Column> {
        self.message(message, &Place::default(), &Vec::new());
        self.columns
    }

    fn message(&mut self, parts: &[Part<'_>], place: &Place, outer: &Names<'_>) {
        for (number, part) in parts.iter().enumerate() {
            let names = self.names(parts, number, outer);
            match &part.shape {
                Shape::Nothing | Shape::Texts(_) | Shape::Name(_) => {}
                Shape::Number => self.columns.push(place.at(part.name).column()),
                Shape::Message(inner) => self.message(inner, &place.at(part.name), &names),
                Shape::Numbers(count) => {
                    let places = elements(part.name, *count, place, &names);
                    self.columns.extend(places.into_iter().map(Place::column));
                }
                Shape::Messages(messages) => self.messages(part.name, messages, place, &names),
            }
        }
    }

    fn messages(&mut self, field: &str, messages: &[Vec<Part<'_>>], place: &Place, names: &Names<'_>) {
        let own: Vec<&str> = messages.iter().filter_map(|message| own_name(message)).collect();
        let names = match self.with_names && own.len() == messages.len() && are_names(&own) {
            true => names.iter().copied().chain([own.as_slice()]).collect(),
            false => names.clone(),
        };
        // Names of what is inside of each element number the elements: the points of a trajectory name joints.
        if own.is_empty() && messages.iter().any(|message| is_of_joints(message, messages.len())) {
            return self.numbered(field, messages, place, &names);
        }
        // The names of elements are taken here, so that they name nothing inside of an element.
        let inner: Names<'_> = names.iter().copied().filter(|names| names.len() != messages.len()).collect();
        for (message, place) in messages.iter().zip(elements(field, messages.len(), place, &names)) {
            self.message(message, &place, &inner);
        }
    }

    /// Messages by their numbers, whatever names there are.
    fn numbered(&mut self, field: &str, messages: &[Vec<Part<'_>>], place: &Place, names: &Names<'_>) {
        for (number, message) in messages.iter().enumerate() {
            self.message(message, &place.element(field, number), names);
        }
    }

    /// The lists of names for a part: of outer messages, then of its own, the nearest one before it last.
    fn names<'a>(&self, parts: &'a [Part<'a>], number: usize, outer: &Names<'a>) -> Names<'a> {
        if !self.with_names {
            return Vec::new();
        }
        let (before, after) = parts.split_at(number);
        let lists = after.iter().rev().chain(before).filter_map(|part| match &part.shape {
            Shape::Texts(texts) if are_names(texts) => Some(texts.as_slice()),
            Shape::Texts(_)
            | Shape::Number
            | Shape::Numbers(_)
            | Shape::Name(_)
            | Shape::Message(_)
            | Shape::Messages(_)
            | Shape::Nothing => None,
        });
        outer.iter().copied().chain(lists).collect()
    }
}

/// The place of each element of an array: by the nearest names of its length, or by number.
fn elements(field: &str, count: usize, place: &Place, names: &Names<'_>) -> Vec<Place> {
    match names.iter().rev().find(|names| names.len() == count) {
        Some(names) => names.iter().map(|joint| place.of_joint(field, joint)).collect(),
        None => (0..count).map(|number| place.element(field, number)).collect(),
    }
}

/// Whether a message has an array of numbers of this length, and no names for it.
fn is_of_joints(message: &[Part<'_>], length: usize) -> bool {
    let has_names = message.iter().any(|part| matches!(part.shape, Shape::Texts(_)));
    !has_names && message.iter().any(|part| matches!(part.shape, Shape::Numbers(count) if count == length))
}

/// The name that a message gives itself.
fn own_name<'a>(message: &'a [Part<'_>]) -> Option<&'a str> {
    message.iter().find_map(|part| match part.shape {
        Shape::Name(name) => Some(name),
        Shape::Texts(_)
        | Shape::Number
        | Shape::Numbers(_)
        | Shape::Message(_)
        | Shape::Messages(_)
        | Shape::Nothing => None,
    })
}

/// Whether texts can name elements: each is there once, and none is empty.
fn are_names(texts: &[&str]) -> bool {
    let mut sorted = texts.to_vec();
    sorted.sort_unstable();
    !texts.is_empty() && !sorted[0].is_empty() && sorted.windows(2).all(|pair| pair[0] != pair[1])
}
