//! Edits of an XML text: all other bytes stay unchanged.

use std::ops::Range;

use roxmltree::Node;

use super::{header::MARK, xml::escaped};

/// Bytes of the text that are replaced.
struct Edit {
    range: Range<usize>,
    text: String,
}

/// An edited file.
pub(super) struct Edited {
    pub(super) text: String,
    /// What was done in addition to replacing numbers, a sentence each.
    pub(super) notes: Vec<String>,
}

impl Edited {
    /// The text with a comment at its start, after the XML declaration.
    pub(super) fn with_header(&self, comment: &str) -> String {
        let (before, after) = self.text.split_at(start_of_content(&self.text));
        let after = without_own_comment(after);
        let comment = if self.text.contains("\r\n") { comment.replace('\n', "\r\n") } else { comment.to_owned() };
        format!("{before}{comment}{after}")
    }
}

/// A text without the comment of an earlier export at its start.
fn without_own_comment(text: &str) -> &str {
    let own = text.strip_prefix("<!--").filter(|inside| inside.trim_start().starts_with(MARK));
    let end = own.and_then(|inside| inside.find("-->").map(|at| &inside[at + "-->".len()..]));
    end.map_or(text, |after| after.strip_prefix("\r\n").or(after.strip_prefix('\n')).unwrap_or(after))
}

/// An XML text with its edits.
pub(super) struct Editor<'t> {
    text: &'t str,
    edits: Vec<Edit>,
}

impl<'t> Editor<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self { text, edits: Vec::new() }
    }

    /// The edited text.
    pub(super) fn finished(mut self) -> String {
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

    pub(super) fn insert(&mut self, at: usize, text: String) {
        self.edits.push(Edit { range: at..at, text });
    }

    /// Sets an attribute, which is added where it is not there.
    pub(super) fn set(&mut self, element: Node<'_, '_>, key: &str, value: &str) {
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

    /// Replaces an attribute with its name.
    pub(super) fn replace(&mut self, element: Node<'_, '_>, key: &str, text: &str) {
        if let Some(attribute) = element.attribute_node(key) {
            self.edits.push(Edit { range: attribute.range(), text: text.to_owned() });
        }
    }

    /// Removes an attribute with the space before it.
    pub(super) fn remove(&mut self, element: Node<'_, '_>, key: &str) {
        if let Some(attribute) = element.attribute_node(key) {
            let range = attribute.range();
            let start = self.text[..range.start].trim_end().len();
            self.edits.push(Edit { range: start..range.end, text: String::new() });
        }
    }

    /// Inserts lines before the end tag of an element that has content.
    pub(super) fn insert_last(&mut self, element: Node<'_, '_>, lines: &[String]) {
        let line_end = self.line_end();
        let end = element.range().end;
        let tag = self.text[..end].rfind("</").unwrap_or(end);
        let line = self.text[..tag].trim_end_matches([' ', '\t']).len();
        // On a line of its own, or after other content.
        let (at, before) = if self.text[..line].ends_with('\n') { (line, "") } else { (tag, line_end) };
        self.insert(at, format!("{before}{}{line_end}", lines.join(line_end)));
    }

    /// Inserts lines as the first content of an element.
    pub(super) fn insert_first(&mut self, element: Node<'_, '_>, lines: &str) {
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
    pub(super) fn start_tag_end(&self, element: Node<'_, '_>) -> usize {
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
    pub(super) fn space_before(&self, element: Node<'_, '_>) -> String {
        let before = &self.text[..element.range().start];
        before[before.trim_end().len()..].to_owned()
    }

    /// The space at the start of an element's line.
    pub(super) fn indentation(&self, element: Node<'_, '_>) -> String {
        let line = self.text[..element.range().start].rsplit('\n').next().unwrap_or_default();
        line.chars().take_while(|c| c.is_whitespace()).collect()
    }

    pub(super) fn line_end(&self) -> &'static str {
        if self.text.contains("\r\n") { "\r\n" } else { "\n" }
    }
}

/// Where the first element or comment may stand: after the XML declaration and its line end.
fn start_of_content(text: &str) -> usize {
    let start = text.len() - text.trim_start_matches('\u{feff}').len();
    if !text[start..].starts_with("<?xml") {
        return start;
    }
    let end = text[start..].find("?>").map_or(start, |at| start + at + 2);
    let rest = &text[end..];
    end + if rest.starts_with("\r\n") { 2 } else { usize::from(rest.starts_with('\n')) }
}

pub(super) fn child<'a, 'input>(node: Node<'a, 'input>, tag: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.is_element() && child.tag_name().name() == tag)
}
