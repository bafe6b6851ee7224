//! XML as xacro works on it: elements with the file and line they come from.

use std::{fmt::Write, path::Path, rc::Rc};

use roxmltree::{Document, Node as XmlNode};

use super::XacroProblem;
use crate::robot::Place;

/// Most elements in one another, macros and includes counted.
pub(super) const DEEPEST: usize = 150;

/// An element or a text; comments are left out.
#[derive(Debug, Clone)]
pub(super) enum Node {
    Element(Rc<Element>),
    Text(Rc<str>),
}

/// An element of a file or of the expansion.
#[derive(Debug, Clone)]
pub(super) struct Element {
    /// Its name with prefix.
    pub(super) name: String,
    pub(super) attributes: Vec<(String, String)>,
    pub(super) children: Vec<Node>,
    pub(super) path: Rc<Path>,
    pub(super) line: usize,
}

impl Element {
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    pub(super) fn elements(&self) -> impl Iterator<Item = &Rc<Self>> {
        elements_of(&self.children)
    }

    pub(super) fn place(&self) -> Place {
        let name = self.attribute("name").map_or(String::new(), |name| format!(" name=\"{}\"", shortened(name)));
        let element = format!("<{}{name}>", shortened(&self.name));
        Place { path: self.path.to_path_buf(), line: self.line, element }
    }
}

/// The elements among nodes.
pub(super) fn elements_of(nodes: &[Node]) -> impl Iterator<Item = &Rc<Element>> {
    nodes.iter().filter_map(|node| if let Node::Element(element) = node { Some(element) } else { None })
}

/// A text shortened so that a message stays readable.
pub(super) fn shortened(text: &str) -> String {
    const SHOWN: usize = 80;
    if text.chars().count() <= SHOWN {
        return text.to_owned();
    }
    text.chars().take(SHOWN).chain(['…']).collect()
}

/// The root element of a document.
pub(super) fn tree_of(document: &Document<'_>, path: &Rc<Path>) -> Result<Element, XacroProblem> {
    let text = document.input_text();
    let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(place, _)| place + 1)).collect();
    Source { text, path, lines }.element(document.root_element(), 0)
}

/// The prefixes that a document declares, with their namespaces; without that of xacro.
pub(super) fn namespaces_of(document: &Document<'_>) -> Vec<(String, String)> {
    let root = document.root_element();
    let named =
        root.namespaces().filter_map(|namespace| Some((namespace.name()?.to_owned(), namespace.uri().to_owned())));
    named.filter(|(name, _)| name != "xml" && name != "xacro").collect()
}

struct Source<'a> {
    text: &'a str,
    path: &'a Rc<Path>,
    /// Where each line begins.
    lines: Vec<usize>,
}

impl Source<'_> {
    fn element(&self, node: XmlNode<'_, '_>, depth: usize) -> Result<Element, XacroProblem> {
        if depth > DEEPEST {
            return Err(XacroProblem::TooDeep { limit: DEEPEST });
        }
        let attribute = |attribute: roxmltree::Attribute<'_, '_>| {
            (self.text[attribute.range_qname()].to_owned(), attribute.value().to_owned())
        };
        let start = node.range().start;
        let mut children = Vec::new();
        for child in node.children() {
            if child.is_element() {
                children.push(Node::Element(Rc::new(self.element(child, depth + 1)?)));
            } else if let Some(text) = child.text().filter(|_| child.is_text()) {
                children.push(Node::Text(Rc::from(text)));
            }
        }
        Ok(Element {
            name: name_at(self.text, start),
            attributes: node.attributes().map(attribute).collect(),
            children,
            path: Rc::clone(self.path),
            line: self.lines.partition_point(|line| *line <= start),
        })
    }
}

/// The name with prefix of the element that begins at `start`.
fn name_at(text: &str, start: usize) -> String {
    let after = text[start..].trim_start_matches('<');
    let end = after.find(|c: char| c.is_whitespace() || matches!(c, '/' | '>')).unwrap_or(after.len());
    after[..end].to_owned()
}

/// The text of a document with this root, which declares these namespaces.
pub(super) fn to_text(root: &Element, namespaces: &[(String, String)]) -> String {
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    let declared = namespaces.iter().map(|(prefix, uri)| (format!("xmlns:{prefix}"), uri.clone()));
    let mut root = root.clone();
    let own = std::mem::take(&mut root.attributes);
    root.attributes = own.into_iter().chain(declared).collect();
    write(&mut text, &root, 0);
    text
}

fn write(text: &mut String, element: &Element, depth: usize) {
    let indent = "  ".repeat(depth);
    text.extend([indent.as_str(), "<", &element.name]);
    for (name, value) in &element.attributes {
        // A text that is written cannot fail.
        _ = write!(text, " {name}=\"{}\"", escaped_attribute(value));
    }
    if element.children.is_empty() {
        text.push_str("/>\n");
        return;
    }
    text.push('>');
    let has_elements = element.elements().next().is_some();
    text.push_str(if has_elements { "\n" } else { "" });
    for child in &element.children {
        match child {
            Node::Element(child) => write(text, child, depth + 1),
            Node::Text(content) if has_elements && content.trim().is_empty() => {}
            Node::Text(content) => text.push_str(&escaped(content)),
        }
    }
    text.push_str(if has_elements { &indent } else { "" });
    text.extend(["</", &element.name, ">\n"]);
}

fn escaped(text: &str) -> String {
    escaped_with(text, |_| None)
}

/// A reader turns line breaks and tabs of an attribute into blanks unless they are escaped.
fn escaped_attribute(text: &str) -> String {
    escaped_with(text, |c| match c {
        '\n' => Some("&#10;"),
        '\r' => Some("&#13;"),
        '\t' => Some("&#9;"),
        _ => None,
    })
}

fn escaped_with(text: &str, more: impl Fn(char) -> Option<&'static str>) -> String {
    let escape = |c: char| match c {
        '&' => Some("&amp;"),
        '<' => Some("&lt;"),
        '>' => Some("&gt;"),
        '"' => Some("&quot;"),
        _ => more(c),
    };
    let mut written = String::with_capacity(text.len());
    for c in text.chars() {
        match escape(c) {
            Some(escape) => written.push_str(escape),
            None => written.push(c),
        }
    }
    written
}
