//! Changes of keys in a TOML text: all other bytes, with their comments, stay.

use std::ops::Range;

use toml::{
    Spanned, Table, Value,
    de::{DeTable, DeValue},
};

/// A key that gets a value, or is removed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Change {
    /// The tables from the root and the key last.
    pub(super) path: Vec<String>,
    /// Which table of an array of tables is meant, from zero.
    pub(super) index: usize,
    /// The value; none removes the key.
    pub(super) value: Option<Value>,
}

impl Change {
    pub(super) fn new(path: &[&str], index: usize, value: impl Into<Option<Value>>) -> Self {
        Self { path: path.iter().map(|key| (*key).to_owned()).collect(), index, value: value.into() }
    }

    /// The key as messages name it; `count` is the number of tables in the array.
    pub(super) fn key(&self, count: usize) -> String {
        let number = if count > 1 { format!("[{}]", self.index + 1) } else { String::new() };
        let (first, rest) = self.path.split_first().map_or(("", &[][..]), |(first, rest)| (first.as_str(), rest));
        [format!("{first}{number}")].into_iter().chain(rest.iter().cloned()).collect::<Vec<_>>().join(".")
    }

    /// The value that a text has.
    pub(super) fn before(&self, text: &str) -> Option<Value> {
        let table: Table = toml::from_str(text).ok()?;
        let (key, tables) = self.path.split_last()?;
        let mut at = &table;
        for name in tables {
            at = inside(at.get(name)?, self.index)?;
        }
        at.get(key).cloned()
    }

    /// The text with the change; none if it cannot be made by an edit of this text.
    pub(super) fn made_in(&self, text: &str) -> Option<String> {
        let edited = self.edited(text)?;
        let (mut expected, found): (Table, Table) = (toml::from_str(text).ok()?, toml::from_str(&edited).ok()?);
        self.change(&mut expected)?;
        (found == expected).then_some(edited)
    }

    /// The change of the values, against which the edit of the text is checked.
    fn change(&self, table: &mut Table) -> Option<()> {
        let (key, tables) = self.path.split_last()?;
        let mut at = table;
        for name in tables {
            let inner = at.entry(name.clone()).or_insert_with(|| Value::Table(Table::new()));
            at = match inner {
                Value::Table(table) => table,
                Value::Array(tables) => tables.get_mut(self.index)?.as_table_mut()?,
                Value::String(_) | Value::Integer(_) | Value::Float(_) | Value::Boolean(_) | Value::Datetime(_) => {
                    return None;
                }
            };
        }
        match &self.value {
            Some(value) => at.insert(key.clone(), value.clone()),
            None => at.remove(key),
        };
        Some(())
    }

    fn edited(&self, text: &str) -> Option<String> {
        let root = DeTable::parse(text).ok()?;
        let (key, tables) = self.path.split_last()?;
        let mut at = Place { span: 0..0, table: root.get_ref() };
        for (depth, name) in tables.iter().enumerate() {
            let Some(inner) = at.table.iter().find(|(key, _)| key.get_ref() == name) else {
                return (depth == 0 && tables.len() == 1).then(|| self.with_new_table(text, name, key)).flatten();
            };
            at = Place::of(inner.1, self.index)?;
        }
        match (at.table.iter().find(|(own, _)| own.get_ref() == key), &self.value) {
            (Some((_, old)), Some(value)) => replaced(text, old.span(), &value.to_string()),
            (Some((own, old)), None) => at.without(text, own.span().start..old.span().end),
            (None, Some(value)) => at.with(text, &format!("{} = {value}", written(key))),
            (None, None) => Some(text.to_owned()),
        }
    }

    /// The text with a table at its end.
    fn with_new_table(&self, text: &str, name: &str, key: &str) -> Option<String> {
        let value = self.value.as_ref()?;
        let end = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
        Some(format!("{text}{end}\n[{name}]\n{} = {value}\n", written(key)))
    }
}

