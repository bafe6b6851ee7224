//! A URDF with other inertias and friction: bytes that do not say these stay as they are.

use std::{collections::BTreeMap, ops::Range, path::Path};

use roxmltree::{Document, Node};

use super::{
    body::Body,
    said::Said,
    split::split,
    xml::{escaped, number, numbers},
};
use crate::robot::{JointQuantity, LinkPart, RobotError};

/// One step of indentation that is added.
const STEP: &str = "  ";

/// Bytes of the text that are replaced.
struct Edit {
    range: Range<usize>,
    text: String,
}

/// An edited URDF.
pub(super) struct Edited {
    text: String,
    /// What was done beside replacing numbers, a sentence each.
    pub(super) notes: Vec<String>,
}

impl Edited {
    /// The text with a comment at its start, behind the XML declaration.
    pub(super) fn with_header(&self, comment: &str) -> String {
        let (before, behind) = self.text.split_at(start_of_content(&self.text));
        let comment = if self.text.contains("\r\n") { comment.replace('\n', "\r\n") } else { comment.to_owned() };
        format!("{before}{comment}{behind}")
    }
}

/// The URDF `text`, from which the robot was read, with the inertias and the friction of `said`.
pub(super) fn edited(text: &str, said: &Said) -> Result<Edited, RobotError> {
    let parts = said.robot.parts_of_urdf(text, Path::new("the URDF of the results"))?;
    let (bodies, notes) = bodies(said, &parts);
    let document = Document::parse(text)
        .map_err(|e| RobotError::Unreadable { path: "the URDF of the results".into(), reason: e.to_string() })?;
    let mut editor = Editor { text, edits: Vec::new() };
    for child in document.root_element().children().filter(Node::is_element) {
        let name = child.attribute("name").map(str::trim).unwrap_or_default();
        match child.tag_name().name() {
            "link" => bodies.get(name).into_iter().for_each(|body| editor.set_body(child, body)),
            "joint" => {
                let own = said.robot.joints.iter().position(|joint| joint.name == name);
                own.into_iter().for_each(|joint| editor.set_friction(child, said, joint));
            }
            _ => {}
        }
    }
    Ok(Edited { text: editor.finished(), notes })
}

/// The bodies of the links that change, by name.
fn bodies(said: &Said, parts: &[LinkPart]) -> (BTreeMap<String, Body>, Vec<String>) {
    let (mut bodies, mut notes) = (BTreeMap::new(), Vec::new());
    for k in 0..said.robot.joints.len() {
        let own = |part: &&LinkPart| part.carrier == Some(k);
        let fixed: Vec<&LinkPart> =
            parts.iter().filter(own).filter(|p| !p.is_carrier && p.own.iter().any(|v| *v != 0.0)).collect();
        let Some(carrier) = parts.iter().filter(own).find(|part| part.is_carrier) else { continue };
        let shares = split(said.inertial_of(k), &fixed);
        bodies.insert(carrier.name.clone(), Body::new(shares.carrier));
        if fixed.is_empty() {
            continue;
        }
        let names: Vec<&str> = fixed.iter().map(|part| part.name.as_str()).collect();
        let kept = if shares.factor == 1.0 {
            "keep their inertia".to_owned()
        } else {
            let scaled = fixed.iter().map(|p| (p.name.clone(), Body::new(p.own.map(|v| shares.factor * v))));
            bodies.extend(scaled);
            format!("have {} of theirs", number(shares.factor))
        };
        notes.push(format!(
            "{} {kept}; `{}`, to which they are fixed, has the rest of the identified link",
            names.join(", "),
            carrier.name
        ));
    }
    (bodies, notes)
}

/// Where the first element or comment may stand: behind the XML declaration and its line end.
fn start_of_content(text: &str) -> usize {
    let start = text.len() - text.trim_start_matches('\u{feff}').len();
    if !text[start..].starts_with("<?xml") {
        return start;
    }
    let end = text[start..].find("?>").map_or(start, |at| start + at + 2);
    let rest = &text[end..];
    end + if rest.starts_with("\r\n") { 2 } else { usize::from(rest.starts_with('\n')) }
}

struct Editor<'t> {
    text: &'t str,
    edits: Vec<Edit>,
}

