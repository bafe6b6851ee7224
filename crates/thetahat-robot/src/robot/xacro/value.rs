//! Values of expressions, as Python has them.

use std::{cmp::Ordering, rc::Rc};

/// Largest decimal exponent, exclusive, and smallest one of numbers that Python writes without exponent.
const PLAIN: std::ops::Range<i32> = -4..16;

/// A value of an expression or a property.
#[derive(Debug, Clone)]
pub(super) enum Value {
    None,
    Bool(bool),
    Integer(i64),
    Float(f64),
    Text(Rc<str>),
    /// A list or a tuple.
    List(Rc<Vec<Value>>),
    /// A dictionary in the order of its entries.
    Map(Rc<Vec<(Value, Value)>>),
    /// A function by its name.
    Function(&'static str),
    /// `math`, `python` or `xacro`.
    Module,
    /// The properties of an included file, by their scope.
    Namespace(usize),
}

/// A number of either kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    Integer(i64),
    Float(f64),
}

impl Number {
    pub(super) fn float(self) -> f64 {
        match self {
            Self::Integer(value) => value as f64,
            Self::Float(value) => value,
        }
    }
}

impl From<Number> for Value {
    fn from(number: Number) -> Self {
        match number {
            Number::Integer(value) => Self::Integer(value),
            Number::Float(value) => Self::Float(value),
        }
    }
}

impl Value {
    pub(super) fn text(text: &str) -> Self {
        Self::Text(Rc::from(text))
    }

    pub(super) fn list(values: Vec<Self>) -> Self {
        Self::List(Rc::new(values))
    }

    pub(super) fn map(entries: Vec<(Self, Self)>) -> Self {
        Self::Map(Rc::new(entries))
    }

    /// The value of the text of a property or parameter: quoted text without its quotes, a number, `true` or `false`, or
    /// otherwise the text.
    pub(super) fn literal(text: &str) -> Self {
        if let Some(inner) = text.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')) {
            return Self::text(inner);
        }
        // Python would read 1_000 as a number; in names such as 1_2 the underscore is a letter.
        let number = if text.contains('_') { None } else { number_of(text) };
        match (number, text) {
            (Some(number), _) => number.into(),
            (None, "true" | "True") => Self::Bool(true),
            (None, "false" | "False") => Self::Bool(false),
            (None, _) => Self::text(text),
        }
    }

    /// The kind of value in words, for messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Bool(_) => "a truth value",
            Self::Integer(_) | Self::Float(_) => "a number",
            Self::Text(_) => "text",
            Self::List(_) => "a list",
            Self::Map(_) => "a dictionary",
            Self::Function(_) => "a function",
            Self::Module | Self::Namespace(_) => "a namespace",
        }
    }

    /// The number; truth values count as 0 and 1.
    pub(super) fn number(&self) -> Option<Number> {
        match self {
            Self::Bool(value) => Some(Number::Integer(i64::from(*value))),
            Self::Integer(value) => Some(Number::Integer(*value)),
            Self::Float(value) => Some(Number::Float(*value)),
            Self::None
            | Self::Text(_)
            | Self::List(_)
            | Self::Map(_)
            | Self::Function(_)
            | Self::Module
            | Self::Namespace(_) => None,
        }
    }

    /// Whether it counts as true.
    pub(super) fn is_true(&self) -> bool {
        match self {
            Self::None => false,
            Self::Bool(value) => *value,
            Self::Integer(value) => *value != 0,
            Self::Float(value) => *value != 0.0,
            Self::Text(text) => !text.is_empty(),
            Self::List(values) => !values.is_empty(),
            Self::Map(entries) => !entries.is_empty(),
            Self::Function(_) | Self::Module | Self::Namespace(_) => true,
        }
    }

    pub(super) fn equals(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::None, Self::None) => true,
            (Self::Text(a), Self::Text(b)) => a == b,
            (Self::List(a), Self::List(b)) => a.len() == b.len() && a.iter().zip(b.iter()).all(|(a, b)| a.equals(b)),
            (Self::Map(a), Self::Map(b)) => {
                a.len() == b.len()
                    && a.iter().all(|(key, value)| other.get(key).is_some_and(|found| found.equals(value)))
            }
            (a, b) => a.order(b) == Some(Ordering::Equal),
        }
    }

    /// The order of two numbers, two texts or two lists.
    pub(super) fn order(&self, other: &Self) -> Option<Ordering> {
        match (self, other) {
            (Self::Text(a), Self::Text(b)) => Some(a.cmp(b)),
            (Self::List(a), Self::List(b)) => {
                let differs = a.iter().zip(b.iter()).find(|(a, b)| !a.equals(b));
                differs.map_or(Some(a.len().cmp(&b.len())), |(a, b)| a.order(b))
            }
            (a, b) => match (a.number()?, b.number()?) {
                (Number::Integer(a), Number::Integer(b)) => Some(a.cmp(&b)),
                (a, b) => a.float().partial_cmp(&b.float()),
            },
        }
    }

    /// The value of a key of a dictionary.
    pub(super) fn get(&self, key: &Self) -> Option<&Self> {
        let Self::Map(entries) = self else { return None };
        entries.iter().rev().find(|(known, _)| known.equals(key)).map(|(_, value)| value)
    }

    /// As Python's `str` writes it.
    pub(super) fn to_text(&self) -> String {
        match self {
            Self::None => "None".to_owned(),
            Self::Bool(true) => "True".to_owned(),
            Self::Bool(false) => "False".to_owned(),
            Self::Integer(value) => value.to_string(),
            Self::Float(value) => float_text(*value),
            Self::Text(text) => text.to_string(),
            Self::List(values) => {
                format!("[{}]", values.iter().map(Self::to_quoted_text).collect::<Vec<_>>().join(", "))
            }
            Self::Map(entries) => {
                let entry =
                    |(key, value): &(Self, Self)| format!("{}: {}", key.to_quoted_text(), value.to_quoted_text());
                format!("{{{}}}", entries.iter().map(entry).collect::<Vec<_>>().join(", "))
            }
            Self::Function(name) => format!("<function {name}>"),
            Self::Module | Self::Namespace(_) => "<namespace>".to_owned(),
        }
    }

    fn to_quoted_text(&self) -> String {
        let Self::Text(text) = self else { return self.to_text() };
        format!("'{}'", text.replace('\\', "\\\\").replace('\'', "\\'"))
    }

    /// Number of values in it and in what it holds, or bytes of text.
    pub(super) fn size(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::List(values) => values.iter().map(|value| value.size() + 1).sum(),
            Self::Map(entries) => entries.iter().map(|(key, value)| key.size() + value.size() + 1).sum(),
            Self::None
            | Self::Bool(_)
            | Self::Integer(_)
            | Self::Float(_)
            | Self::Function(_)
            | Self::Module
            | Self::Namespace(_) => 1,
        }
    }
}