/// The text with a table at the end of an array of tables.
pub(super) fn with_table_of_array(text: &str, name: &str, table: &Table) -> Option<String> {
    let end = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
    let edited = format!("{text}{end}\n[[{name}]]\n{table}");
    let (mut expected, found): (Table, Table) = (toml::from_str(text).ok()?, toml::from_str(&edited).ok()?);
    let tables = expected.entry(name.to_owned()).or_insert_with(|| Value::Array(Vec::new()));
    tables.as_array_mut()?.push(Value::Table(table.clone()));
    (found == expected).then_some(edited)
}

/// A key as a file writes it: quoted where it has other letters than a bare key.
fn written(key: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !key.is_empty() && key.chars().all(is_bare) { key.to_owned() } else { Value::from(key).to_string() }
}

/// A table of values: itself, or one of an array.
fn inside(value: &Value, index: usize) -> Option<&Table> {
    match value {
        Value::Array(tables) => tables.get(index)?.as_table(),
        Value::Table(table) => Some(table),
        Value::String(_) | Value::Integer(_) | Value::Float(_) | Value::Boolean(_) | Value::Datetime(_) => None,
    }
}

/// A table of the text: its braces, its header, or of dotted keys a place without meaning.
struct Place<'t, 'i> {
    span: Range<usize>,
    table: &'t DeTable<'i>,
}

impl<'t, 'i> Place<'t, 'i> {
    fn of(value: &'t Spanned<DeValue<'i>>, index: usize) -> Option<Self> {
        match value.get_ref() {
            DeValue::Table(table) => Some(Self { span: value.span(), table }),
            DeValue::Array(tables) => {
                let one = tables.get(index)?;
                Some(Self { span: one.span(), table: one.get_ref().as_table()? })
            }
            DeValue::String(_)
            | DeValue::Integer(_)
            | DeValue::Float(_)
            | DeValue::Boolean(_)
            | DeValue::Datetime(_) => None,
        }
    }

    /// The text with another entry of the table.
    fn with(&self, text: &str, entry: &str) -> Option<String> {
        let own = text.get(self.span.clone())?;
        if own.starts_with('{') {
            let inner = own.strip_suffix('}')?.trim_end();
            let at = self.span.start + inner.len();
            let comma = if inner == "{" || inner.ends_with(',') { " " } else { ", " };
            let space = if own.ends_with(" }") { "" } else { " " };
            return replaced(text, at..at, &format!("{comma}{entry}{space}"));
        }
        if own.starts_with('[') {
            return line_after(text, self.span.end, entry);
        }
        // Dotted keys: the new one stands below another with the same beginning.
        let (key, value) = self.table.iter().next_back()?;
        let start = text.get(..key.span().start)?.rfind('\n').map_or(0, |at| at + 1);
        let beginning = text.get(start..key.span().start)?;
        line_after(text, value.span().end, &format!("{beginning}{entry}"))
    }

    /// The text without an entry of the table, from its key to the end of its value.
    fn without(&self, text: &str, entry: Range<usize>) -> Option<String> {
        if text.get(self.span.clone())?.starts_with('{') {
            let after = text.get(entry.end..)?;
            let comma = after.find(|c: char| !c.is_whitespace()).filter(|at| after[*at..].starts_with(','));
            if let Some(comma) = comma {
                let end = entry.end + comma + 1;
                let space = text.get(end..)?.find(|c: char| c != ' ').unwrap_or(0);
                return replaced(text, entry.start..end + space, "");
            }
            let before = text.get(..entry.start)?.trim_end();
            return replaced(text, before.strip_suffix(',').unwrap_or(before).len()..entry.end, "");
        }
        let start = text.get(..entry.start)?.rfind('\n').map_or(0, |at| at + 1);
        let end = text.get(entry.end..)?.find('\n').map_or(text.len(), |at| entry.end + at + 1);
        replaced(text, start..end, "")
    }
}

fn replaced(text: &str, range: Range<usize>, by: &str) -> Option<String> {
    Some(format!("{}{by}{}", text.get(..range.start)?, text.get(range.end..)?))
}

/// The text with a line below that of a byte.
fn line_after(text: &str, byte: usize, line: &str) -> Option<String> {
    match text.get(byte..)?.find('\n') {
        Some(end) => replaced(text, byte + end + 1..byte + end + 1, &format!("{line}\n")),
        None => Some(format!("{text}\n{line}\n")),
    }
}
