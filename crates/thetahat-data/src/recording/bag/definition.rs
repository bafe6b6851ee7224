//! Definitions of messages as bags store them: the text of a type, then those of the types inside, each below a line of `=` and its name.

use super::idl;
use super::schema::{Count, Declared, DeclaredField, DeclaredKind, Encoding, Kind, Number, Schema, normal};

/// Longest definition that is read, in bytes.
pub(super) const LONGEST_DEFINITION: usize = 1 << 20;
/// Least number of `=` in the line between two definitions.
const RULE: usize = 10;

/// The language of a definition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Language {
    Msg,
    Idl,
}

/// The schema of the type `name` that a definition describes.
pub(super) fn schema(name: &str, text: &str, language: Language, encoding: Encoding) -> Result<Schema, String> {
    if text.len() > LONGEST_DEFINITION {
        return Err(format!("its definition has {} bytes, at most {LONGEST_DEFINITION} are read", text.len()));
    }
    let mut declared = Vec::new();
    let sections = sections(name, text, language);
    for section in &sections {
        match section.language {
            Language::Msg => declared.push(message(section, encoding)?),
            Language::Idl => declared.extend(idl::types(&section.text)?),
        }
    }
    Schema::link(name, &declared, encoding)
}

struct Section {
    name: String,
    language: Language,
    text: String,
}

/// The parts of a definition. The first has no name of its own; it is empty where each part has one.
fn sections(name: &str, text: &str, language: Language) -> Vec<Section> {
    let mut sections = vec![Section { name: normal(name), language, text: String::new() }];
    let mut after_rule = false;
    for line in text.lines() {
        let trimmed = line.trim();
        if is_rule(trimmed) {
            after_rule = true;
            continue;
        }
        match (after_rule.then(|| head(trimmed)).flatten(), sections.last_mut()) {
            (Some(section), _) => sections.push(section),
            (None, Some(section)) => section.text.extend([line, "\n"]),
            (None, None) => {}
        }
        after_rule = false;
    }
    let is_named_again = sections.iter().skip(1).any(|section| section.name == sections[0].name);
    if is_named_again && sections[0].text.trim().is_empty() {
        sections.remove(0);
    }
    sections
}

fn is_rule(line: &str) -> bool {
    line.len() >= RULE && line.bytes().all(|byte| byte == b'=')
}

fn head(line: &str) -> Option<Section> {
    let (word, name) = line.split_once(':')?;
    let language = match word {
        "MSG" => Language::Msg,
        "IDL" => Language::Idl,
        _ => return None,
    };
    Some(Section { name: normal(name.trim()), language, text: String::new() })
}

fn message(section: &Section, encoding: Encoding) -> Result<Declared, String> {
    let fields = section.text.lines().filter_map(|line| field(line, encoding).transpose());
    let fields = fields.collect::<Result<_, String>>().map_err(|e| format!("definition of {}: {e}", section.name))?;
    Ok(Declared { name: section.name.clone(), fields })
}

/// The field of a line; none in a line of a constant, a comment or nothing.
fn field(line: &str, encoding: Encoding) -> Result<Option<DeclaredField>, String> {
    let line = line.trim();
    if line.is_empty() || line.starts_with('#') {
        return Ok(None);
    }
    let unclear = || format!("expected a type and a name, found {line:?}");
    let (kind, rest) = line.split_once(char::is_whitespace).ok_or_else(unclear)?;
    let rest = rest.trim_start();
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    let (name, after) = rest.split_at(end);
    if after.trim_start().starts_with('=') {
        return Ok(None);
    }
    if name.is_empty() {
        return Err(unclear());
    }
    let (base, count) = split_count(kind).ok_or_else(unclear)?;
    let base = base.split("<=").next().unwrap_or_default();
    Ok(Some(DeclaredField { name: name.to_owned(), kind: kind_of(base, encoding), count }))
}

/// The element and the number of elements of a type such as `float64[3]`, `float64[]` or `float64[<=3]`.
fn split_count(kind: &str) -> Option<(&str, Count)> {
    let Some((base, count)) = kind.split_once('[') else { return Some((kind, Count::One)) };
    let count = count.strip_suffix(']')?;
    if count.is_empty() || count.starts_with("<=") {
        return Some((base, Count::Sequence));
    }
    Some((base, Count::Fixed(count.parse().ok()?)))
}

fn kind_of(base: &str, encoding: Encoding) -> DeclaredKind {
    let kind = match base {
        "byte" if encoding == Encoding::Ros1 => Kind::Number(Number::I8),
        "bool" | "byte" | "char" | "uint8" => Kind::Number(Number::U8),
        "int8" => Kind::Number(Number::I8),
        "int16" => Kind::Number(Number::I16),
        "uint16" => Kind::Number(Number::U16),
        "int32" => Kind::Number(Number::I32),
        "uint32" => Kind::Number(Number::U32),
        "int64" => Kind::Number(Number::I64),
        "uint64" => Kind::Number(Number::U64),
        "float32" => Kind::Number(Number::F32),
        "float64" => Kind::Number(Number::F64),
        "string" => Kind::Text,
        "wstring" => Kind::WideText,
        "time" if encoding == Encoding::Ros1 => Kind::Time,
        "duration" if encoding == Encoding::Ros1 => Kind::Duration,
        _ => return DeclaredKind::Named(base.to_owned()),
    };
    DeclaredKind::Known(kind)
}
