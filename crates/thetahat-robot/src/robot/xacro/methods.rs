//! Methods of texts and dictionaries, and entries by index.

use super::{ExpressionError, formats::braces, operators::bounded, value::Value, value_functions::items};

/// The value of `object.name(arguments)`.
pub(super) fn method(object: &Value, name: &str, arguments: &[Value]) -> Result<Value, ExpressionError> {
    if let (Value::Text(text), "format") = (object, name) {
        return braces(text, arguments).and_then(bounded);
    }
    let found = match object {
        Value::Text(text) => of_text(text, name, arguments),
        Value::Map(entries) => of_map(object, entries, name, arguments),
        Value::None
        | Value::Bool(_)
        | Value::Integer(_)
        | Value::Float(_)
        | Value::List(_)
        | Value::Function(_)
        | Value::Module
        | Value::Namespace(_) => None,
    };
    let unknown = || ExpressionError::NotAFunction { found: object.kind(), name: Some(format!(".{name}")) };
    bounded(found.ok_or_else(unknown)?)
}

fn of_text(text: &str, name: &str, arguments: &[Value]) -> Option<Value> {
    let texts: Option<Vec<&str>> =
        arguments.iter().map(|value| if let Value::Text(text) = value { Some(&**text) } else { None }).collect();
    let letters = |c: char, of: &str| of.contains(c);
    if name == "join" {
        return joined(text, arguments.first()?);
    }
    match (name, &texts?[..]) {
        ("lower", []) => Some(Value::text(&text.to_lowercase())),
        ("upper", []) => Some(Value::text(&text.to_uppercase())),
        ("strip", []) => Some(Value::text(text.trim())),
        ("strip", [of]) => Some(Value::text(text.trim_matches(|c| letters(c, of)))),
        ("lstrip", []) => Some(Value::text(text.trim_start())),
        ("lstrip", [of]) => Some(Value::text(text.trim_start_matches(|c| letters(c, of)))),
        ("rstrip", []) => Some(Value::text(text.trim_end())),
        ("rstrip", [of]) => Some(Value::text(text.trim_end_matches(|c| letters(c, of)))),
        ("replace", [from, to]) if !from.is_empty() => Some(Value::text(&text.replace(from, to))),
        ("startswith", [start]) => Some(Value::Bool(text.starts_with(start))),
        ("endswith", [end]) => Some(Value::Bool(text.ends_with(end))),
        ("split", []) => Some(listed(text.split_whitespace())),
        ("split", [separator]) if !separator.is_empty() => Some(listed(text.split(separator))),
        _ => None,
    }
}

fn listed<'t>(parts: impl Iterator<Item = &'t str>) -> Value {
    Value::list(parts.map(Value::text).collect())
}

fn joined(separator: &str, values: &Value) -> Option<Value> {
    let values = items(values)?;
    let texts: Option<Vec<String>> =
        values.iter().map(|value| if let Value::Text(text) = value { Some(text.to_string()) } else { None }).collect();
    Some(Value::text(&texts?.join(separator)))
}

fn of_map(object: &Value, entries: &[(Value, Value)], name: &str, arguments: &[Value]) -> Option<Value> {
    match (name, arguments) {
        ("get", [key]) => Some(object.get(key).cloned().unwrap_or(Value::None)),
        ("get", [key, default]) => Some(object.get(key).unwrap_or(default).clone()),
        ("keys", []) => Some(Value::list(entries.iter().map(|(key, _)| key.clone()).collect())),
        ("values", []) => Some(Value::list(entries.iter().map(|(_, value)| value.clone()).collect())),
        ("items", []) => {
            let pair = |(key, value): &(Value, Value)| Value::list(vec![key.clone(), value.clone()]);
            Some(Value::list(entries.iter().map(pair).collect()))
        }
        _ => None,
    }
}

/// The entry of a list, text or dictionary.
pub(super) fn entry(of: &Value, index: &Value) -> Result<Value, ExpressionError> {
    let missing = || ExpressionError::NoEntry { of: of.kind(), key: index.to_text() };
    if let Value::Map(_) = of {
        return of.get(index).cloned().ok_or_else(missing);
    }
    let values = items(of).ok_or_else(missing)?;
    let Value::Integer(index) = index else { return Err(missing()) };
    place(*index, values.len()).and_then(|place| values.get(place).cloned()).ok_or_else(missing)
}

/// The part of a list or text between two places.
pub(super) fn slice(of: &Value, from: Option<&Value>, to: Option<&Value>) -> Result<Value, ExpressionError> {
    let wrong = || ExpressionError::NoEntry { of: of.kind(), key: "from:to".to_owned() };
    let values = items(of).ok_or_else(wrong)?;
    let end = |value: Option<&Value>, otherwise| match value {
        None => Ok(otherwise),
        Some(Value::Integer(index)) => Ok(clamped(*index, values.len())),
        Some(_) => Err(wrong()),
    };
    let (from, to) = (end(from, 0)?, end(to, values.len())?);
    let part = values.get(from..to.max(from)).unwrap_or_default();
    if let Value::Text(_) = of {
        return Ok(Value::text(&part.iter().map(Value::to_text).collect::<String>()));
    }
    Ok(Value::list(part.to_vec()))
}

/// The place of an index, which counts from the end if it is negative.
fn place(index: i64, count: usize) -> Option<usize> {
    let count = i64::try_from(count).ok()?;
    usize::try_from(if index < 0 { index.checked_add(count)? } else { index }).ok()
}

fn clamped(index: i64, count: usize) -> usize {
    place(index, count).map_or(0, |place| place.min(count))
}
