//! The structure of a message: its fields with their lengths and names, and not its numbers.

use super::decode::{Decoded, MOST_ELEMENTS, is_name};
use super::schema::{Count, Field, Kind, Role, Schema};

/// A named part of a message.
pub(super) struct Part<'a> {
    pub(super) name: &'a str,
    pub(super) shape: Shape<'a>,
}

pub(super) enum Shape<'a> {
    /// A number, or a time.
    Number,
    /// An array of numbers.
    Numbers(usize),
    /// An array of texts.
    Texts(Vec<&'a str>),
    /// A text that names its message.
    Name(&'a str),
    Message(Vec<Part<'a>>),
    /// An array of messages.
    Messages(Vec<Vec<Part<'a>>>),
    /// Text, the time of a header, or an array too long to consist of signals.
    Nothing,
}

/// The structure of a decoded message.
pub(super) fn of<'a>(schema: &'a Schema, decoded: &Decoded<'a>) -> Vec<Part<'a>> {
    let (mut lengths, mut texts) = (decoded.lengths.iter().copied(), decoded.texts.iter().copied());
    Walk { schema, lengths: &mut lengths, texts: &mut texts }.message(0, false)
}

struct Walk<'s, 'a> {
    schema: &'a Schema,
    lengths: &'s mut dyn Iterator<Item = usize>,
    texts: &'s mut dyn Iterator<Item = &'a str>,
}

impl<'a> Walk<'_, 'a> {
    fn message(&mut self, of: usize, in_list: bool) -> Vec<Part<'a>> {
        let schema = self.schema;
        let part = |field: &'a Field| Part { name: &field.name, shape: self.shape(field, in_list) };
        schema.fields(of).iter().map(part).collect()
    }

    fn shape(&mut self, field: &Field, in_list: bool) -> Shape<'a> {
        match field.count {
            Count::One => self.one(field, in_list),
            Count::Fixed(count) => self.array(field, count),
            Count::Sequence => {
                let count = self.lengths.next().unwrap_or(0);
                self.array(field, count)
            }
        }
    }

    fn one(&mut self, field: &Field, in_list: bool) -> Shape<'a> {
        match field.kind {
            Kind::Text if in_list && is_name(field) => self.texts.next().map_or(Shape::Nothing, Shape::Name),
            Kind::Message(of) => Shape::Message(self.message(of, in_list)),
            Kind::Number(_) | Kind::Time | Kind::Duration if field.role == Role::Value => Shape::Number,
            Kind::Number(_) | Kind::Time | Kind::Duration | Kind::Text | Kind::WideText => Shape::Nothing,
        }
    }

    fn array(&mut self, field: &Field, count: usize) -> Shape<'a> {
        match field.kind {
            Kind::Message(of) => Shape::Messages((0..count).map(|_| self.message(of, true)).collect()),
            Kind::WideText => Shape::Nothing,
            Kind::Number(_) | Kind::Time | Kind::Duration | Kind::Text if count > MOST_ELEMENTS => Shape::Nothing,
            Kind::Number(_) | Kind::Time | Kind::Duration => Shape::Numbers(count),
            Kind::Text => Shape::Texts((0..count).filter_map(|_| self.texts.next()).collect()),
        }
    }
}
