//! A small reader of the workspace's Rust sources as rustfmt writes them: structs and enums with the doc comments and attributes
//! of their members, constants, and bodies of functions. It knows no more of Rust than the tables need.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use thetahat_testing::project;

/// Crates without types that files are read into or written from.
const FRONTS: [&str; 4] = ["thetahat-cli", "thetahat-python", "thetahat-testing", "thetahat-web"];

/// The sources of the library's crates.
pub struct Sources {
    files: Vec<File>,
}

/// A source file.
pub struct File {
    /// Its path below `src` without the extension, such as `checks/finding`: the same in whichever crate it lies.
    pub name: String,
    pub text: String,
    items: Vec<Item>,
}

/// A struct or an enum.
pub struct Item {
    pub name: String,
    /// The name of its file.
    pub file: String,
    is_public: bool,
    pub docs: String,
    pub attributes: Attributes,
    /// Fields or variants.
    pub members: Vec<Member>,
}

/// A field or a variant.
pub struct Member {
    pub name: String,
    pub docs: String,
    pub attributes: Attributes,
    pub holds: Holds,
}

/// What a member holds.
pub enum Holds {
    /// Nothing: a variant of a name alone.
    Nothing,
    /// One value of this type: a field, or a variant with one value.
    One(String),
    /// Named fields: a variant.
    Fields(Vec<Member>),
}

impl Sources {
    pub fn read() -> Self {
        let mut files = Vec::new();
        for folder in entries(&project("crates")).iter().filter(|folder| !FRONTS.iter().any(|f| folder.ends_with(f))) {
            collect(&folder.join("src"), "", &mut files);
        }
        Self { files }
    }

    /// A file by its name.
    pub fn file(&self, name: &str) -> &File {
        self.files.iter().find(|f| f.name == name).unwrap_or_else(|| panic!("no file {name}.rs in crates/*/src"))
    }

    /// A struct or enum that a file may name.
    pub fn item(&self, name: &str, file: &str) -> &Item {
        self.find(name, file)
            .unwrap_or_else(|| panic!("{file}.rs: there is no one struct or enum {name} in crates/*/src"))
    }

    /// The same where there is one: the file's own, one of its room, one of a room that it uses, or the only public one of that name.
    pub fn find(&self, name: &str, file: &str) -> Option<&Item> {
        let of_name = || self.files.iter().flat_map(|f| &f.items).filter(move |item| item.name == name);
        let own = only(of_name().filter(|item| item.file == file));
        let near = || only(of_name().filter(|item| room(&item.file) == room(file)));
        let public = || of_name().filter(|item| item.is_public);
        let is_used = |item: &&Item| self.file(file).text.contains(&format!("{}::", room(&item.file)));
        own.or_else(near).or_else(|| only(public())).or_else(|| only(public().filter(is_used)))
    }
}

/// The room of a file.
fn room(file: &str) -> &str {
    file.split('/').next().unwrap_or(file)
}

fn only<'i>(mut items: impl Iterator<Item = &'i Item>) -> Option<&'i Item> {
    let first = items.next()?;
    items.next().is_none().then_some(first)
}

fn entries(folder: &Path) -> BTreeSet<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    entries.map(|entry| entry.expect("it is readable").path()).collect()
}

