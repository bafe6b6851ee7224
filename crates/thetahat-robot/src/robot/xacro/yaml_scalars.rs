//! Scalars of YAML, and lists and dictionaries in brackets.

use super::value::{Number, Value, number_of};

/// Most lists and dictionaries in one another.
pub(super) const DEEPEST: usize = 40;

/// xacro's units by their tags, with their size in SI.
const UNITS: [(&str, f64); 6] = [
    ("!degrees", std::f64::consts::PI / 180.0),
    ("!radians", 1.0),
    ("!meters", 1.0),
    ("!millimeters", 0.001),
    ("!foot", 0.3048),
    ("!inches", 0.0254),
];

/// Why a file is not read.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Problem {
    /// The line, from one.
    pub(super) line: usize,
    pub(super) problem: &'static str,
}

pub(super) type Parsed = Result<Value, Problem>;
/// The number of an expression, such as that of `!degrees 90 / 2`.
pub(super) type Evaluate<'f> = &'f mut dyn FnMut(&str) -> Option<f64>;

/// Reads scalars and flows.
pub(super) struct Scalars<'f> {
    pub(super) evaluate: Evaluate<'f>,
}

impl Scalars<'_> {
    pub(super) fn flow(&mut self, text: &str, line: usize, depth: usize) -> Parsed {
        let text = text.trim();
        if depth > DEEPEST {
            return Err(Problem { line, problem: "lists and dictionaries are nested more than 40 deep" });
        }
        let unclosed = Problem { line, problem: "a bracket is not closed" };
        if let Some(inner) = text.strip_prefix('[') {
            let parts = parts(inner.strip_suffix(']').ok_or(unclosed)?);
            let items = parts.into_iter().map(|part| self.flow(part, line, depth + 1));
            return Ok(Value::list(items.collect::<Result<_, _>>()?));
        }
        let Some(inner) = text.strip_prefix('{') else { return self.scalar(text, line) };
        let mut entries = Vec::new();
        for part in parts(inner.strip_suffix('}').ok_or(unclosed)?) {
            let end = key_end(part).ok_or(Problem { line, problem: "expected `key: value` in braces" })?;
            let key = self.scalar(part[..end].trim(), line)?;
            entries.push((key, self.flow(&part[end + 1..], line, depth + 1)?));
        }
        Ok(Value::map(entries))
    }

    pub(super) fn scalar(&mut self, text: &str, line: usize) -> Parsed {
        let first = text.chars().next().unwrap_or(' ');
        match first {
            '"' | '\'' => quoted(text, first).ok_or(Problem { line, problem: "a quote is not closed" }),
            '!' => self.with_unit(text, line),
            '&' | '*' => Err(Problem { line, problem: "anchors and aliases (& and *) are not read; write the value" }),
            '|' | '>' => Err(Problem { line, problem: "texts of several lines (| and >) are not read; use one line" }),
            _ => Ok(plain(text)),
        }
    }

    fn with_unit(&mut self, text: &str, line: usize) -> Parsed {
        let (tag, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let Some((_, size)) = UNITS.iter().find(|(unit, _)| *unit == tag) else {
            let problem = "the tags are !degrees, !radians, !meters, !millimeters, !foot and !inches";
            return Err(Problem { line, problem });
        };
        let number = (self.evaluate)(rest.trim_matches(|c: char| c.is_whitespace() || c == '"' || c == '\''));
        number
            .map(|number| Value::Float(number * size))
            .ok_or(Problem { line, problem: "expected a number after the unit" })
    }
}

/// Goes over the letters outside of quotes, with the number of brackets that are open there.
fn outside_quotes(text: &str) -> impl Iterator<Item = (usize, char, usize)> {
    let (mut quote, mut open, mut before) = (None, 0usize, ' ');
    text.char_indices().filter_map(move |(place, letter)| {
        let starts = !before.is_alphanumeric();
        before = letter;
        match (quote, letter) {
            (Some(end), _) => {
                quote = Some(end).filter(|end| *end != letter);
                return None;
            }
            (None, '"' | '\'') if starts => {
                quote = Some(letter);
                return None;
            }
            (None, '[' | '{') => open += 1,
            (None, ']' | '}') => open = open.saturating_sub(1),
            (None, _) => {}
        }
        Some((place, letter, open))
    })
}

/// Brackets that a line opens less those that it closes.
pub(super) fn balance(text: &str) -> isize {
    let step = |letter| match letter {
        '[' | '{' => 1,
        ']' | '}' => -1,
        _ => 0,
    };
    outside_quotes(text).map(|(_, letter, _)| step(letter)).sum()
}

/// The place of the colon that ends a key.
pub(super) fn key_end(text: &str) -> Option<usize> {
    let ends = |place: usize| text[place + 1..].chars().next().is_none_or(char::is_whitespace);
    outside_quotes(text).find(|(place, letter, open)| *letter == ':' && *open == 0 && ends(*place)).map(|found| found.0)
}

/// The parts between commas outside of brackets.
fn parts(text: &str) -> Vec<&str> {
    let commas = outside_quotes(text).filter(|(_, letter, open)| *letter == ',' && *open == 0).map(|found| found.0);
    let ends: Vec<usize> = commas.chain([text.len()]).collect();
    let starts = std::iter::once(0).chain(ends.iter().map(|end| end + 1));
    starts.zip(&ends).map(|(start, end)| text[start..*end].trim()).filter(|part| !part.is_empty()).collect()
}

fn quoted(text: &str, quote: char) -> Option<Value> {
    let inner = text.strip_prefix(quote)?.strip_suffix(quote).filter(|_| text.len() >= 2)?;
    Some(Value::text(&match quote {
        '\'' => inner.replace("''", "'"),
        _ => inner.replace("\\n", "\n").replace("\\t", "\t").replace("\\\"", "\"").replace("\\\\", "\\"),
    }))
}

/// A scalar without quotes.
fn plain(text: &str) -> Value {
    match text {
        "" | "~" | "null" | "Null" | "NULL" => return Value::None,
        "true" | "True" | "TRUE" | "yes" | "Yes" | "on" | "On" => return Value::Bool(true),
        "false" | "False" | "FALSE" | "no" | "No" | "off" | "Off" => return Value::Bool(false),
        ".inf" | "+.inf" => return Value::Float(f64::INFINITY),
        "-.inf" => return Value::Float(f64::NEG_INFINITY),
        ".nan" => return Value::Float(f64::NAN),
        _ => {}
    }
    let is_number = text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    match number_of(text).filter(|_| is_number) {
        Some(Number::Integer(value)) => Value::Integer(value),
        Some(Number::Float(value)) => Value::Float(value),
        None => Value::text(text),
    }
}
