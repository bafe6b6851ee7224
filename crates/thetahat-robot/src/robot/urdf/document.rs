use std::path::Path;

use roxmltree::{Document, Error, ParsingOptions};

use super::{UrdfError, element::Element};

/// Most elements, texts and comments of a file.
const MOST_NODES: u32 = 2_000_000;
/// Most attributes of one element, and namespaces of a file: the XML reader compares each with each.
const MOST_ATTRIBUTES: usize = 1000;
const MOST_NAMESPACES: usize = 1000;
/// Most links and joints, including fixed ones.
const MOST_PARTS: usize = 4000;

/// The XML of a robot's file.
#[doc(hidden)]
pub fn parse<'a>(text: &'a str, path: &Path) -> Result<Document<'a>, UrdfError> {
    let too_large = |what, limit| UrdfError::TooLarge { path: path.to_owned(), what, limit };
    if text.matches("xmlns").count() > MOST_NAMESPACES {
        return Err(too_large("XML namespaces", MOST_NAMESPACES));
    }
    if most_attributes(text) > MOST_ATTRIBUTES {
        return Err(too_large("attributes in one element", MOST_ATTRIBUTES));
    }
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        if let Error::NodesLimitReached = error {
            return too_large("elements, texts and comments", MOST_NODES as usize);
        }
        let line = error.pos().row as usize;
        if let Error::UnknownNamespace(prefix, _) = &error
            && prefix == "xacro"
        {
            let element = "an element in the namespace xacro".to_owned();
            return UrdfError::Xacro { place: super::Place { path: path.to_owned(), line, element } };
        }
        UrdfError::Syntax { path: path.to_owned(), line, column: error.pos().col as usize, problem: problem_of(&error) }
    })
}

/// Upper bound of the number of attributes of any element: equals signs between an angle bracket and the next one, outside of
/// quotes.
fn most_attributes(text: &str) -> usize {
    let (mut most, mut here, mut quote) = (0, 0, None);
    for byte in text.bytes() {
        match (quote, byte) {
            (Some(open), _) if byte == open => quote = None,
            (Some(_), b'<') | (None, b'<' | b'>') => (here, quote) = (0, None),
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'=') => here += 1,
            _ => {}
        }
        most = most.max(here);
    }
    most
}

/// The problem in words, with a remedy where other readers of URDF are less strict.
fn problem_of(error: &Error) -> String {
    let problem = without_position(&error.to_string());
    let remedy = if let Error::UnknownNamespace(prefix, _) = error {
        format!("; add xmlns:{prefix}=\"...\" to the root element")
    } else if let Error::UnexpectedDeclaration(_) = error {
        "; remove what stands before `<?xml`".to_owned()
    } else {
        String::new()
    };
    problem + &remedy
}

/// The XML reader ends its messages with the position, which our message already states.
fn without_position(message: &str) -> String {
    message.rsplit_once(" at ").map_or(message, |(before, _)| before).to_owned()
}

/// The `<robot>` of a URDF that is not xacro.
pub(super) fn robot<'a>(document: &'a Document<'a>, path: &'a Path) -> Result<Element<'a>, UrdfError> {
    let root = Element::root(document, path);
    root.check_expanded()?;
    if root.tag() != "robot" {
        return Err(UrdfError::NotARobot { place: root.place() });
    }
    let mut parts = 0;
    for child in root.elements() {
        child.check_expanded()?;
        match child.tag() {
            "link" | "joint" | "transmission" => {
                parts += 1;
                child.descendants().try_for_each(|element| element.check_expanded())?;
            }
            "ros2_control" => parts += child.elements().filter(|e| e.tag() == "transmission").count(),
            _ => {}
        }
    }
    if parts > MOST_PARTS {
        return Err(UrdfError::TooLarge { path: path.to_owned(), what: "links and joints", limit: MOST_PARTS });
    }
    Ok(root)
}