fn collect(folder: &Path, name: &str, files: &mut Vec<File>) {
    for path in entries(folder) {
        let stem = path.file_stem().expect("a file has a name").to_string_lossy();
        let name = if name.is_empty() { stem.into_owned() } else { format!("{name}/{stem}") };
        if path.is_dir() {
            collect(&path, &name, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            files.push(File { items: items(&text, &name), name, text });
        }
    }
}

impl File {
    /// The expression of a constant.
    pub fn constant(&self, name: &str) -> &str {
        let after =
            |word: &str| self.text.split_once(&format!("{word} {name}: ")).and_then(|(_, rest)| rest.split_once(" ="));
        let after = after("const").or_else(|| after("static"));
        let value = after.and_then(|(_, rest)| rest.split_once(";\n")).map(|(value, _)| value.trim());
        value.unwrap_or_else(|| panic!("{}.rs: no constant {name}", self.name))
    }

    /// The expression of a function of its own, or else of a method.
    pub fn function(&self, name: &str) -> &str {
        body(&self.text, &format!("\nfn {name}("), "\n}")
            .or_else(|| body(&self.text, &format!(" fn {name}("), "\n    }"))
            .unwrap_or_else(|| panic!("{}.rs: no function {name}", self.name))
    }

    /// What `Default` gives for a type.
    pub fn default(&self, name: &str) -> Option<&str> {
        let block = body(&self.text, &format!("impl Default for {name} "), "\n}")?;
        body(block, "fn default() -> Self ", "\n    }")
    }

    /// The text that a match gives for a variant: `Self::X => "text"`.
    pub fn text_of(&self, variant: &str) -> Option<&str> {
        let after = self.text.split_once(&format!("Self::{variant} => \""))?.1;
        after.split_once('"').map(|(text, _)| text)
    }

    /// The values that a match gives for a variant: `Self::X => (a, b)`.
    pub fn values_of(&self, variant: &str) -> Option<Vec<String>> {
        let after = self.text.split_once(&format!("Self::{variant} => ("))?.1;
        after.split_once("),\n").map(|(values, _)| split(values, ','))
    }
}

/// What stands in the braces that follow `start`, up to `end`.
fn body<'t>(text: &'t str, start: &str, end: &str) -> Option<&'t str> {
    let opened = text.split_once(start)?.1.split_once("{\n")?.1;
    opened.split_once(end).map(|(body, _)| body.trim())
}

/// Doc comments and attributes above an item or a member.
#[derive(Default)]
struct Above {
    docs: Vec<String>,
    attributes: Vec<String>,
}

/// Reads lines one after the other.
struct Reader<'t> {
    lines: std::iter::Peekable<std::vec::IntoIter<&'t str>>,
}

impl<'t> Reader<'t> {
    fn new(lines: Vec<&'t str>) -> Self {
        Self { lines: lines.into_iter().peekable() }
    }

    /// The doc comments and attributes from here on; none of them where something else stands here.
    fn above(&mut self) -> Above {
        let mut above = Above::default();
        while let Some(line) = self.lines.next_if(|line| line.starts_with("///") || line.starts_with("#[")) {
            match line.strip_prefix("///") {
                Some(doc) => above.docs.push(doc.trim().to_owned()),
                None => above.attributes.push(self.through(line, "]")),
            }
        }
        above
    }

    /// A line with those that follow, up to one with this end.
    fn through(&mut self, first: &str, end: &str) -> String {
        let mut text = first.trim().to_owned();
        while !text.ends_with(end) {
            let Some(line) = self.lines.next() else { panic!("`{first}` has no end") };
            text = [&text, " ", line.trim()].concat();
        }
        text
    }

    /// The lines of a block without its indent, up to the closing line.
    fn block(&mut self, closing: &str) -> Vec<&'t str> {
        let inside = std::iter::from_fn(|| self.lines.next_if(|line| *line != closing));
        let lines = inside.map(|line| line.strip_prefix("    ").unwrap_or(line)).collect();
        self.lines.next();
        lines
    }
}

fn items(text: &str, file: &str) -> Vec<Item> {
    let mut reader = Reader::new(text.lines().collect());
    let mut items = Vec::new();
    while reader.lines.peek().is_some() {
        let above = reader.above();
        let Some(line) = reader.lines.next() else { break };
        let Some(name) = opened(line) else { continue };
        let members = members(reader.block("}"));
        items.push(Item {
            name: name.to_owned(),
            file: file.to_owned(),
            is_public: line.starts_with("pub "),
            docs: first_paragraph(&above.docs),
            attributes: Attributes(above.attributes),
            members,
        });
    }
    items
}

