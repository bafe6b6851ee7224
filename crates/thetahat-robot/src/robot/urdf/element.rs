use std::path::Path;

use roxmltree::{Document, Node};

use super::{Place, UrdfError};
use crate::robot::LARGEST;
use thetahat_ground::vector::Vec3;

/// Most characters of a name or value in messages.
const SHOWN: usize = 60;
/// Number of decimals from which a rounded right angle is recognised.
const DECIMALS: usize = 4;

/// An element of a URDF that knows its position in the file.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    node: Node<'a, 'a>,
    path: &'a Path,
}

impl<'a> Element<'a> {
    pub(super) fn root(document: &'a Document<'a>, path: &'a Path) -> Self {
        Self { node: document.root_element(), path }
    }

    pub(super) fn tag(&self) -> &'a str {
        self.node.tag_name().name()
    }

    pub(super) fn path(&self) -> &'a Path {
        self.path
    }

    pub(super) fn elements(self) -> impl Iterator<Item = Self> {
        self.node.children().filter(Node::is_element).map(move |node| Self { node, ..self })
    }

    pub(super) fn descendants(self) -> impl Iterator<Item = Self> {
        self.node.descendants().filter(Node::is_element).map(move |node| Self { node, ..self })
    }

    /// The first child of a given name: other readers also use the first if there are several.
    pub(super) fn child(self, tag: &str) -> Option<Self> {
        self.elements().find(|element| element.tag() == tag)
    }

    pub(super) fn children(self, tag: &str) -> impl Iterator<Item = Self> {
        self.elements().filter(move |element| element.tag() == tag)
    }

    pub(super) fn required_child(self, tag: &str, remedy: &'static str) -> Result<Self, UrdfError> {
        self.child(tag).ok_or_else(|| self.missing(&format!("<{tag}>"), remedy))
    }

    pub(super) fn attribute(self, key: &str) -> Option<&'a str> {
        self.node.attribute(key).map(str::trim)
    }

    pub(super) fn required(self, key: &str, remedy: &'static str) -> Result<&'a str, UrdfError> {
        let value = self.attribute(key).filter(|value| !value.is_empty());
        value.ok_or_else(|| self.missing(&format!("attribute {key}"), remedy))
    }

    /// The number in an attribute, within the limits of geometry and inertia.
    pub(super) fn bounded_number(self, key: &'static str) -> Result<Option<f64>, UrdfError> {
        let Some(text) = self.attribute(key) else { return Ok(None) };
        self.bounded(key, text).map(Some)
    }

    /// The number in an attribute.
    pub(super) fn number(self, key: &'static str) -> Result<Option<f64>, UrdfError> {
        self.attribute(key).map(|text| self.parse(key, text)).transpose()
    }

    /// The element's text.
    pub(super) fn text(self) -> &'a str {
        self.node.text().unwrap_or_default().trim()
    }

    /// The number that is the element's text or, as Drake writes it, its attribute `value`; within the limits of geometry.
    pub(super) fn bounded_content(self) -> Result<f64, UrdfError> {
        match self.attribute("value") {
            Some(text) => self.bounded("value", text),
            None => self.bounded("the text", self.text()),
        }
    }

    /// The three numbers in an attribute.
    pub(super) fn vector(self, key: &'static str) -> Result<Option<Vec3>, UrdfError> {
        Ok(self.vector_texts(key)?.map(|parts| parts.map(|(value, _)| value)))
    }

    /// The three angles in an attribute, with rounded right angles restored.
    pub(super) fn angles(self, key: &'static str) -> Result<Option<Vec3>, UrdfError> {
        Ok(self.vector_texts(key)?.map(|parts| parts.map(|(value, text)| unrounded(value, text))))
    }

    fn vector_texts(self, key: &'static str) -> Result<Option<[(f64, &'a str); 3]>, UrdfError> {
        let Some(text) = self.attribute(key) else { return Ok(None) };
        let mut parts = text.split_ascii_whitespace();
        let three = [parts.next(), parts.next(), parts.next()];
        let ([Some(x), Some(y), Some(z)], None) = (three, parts.next()) else {
            return Err(self.value(key, "three numbers", text));
        };
        Ok(Some([(self.bounded(key, x)?, x), (self.bounded(key, y)?, y), (self.bounded(key, z)?, z)]))
    }

    fn bounded(self, key: &'static str, text: &str) -> Result<f64, UrdfError> {
        let number = self.parse(key, text)?;
        if number.abs() <= LARGEST { Ok(number) } else { Err(self.value(key, "a number up to 1e9", text)) }
    }

    fn parse(self, key: &'static str, text: &str) -> Result<f64, UrdfError> {
        let number: f64 = text.parse().map_err(|_| self.value(key, "a number", text))?;
        if number.is_finite() { Ok(number) } else { Err(self.value(key, "a finite number", text)) }
    }

    /// Refuses xacro syntax.
    pub(super) fn check_expanded(self) -> Result<(), UrdfError> {
        let of_xacro = self.node.tag_name().namespace().is_some_and(|name| name.contains("xacro"));
        let expression = self.node.attributes().any(|a| a.value().contains("${") || a.value().contains("$("));
        let text = self.node.text().is_some_and(|text| text.contains("${"));
        if of_xacro || expression || text { Err(UrdfError::Xacro { place: self.place() }) } else { Ok(()) }
    }

    pub(super) fn missing(self, missing: &str, remedy: &'static str) -> UrdfError {
        UrdfError::Missing { place: self.place(), missing: missing.to_owned(), remedy }
    }

    pub(super) fn value(self, key: &'static str, expected: &'static str, found: &str) -> UrdfError {
        UrdfError::Value { place: self.place(), key, expected, found: shortened(found) }
    }

    pub(super) fn line(self) -> usize {
        self.node.document().text_pos_at(self.node.range().start).row as usize
    }

    pub(super) fn place(self) -> Place {
        let named = |node: Node| node.has_attribute("name") || node.tag_name().name() == "robot";
        let owner = self.node.ancestors().skip(1).find(|node| node.is_element() && named(*node));
        let owner = owner.filter(|node| !named(self.node) && node.tag_name().name() != "robot");
        let owner = owner.map_or(String::new(), |node| format!(" of {}", label(node)));
        Place { path: self.path.to_owned(), line: self.line(), element: format!("{}{owner}", label(self.node)) }
    }
}