/// The number that a text is.
pub(super) fn number_of(text: &str) -> Option<Number> {
    let text = text.trim();
    let integer = text.parse().ok().map(Number::Integer);
    integer.or_else(|| text.parse().ok().map(Number::Float))
}

/// The shortest decimals that are the number again, with exponent as in Python.
fn float_text(value: f64) -> String {
    let scientific = format!("{value:e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else {
        return scientific.to_lowercase();
    };
    let exponent: i32 = exponent.parse().unwrap_or_default();
    if PLAIN.contains(&exponent) {
        return format!("{value:?}");
    }
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{mantissa}e{sign}{:02}", exponent.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Written by Python 3.11: `print(x)`.
    #[test]
    fn numbers_are_written_as_python_writes_them() {
        let written = [
            (0.1 + 0.2, "0.30000000000000004"),
            (1.0, "1.0"),
            (-0.0, "-0.0"),
            (1e-4, "0.0001"),
            (1e-5, "1e-05"),
            (1.5e-7, "1.5e-07"),
            (1e15, "1000000000000000.0"),
            (1e16, "1e+16"),
            (1.25e100, "1.25e+100"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "nan"),
        ];
        written.iter().for_each(|(value, text)| assert_eq!(Value::Float(*value).to_text(), *text));
    }

    #[test]
    fn texts_of_properties_are_numbers_truth_values_or_texts() {
        let of = |text: &str| Value::literal(text).to_text();
        assert_eq!([of("12"), of("1e3"), of("true"), of("False")], ["12", "1000.0", "True", "False"]);
        assert_eq!([of("'12'"), of("1_0"), of("arm"), of("''")], ["12", "1_0", "arm", ""]);
        assert!(matches!(Value::literal("'12'"), Value::Text(_)));
    }
}
