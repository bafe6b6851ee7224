//! Elements of an MJCF that know where they stand.

use std::path::Path;

use roxmltree::Node;

use super::error::MjcfError;
use thetahat_ground::visible::visible;
use thetahat_model::robot::Place;

/// An element, and the file in messages.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element<'a> {
    pub(super) node: Node<'a, 'a>,
    path: &'a Path,
}

impl<'a> Element<'a> {
    pub(super) fn new(node: Node<'a, 'a>, path: &'a Path) -> Self {
        Self { node, path }
    }

    pub(super) fn tag(self) -> &'a str {
        self.node.tag_name().name()
    }

    pub(super) fn attribute(self, key: &str) -> Option<&'a str> {
        self.node.attribute(key)
    }

    /// The elements in it of any depth, itself first, in the order of the file.
    pub(super) fn descendants(self) -> impl Iterator<Item = Self> {
        self.node.descendants().filter(Node::is_element).map(move |node| Self { node, ..self })
    }

    pub(super) fn elements(self) -> impl Iterator<Item = Self> {
        self.node.children().filter(Node::is_element).map(move |node| Self { node, ..self })
    }

    pub(super) fn named(self, tag: &'static str) -> impl Iterator<Item = Self> {
        self.elements().filter(move |element| element.tag() == tag)
    }

    /// Its name, or where it stands.
    pub(super) fn name(self) -> String {
        match self.attribute("name") {
            Some(name) => visible(name).into_owned(),
            None => format!("the <{}> in line {}", self.tag(), self.line()),
        }
    }

    fn line(self) -> usize {
        self.node.document().text_pos_at(self.node.range().start).row as usize
    }

    pub(super) fn place(self) -> Place {
        let name = self.attribute("name").map(|name| format!(" name=\"{}\"", visible(name)));
        let element = format!("<{}{}>", visible(self.tag()), name.unwrap_or_default());
        Place { path: self.path.to_owned(), line: self.line(), element }
    }

    /// The numbers in an attribute; `text` is its value, which may come from a class.
    pub(super) fn parsed<const N: usize>(self, key: &str, text: &str) -> Result<[f64; N], MjcfError> {
        let expected = match N {
            1 => "a number",
            3 => "three numbers",
            4 => "four numbers",
            6 => "six numbers",
            _ => "numbers",
        };
        let value = || MjcfError::Value {
            place: self.place(),
            key: key.to_owned(),
            expected,
            found: visible(text).chars().take(60).collect(),
        };
        let numbers: Vec<f64> =
            text.split_ascii_whitespace().map(str::parse).collect::<Result<_, _>>().map_err(|_| value())?;
        let all: [f64; N] = numbers.try_into().map_err(|_| value())?;
        if all.iter().all(|number| number.abs() < 1e9) { Ok(all) } else { Err(value()) }
    }

    /// The error of an attribute that should give a direction.
    pub(super) fn no_direction(self, key: &str) -> MjcfError {
        let found = visible(self.attribute(key).unwrap_or_default()).chars().take(60).collect();
        MjcfError::Value { place: self.place(), key: key.to_owned(), expected: "a direction other than zero", found }
    }

    pub(super) fn numbers<const N: usize>(self, key: &str) -> Result<Option<[f64; N]>, MjcfError> {
        self.attribute(key).map(|text| self.parsed(key, text)).transpose()
    }

    pub(super) fn number(self, key: &str) -> Result<Option<f64>, MjcfError> {
        Ok(self.numbers(key)?.map(|[number]| number))
    }
}