fn label(node: Node) -> String {
    let tag = shortened(node.tag_name().name());
    match node.attribute("name") {
        Some(name) => format!("<{tag} name=\"{}\">", shortened(name)),
        None => format!("<{tag}>"),
    }
}

/// A text shortened so that a message stays readable.
pub(super) fn shortened(text: &str) -> String {
    if text.chars().count() <= SHOWN {
        return text.to_owned();
    }
    text.chars().take(SHOWN).chain(['…']).collect()
}

/// The multiple of a right angle, if the angle is one rounded to its last decimal.
fn unrounded(value: f64, text: &str) -> f64 {
    let right = std::f64::consts::FRAC_PI_2;
    let nearest = (value / right).round() * right;
    let Some((_, decimals)) = text.split_once('.') else { return value };
    let digits = decimals.len();
    if digits < DECIMALS || !decimals.bytes().all(|b| b.is_ascii_digit()) {
        return value;
    }
    // Rounded or truncated: within one unit of the last decimal.
    let unit = 10f64.powi(-(digits.min(20) as i32));
    if (value - nearest).abs() <= unit && value.abs() <= 2.0 * std::f64::consts::TAU { nearest } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn rounded_right_angles_are_right_angles() {
        for (text, expected) in
            [("1.5708", FRAC_PI_2), ("-1.5707", -FRAC_PI_2), ("3.14159", PI), ("1.57079632679", FRAC_PI_2)]
        {
            assert_eq!(unrounded(text.parse().unwrap(), text), expected);
        }
        for text in ["1.57", "1.571", "1.5706", "0.5708", "1.5708e0", "1.57079632"] {
            let value: f64 = text.parse().unwrap();
            assert_eq!(unrounded(value, text) == value, text != "1.57079632", "{text}");
        }
    }
}
