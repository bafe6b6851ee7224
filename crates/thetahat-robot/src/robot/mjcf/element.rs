//! Elements and attributes that know their position in the files.

use std::path::Path;

use roxmltree::{Document, Node};

use super::{error::MjcfError, joined::Origins};
use crate::robot::{LARGEST, Place};
use thetahat_ground::visible::visible;

/// Most characters of a name or value in messages.
const SHOWN: usize = 60;
/// Most elements of all sections of one kind.
const MOST_ELEMENTS: usize = 10_000;

/// A text and the files that it is from.
#[derive(Debug)]
pub(super) struct Source<'a> {
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
    pub(super) origins: &'a Origins,
}

/// An element of a model.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element<'a> {
    node: Node<'a, 'a>,
    source: &'a Source<'a>,
}

/// An attribute of an element, which may be that of a class.
#[derive(Debug, Clone, Copy)]
pub(super) struct Attribute<'a> {
    pub(super) text: &'a str,
    element: Element<'a>,
    key: &'static str,
}

impl<'a> Element<'a> {
    pub(super) fn root(document: &'a Document<'a>, source: &'a Source<'a>) -> Self {
        Self { node: document.root_element(), source }
    }

    /// Whether it is the same element of the file.
    pub(super) fn is(self, other: Self) -> bool {
        self.node == other.node
    }

    pub(super) fn tag(self) -> &'a str {
        self.node.tag_name().name()
    }

    pub(super) fn path(self) -> &'a Path {
        self.source.path
    }

    pub(super) fn elements(self) -> impl DoubleEndedIterator<Item = Self> {
        self.node.children().filter(Node::is_element).map(move |node| Self { node, ..self })
    }

    pub(super) fn named(self, tag: &'static str) -> impl Iterator<Item = Self> {
        self.elements().filter(move |element| element.tag() == tag)
    }

    pub(super) fn descendants(self) -> impl Iterator<Item = Self> {
        self.node.descendants().filter(Node::is_element).map(move |node| Self { node, ..self })
    }

    pub(super) fn attribute(self, key: &'static str) -> Option<Attribute<'a>> {
        self.node.attribute(key).map(|text| Attribute { text: text.trim(), element: self, key })
    }

    pub(super) fn text_of(self, key: &'static str) -> Option<&'a str> {
        self.attribute(key).map(|attribute| attribute.text)
    }

    pub(super) fn required(self, key: &'static str, remedy: &'static str) -> Result<Attribute<'a>, MjcfError> {
        self.attribute(key).ok_or_else(|| self.missing(key, remedy))
    }

    /// Its name, or its position.
    pub(super) fn name(self) -> String {
        match self.text_of("name") {
            Some(name) if !name.is_empty() => shortened(name),
            Some(_) | None => format!("the <{}> in line {}", shortened(self.tag()), self.place().line),
        }
    }

    pub(super) fn place(self) -> Place {
        let Source { path, text, origins } = self.source;
        let (path, line) = origins.line_at(text, path, self.node.range().start);
        Place { path, line, element: self.label() }
    }

    /// Such as `<geom> of <body name="arm">`.
    fn label(self) -> String {
        let of_node = |node: Node<'_, '_>| {
            let named = ["name", "class"].into_iter().find_map(|key| Some((key, node.attribute(key)?)));
            let named = named.map_or(String::new(), |(key, name)| format!(" {key}=\"{}\"", shortened(name)));
            format!("<{}{named}>", shortened(node.tag_name().name()))
        };
        let owner = self.node.ancestors().skip(1).find(|node| node.is_element() && node.has_attribute("name"));
        match owner.filter(|_| !self.node.has_attribute("name")) {
            Some(owner) => format!("{} of {}", of_node(self.node), of_node(owner)),
            None => of_node(self.node),
        }
    }

    pub(super) fn missing(self, missing: &'static str, remedy: &'static str) -> MjcfError {
        MjcfError::Missing { place: self.place(), missing, remedy }
    }

    pub(super) fn unsupported(self, why: &'static str) -> MjcfError {
        MjcfError::Unsupported { place: self.place(), why }
    }

    pub(super) fn unknown(self, kind: &'static str, name: &str) -> MjcfError {
        MjcfError::UnknownName { place: self.place(), kind, name: shortened(name) }
    }

    pub(super) fn same_name(self, first: Self) -> MjcfError {
        MjcfError::DuplicateName { place: self.place(), first_line: first.place().line }
    }
}

impl<'a> Attribute<'a> {
    pub(super) fn number(self) -> Result<f64, MjcfError> {
        self.numbers::<1>().map(|[number]| number)
    }

    pub(super) fn numbers<const N: usize>(self) -> Result<[f64; N], MjcfError> {
        let mut values = [0.0; N];
        match self.overlay(&mut values)? {
            count if count == N => Ok(values),
            _ => Err(self.wrong_count(N)),
        }
    }

    /// Replaces the first `values` by the numbers that the attribute states; returns how many.
    pub(super) fn overlay(self, values: &mut [f64]) -> Result<usize, MjcfError> {
        let most = values.len();
        let mut places = values.iter_mut();
        for part in self.text.split_ascii_whitespace() {
            *places.next().ok_or_else(|| self.wrong_count(most))? = self.parse(part)?;
        }
        Ok(most - places.len())
    }

    fn parse(self, part: &str) -> Result<f64, MjcfError> {
        match part.parse::<f64>() {
            Ok(number) if number.abs() <= LARGEST => Ok(number),
            Ok(_) => Err(self.wrong("numbers up to 1e9")),
            Err(_) => Err(self.wrong("numbers")),
        }
    }

    /// `true` or `false`; none for `auto`.
    pub(super) fn flag(self) -> Result<Option<bool>, MjcfError> {
        match self.text {
            "true" => Ok(Some(true)),
            "false" => Ok(Some(false)),
            "auto" => Ok(None),
            _ => Err(self.wrong("true or false")),
        }
    }

    pub(super) fn place(self) -> Place {
        self.element.place()
    }

    pub(super) fn wrong(self, expected: &'static str) -> MjcfError {
        MjcfError::Value { place: self.place(), key: self.key, expected, found: shortened(self.text) }
    }

    fn wrong_count(self, expected: usize) -> MjcfError {
        self.wrong(match expected {
            1 => "one number",
            2 => "two numbers",
            3 => "three numbers",
            4 => "four numbers",
            6 => "six numbers",
            _ => "fewer numbers",
        })
    }
}

/// A text safe to print, shortened so that a message stays readable.
pub(super) fn shortened(text: &str) -> String {
    let visible = visible(text);
    if visible.chars().count() <= SHOWN {
        return visible.into_owned();
    }
    visible.chars().take(SHOWN).chain(['…']).collect()
}

/// The elements of all sections with this tag, such as `actuator`.
///
/// # Errors
/// [`MjcfError::TooLarge`] for more than any robot has.
pub(super) fn elements_of<'a>(root: Element<'a>, section: &'static str) -> Result<Vec<Element<'a>>, MjcfError> {
    let elements: Vec<Element<'a>> = root.named(section).flat_map(Element::elements).take(MOST_ELEMENTS + 1).collect();
    if elements.len() <= MOST_ELEMENTS {
        return Ok(elements);
    }
    let (path, what) = (root.path().to_owned(), "actuators, equalities or tendons");
    Err(MjcfError::TooLarge { path, what, limit: MOST_ELEMENTS })
}
