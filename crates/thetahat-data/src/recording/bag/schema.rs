//! The types of messages, linked: each field knows what it holds and how many.

use std::collections::HashMap;

/// Largest number of types in one definition.
const MOST_TYPES: usize = 4096;
/// Longest name of a field or a joint, in bytes.
pub(super) const LONGEST_NAME: usize = 128;
/// The member that ROS 2 gives to a type without fields.
pub(super) const PLACEHOLDER: &str = "structure_needs_at_least_one_member";

/// How numbers and texts of a message follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Common data representation of DDS, as ROS 2 writes it: aligned.
    Cdr,
    /// Serialisation of ROS 1: little endian, not aligned.
    Ros1,
}

/// A number of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Number(Number),
    Text,
    WideText,
    Time,
    Duration,
    /// A message of the type with this index.
    Message(usize),
}

/// How many a field holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Count {
    One,
    Fixed(usize),
    Sequence,
}

/// What a field is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Value,
    /// The time of the message, if the field is in its header.
    Stamp,
    /// Not a signal: the counter of a header, the placeholder of an empty type.
    NoSignal,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) count: Count,
    pub(super) role: Role,
}

/// A type as its text declares it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Declared {
    /// Package and name, as `std_msgs/Header`.
    pub(super) name: String,
    pub(super) fields: Vec<DeclaredField>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct DeclaredField {
    pub(super) name: String,
    pub(super) kind: DeclaredKind,
    pub(super) count: Count,
}

/// What a declared field holds: known at once, or a type by its name.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum DeclaredKind {
    Known(Kind),
    Named(String),
}

/// The type of the messages of a topic, with all types inside.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Schema {
    pub(super) encoding: Encoding,
    /// The fields of each type; the first is that of the message.
    types: Vec<Vec<Field>>,
}

impl Number {
    /// Size in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

impl Schema {
    /// Links the declared types; the message is of the type `name`.
    pub(super) fn link(name: &str, declared: &[Declared], encoding: Encoding) -> Result<Self, String> {
        if declared.len() > MOST_TYPES {
            return Err(format!("its definition has {} types, at most {MOST_TYPES} are read", declared.len()));
        }
        let root = normal(name);
        let first = declared.iter().position(|t| t.name == root);
        let first = first.ok_or_else(|| format!("the definition of type {root} is missing"))?;
        let mut order: Vec<&Declared> = declared.iter().collect();
        order.swap(0, first);
        let mut places = HashMap::new();
        order.iter().enumerate().for_each(|(place, t)| {
            places.entry(t.name.as_str()).or_insert(place);
        });
        let link = |t: &&Declared| t.fields.iter().map(|field| linked(field, &t.name, &places)).collect();
        let mut types: Vec<Vec<Field>> = order.iter().map(link).collect::<Result<_, String>>()?;
        if encoding == Encoding::Cdr {
            types.iter_mut().filter(|fields| fields.is_empty()).for_each(|fields| fields.push(placeholder()));
        }
        Ok(Self { encoding, types })
    }

    /// The number of values that take as much memory.
    pub(super) fn size(&self) -> usize {
        const FIELD: usize = 12;
        self.types.iter().map(|fields| FIELD * (fields.len() + 1)).sum()
    }

    /// The fields of a type; those of the message have the index 0.
    pub(super) fn fields(&self, of: usize) -> &[Field] {
        self.types.get(of).map_or(&[], Vec::as_slice)
    }

    /// Whether the messages state their time, in their header or on their own.
    pub(super) fn has_stamp(&self) -> bool {
        let is_stamp = |field: &Field| field.role == Role::Stamp;
        self.fields(0).iter().any(|field| match field.kind {
            Kind::Message(header) if is_header(field) => self.fields(header).iter().any(is_stamp),
            Kind::Message(_) | Kind::Number(_) | Kind::Text | Kind::WideText | Kind::Time | Kind::Duration => {
                is_stamp(field)
            }
        })
    }
}

/// Whether a field of a message is its header.
pub(super) fn is_header(field: &Field) -> bool {
    field.name == "header" && field.count == Count::One
}

/// Package and name of a type: `sensor_msgs/msg/JointState` and `sensor_msgs::msg::JointState` are `sensor_msgs/JointState`.
pub(super) fn normal(name: &str) -> String {
    let parts: Vec<&str> = name.split(['/', ':']).filter(|part| !part.is_empty()).collect();
    match parts.as_slice() {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [package, .., last] => format!("{package}/{last}"),
    }
}

fn placeholder() -> Field {
    let (name, kind) = (PLACEHOLDER.to_owned(), Kind::Number(Number::U8));
    Field { name, kind, count: Count::One, role: Role::NoSignal }
}

fn linked(field: &DeclaredField, inside: &str, places: &HashMap<&str, usize>) -> Result<Field, String> {
    if field.name.len() > LONGEST_NAME {
        return Err(format!("the name of a field of {inside} has {} bytes", field.name.len()));
    }
    let kind = match &field.kind {
        DeclaredKind::Known(kind) => *kind,
        DeclaredKind::Named(name) => named(name, inside, places).ok_or_else(|| {
            format!("the definition of type {name}, of field {:?} in {inside}, is missing", field.name)
        })?,
    };
    let role = match (field.name.as_str(), kind, field.count) {
        ("stamp", Kind::Time, Count::One) => Role::Stamp,
        ("seq", Kind::Number(_), Count::One) if inside == "std_msgs/Header" => Role::NoSignal,
        (PLACEHOLDER, _, _) => Role::NoSignal,
        (_, _, _) => Role::Value,
    };
    Ok(Field { name: field.name.clone(), kind, count: field.count, role })
}

/// The kind of a type by its name: in full, in the package of the type that names it, or of ROS itself.
fn named(name: &str, inside: &str, places: &HashMap<&str, usize>) -> Option<Kind> {
    let name = normal(name);
    let package = inside.split('/').next().unwrap_or_default();
    let candidates = [name.clone(), format!("{package}/{name}"), format!("std_msgs/{name}")];
    match candidates.iter().find_map(|candidate| of_time(candidate)) {
        Some(kind) => Some(kind),
        None => candidates.iter().find_map(|candidate| places.get(candidate.as_str())).map(|&p| Kind::Message(p)),
    }
}

fn of_time(name: &str) -> Option<Kind> {
    match name {
        "builtin_interfaces/Time" | "builtin_interfaces/Time_" => Some(Kind::Time),
        "builtin_interfaces/Duration" | "builtin_interfaces/Duration_" => Some(Kind::Duration),
        _ => None,
    }
}