/// The name of the struct or enum whose braces a line opens.
fn opened(line: &str) -> Option<&str> {
    let rest = without_visibility(line).strip_suffix(" {")?;
    let name = rest.strip_prefix("struct ").or_else(|| rest.strip_prefix("enum "))?;
    name.split('<').next()
}

fn without_visibility(line: &str) -> &str {
    let restricted = || line.strip_prefix("pub(")?.split_once(") ").map(|(_, rest)| rest);
    line.strip_prefix("pub ").or_else(restricted).unwrap_or(line)
}

fn first_paragraph(docs: &[String]) -> String {
    docs.split(|line| line.is_empty()).next().unwrap_or_default().join(" ")
}

fn members(lines: Vec<&str>) -> Vec<Member> {
    let mut reader = Reader::new(lines);
    let mut members = Vec::new();
    while reader.lines.peek().is_some() {
        let Above { docs, attributes } = reader.above();
        let Some(line) = reader.lines.next() else { break };
        if line.is_empty() || line.starts_with("//") {
            continue;
        }
        let (name, holds) = member(without_visibility(line), &mut reader);
        members.push(Member { name, docs: first_paragraph(&docs), attributes: Attributes(attributes), holds });
    }
    members
}

fn member(line: &str, reader: &mut Reader<'_>) -> (String, Holds) {
    if let Some(name) = line.strip_suffix(" {") {
        return (name.to_owned(), Holds::Fields(members(reader.block("},"))));
    }
    let line = reader.through(line, ",");
    let line = line.trim_end_matches(',');
    if let Some((name, of)) = line.split_once(": ") {
        return (name.trim_start_matches('_').to_owned(), Holds::One(of.to_owned()));
    }
    match line.split_once('(') {
        Some((name, of)) => (name.to_owned(), Holds::One(of.trim_end_matches(')').to_owned())),
        None => (line.to_owned(), Holds::Nothing),
    }
}

/// Attributes as they stand.
pub struct Attributes(Vec<String>);

impl Attributes {
    /// The value of a key of `#[serde(...)]`; empty where it has none.
    pub fn serde(&self, key: &str) -> Option<&str> {
        let inside = self.0.iter().filter_map(|a| a.strip_prefix("#[serde(")?.strip_suffix(")]"));
        inside.flat_map(pieces).find_map(|piece| match piece.split_once(" = ") {
            Some((name, value)) if name == key => value.strip_prefix('"')?.strip_suffix('"'),
            None if piece == key => Some(""),
            Some(_) | None => None,
        })
    }

    pub fn derives(&self, name: &str) -> bool {
        let derived = self.0.iter().filter_map(|a| a.strip_prefix("#[derive(")?.strip_suffix(")]"));
        derived.flat_map(|names| names.split(", ")).any(|derived| derived == name)
    }

    pub fn is_default(&self) -> bool {
        self.0.iter().any(|a| a == "#[default]")
    }
}

/// The pieces between the commas that stand in no brackets and no quotation marks.
pub fn split(text: &str, at: char) -> Vec<String> {
    pieces_at(text, at).into_iter().map(str::to_owned).collect()
}

fn pieces(text: &str) -> Vec<&str> {
    pieces_at(text, ',')
}

fn pieces_at(text: &str, at: char) -> Vec<&str> {
    let (mut pieces, mut start, mut depth, mut quoted, mut escaped) = (Vec::new(), 0, 0, false, false);
    for (i, c) in text.char_indices() {
        quoted ^= c == '"' && !escaped;
        escaped = c == '\\' && !escaped;
        depth += i32::from(!quoted && "([{<".contains(c)) - i32::from(!quoted && ")]}>".contains(c));
        if c == at && depth == 0 && !quoted {
            pieces.push(text[start..i].trim());
            start = i + c.len_utf8();
        }
    }
    pieces.push(text[start..].trim());
    pieces.retain(|piece| !piece.is_empty());
    pieces
}