impl Editor<'_> {
    fn finished(mut self) -> String {
        self.edits.sort_by_key(|edit| edit.range.start);
        let (mut out, mut at) = (String::with_capacity(self.text.len()), 0);
        for Edit { range, text } in &self.edits {
            out.push_str(&self.text[at..range.start]);
            out.push_str(text);
            at = range.end;
        }
        out.push_str(&self.text[at..]);
        out
    }

    fn insert(&mut self, at: usize, text: String) {
        self.edits.push(Edit { range: at..at, text });
    }

    fn set_body(&mut self, link: Node<'_, '_>, body: &Body) {
        let Some(inertial) = child(link, "inertial") else {
            let own = self.indentation(link);
            self.insert_first(link, &inertial_lines(body, &own, self.line_end()));
            return;
        };
        let [xyz, values] = [numbers(&body.centre), number(body.mass)];
        match child(inertial, "origin") {
            Some(origin) => {
                self.set(origin, "xyz", &xyz);
                if origin.has_attribute("rpy") {
                    self.set(origin, "rpy", "0 0 0");
                }
            }
            None => {
                let first = inertial.children().find(Node::is_element);
                let before = first.map_or_else(String::new, |first| self.space_before(first));
                let at = first.map_or(inertial.range().end, |first| first.range().start);
                self.insert(at, format!("<origin xyz=\"{xyz}\" rpy=\"0 0 0\"/>{before}"));
            }
        }
        child(inertial, "mass").into_iter().for_each(|mass| self.set(mass, "value", &values));
        if let Some(inertia) = child(inertial, "inertia") {
            let keys = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
            keys.into_iter().zip(body.six()).for_each(|(key, value)| self.set(inertia, key, &number(value)));
        }
    }

    fn set_friction(&mut self, joint: Node<'_, '_>, said: &Said, index: usize) {
        let [damping, friction] = [JointQuantity::Fv, JointQuantity::Fc].map(|q| said.of_joint(q, index));
        let [viscous, coulomb] = [number(damping), number(friction)];
        if let Some(dynamics) = child(joint, "dynamics") {
            self.set(dynamics, "damping", &viscous);
            self.set(dynamics, "friction", &coulomb);
        } else if damping != 0.0 || friction != 0.0 {
            let element = format!("<dynamics damping=\"{viscous}\" friction=\"{coulomb}\"/>");
            let last = joint.children().rfind(Node::is_element);
            if let Some(last) = last {
                let before = self.space_before(last);
                self.insert(last.range().end, format!("{before}{element}"));
            }
        }
    }

    /// Sets an attribute, which is added where it is not there.
    fn set(&mut self, element: Node<'_, '_>, key: &str, value: &str) {
        match element.attribute_node(key) {
            Some(attribute) => {
                self.edits.push(Edit { range: attribute.range_value(), text: escaped(value) });
            }
            None => {
                let end = self.start_tag_end(element);
                let slash = usize::from(self.text.as_bytes()[end - 2] == b'/');
                let at = self.text[..end - 1 - slash].trim_end().len();
                self.insert(at, format!(" {key}=\"{}\"", escaped(value)));
            }
        }
    }

    /// Inserts lines as the first content of an element.
    fn insert_first(&mut self, element: Node<'_, '_>, lines: &str) {
        let end = self.start_tag_end(element);
        let own = self.indentation(element);
        let line_end = self.line_end();
        if self.text[..end].ends_with("/>") {
            let tag = element.tag_name().name();
            let at = self.text[..end - 2].trim_end().len();
            self.edits.push(Edit { range: at..end, text: format!(">{line_end}{lines}{line_end}{own}</{tag}>") });
        } else {
            self.insert(end, format!("{line_end}{lines}"));
        }
    }

    /// The end of an element's start tag.
    fn start_tag_end(&self, element: Node<'_, '_>) -> usize {
        let start = element.range().start;
        let mut quote = None;
        for (at, byte) in self.text[start..].bytes().enumerate() {
            match (quote, byte) {
                (Some(open), _) if byte == open => quote = None,
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'>') => return start + at + 1,
                _ => {}
            }
        }
        element.range().end
    }

    /// The space before an element, with the line end in it.
    fn space_before(&self, element: Node<'_, '_>) -> String {
        let before = &self.text[..element.range().start];
        before[before.trim_end().len()..].to_owned()
    }

    /// The space at the start of an element's line.
    fn indentation(&self, element: Node<'_, '_>) -> String {
        let line = self.text[..element.range().start].rsplit('\n').next().unwrap_or_default();
        line.chars().take_while(|c| c.is_whitespace()).collect()
    }

    fn line_end(&self) -> &'static str {
        if self.text.contains("\r\n") { "\r\n" } else { "\n" }
    }
}

fn child<'a, 'input>(node: Node<'a, 'input>, tag: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.is_element() && child.tag_name().name() == tag)
}

/// An `<inertial>` in lines behind the indentation of its link.
pub(super) fn inertial_lines(body: &Body, own: &str, line_end: &str) -> String {
    let [xx, xy, xz, yy, yz, zz] = body.six().map(number);
    let lines = [
        format!("{own}{STEP}<inertial>"),
        format!("{own}{STEP}{STEP}<origin xyz=\"{}\" rpy=\"0 0 0\"/>", numbers(&body.centre)),
        format!("{own}{STEP}{STEP}<mass value=\"{}\"/>", number(body.mass)),
        format!(
            "{own}{STEP}{STEP}<inertia ixx=\"{xx}\" ixy=\"{xy}\" ixz=\"{xz}\" iyy=\"{yy}\" iyz=\"{yz}\" izz=\"{zz}\"/>"
        ),
        format!("{own}{STEP}</inertial>"),
    ];
    lines.join(line_end)
}
