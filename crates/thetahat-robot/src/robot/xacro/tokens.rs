//! The words of an expression.

use super::{
    ExpressionError,
    value::{Value, number_of},
};

/// Operators, longer ones first.
const OPERATORS: [&str; 24] = [
    "**", "//", "==", "!=", "<=", ">=", "+", "-", "*", "/", "%", "<", ">", "(", ")", "[", "]", "{", "}", ",", ":", ".",
    "=", "|",
];

/// A word of an expression.
#[derive(Debug, Clone)]
pub(super) enum Token {
    Literal(Value),
    /// A name or a word such as `and`.
    Name(String),
    Operator(&'static str),
    End,
}

/// A word and its column, from one.
#[derive(Debug, Clone)]
pub(super) struct Word {
    pub(super) token: Token,
    pub(super) column: usize,
}

impl Word {
    /// The word for messages.
    pub(super) fn shown(&self) -> String {
        match &self.token {
            Token::Literal(value) => format!("`{}`", value.to_text()),
            Token::Name(name) => format!("`{name}`"),
            Token::Operator(operator) => format!("`{operator}`"),
            Token::End => "the end".to_owned(),
        }
    }
}

/// The words of an expression, and its end.
pub(super) fn words(text: &str) -> Result<Vec<Word>, ExpressionError> {
    let mut words = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let column = text[..text.len() - rest.len()].chars().count() + 1;
        let (token, length) = match first {
            '0'..='9' => number(rest),
            '.' if rest[1..].starts_with(|c: char| c.is_ascii_digit()) => number(rest),
            '"' | '\'' => quoted(rest, first).map(|(text, length)| (Token::Literal(Value::text(&text)), length)),
            _ if first.is_alphabetic() || first == '_' => Some(name(rest)),
            _ => operator(rest),
        }
        .ok_or_else(|| ExpressionError::Syntax {
            column,
            expected: "a number, a quoted text, a name or an operator",
            found: format!("`{}`", rest.chars().take(10).collect::<String>()),
        })?;
        words.push(Word { token, column });
        rest = rest[length..].trim_start();
    }
    words.push(Word { token: Token::End, column: text.chars().count() + 1 });
    Ok(words)
}

fn name(text: &str) -> (Token, usize) {
    let length = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    (Token::Name(text[..length].to_owned()), length)
}

fn operator(text: &str) -> Option<(Token, usize)> {
    let found = OPERATORS.into_iter().find(|operator| text.starts_with(operator))?;
    Some((Token::Operator(found), found.len()))
}

fn number(text: &str) -> Option<(Token, usize)> {
    if let Some(digits) = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        let length = digits.find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(digits.len());
        let value = i64::from_str_radix(&digits[..length], 16).ok()?;
        return Some((Token::Literal(Value::Integer(value)), length + 2));
    }
    let digits = |from: usize| text[from..].find(|c: char| !c.is_ascii_digit()).map_or(text.len(), |n| from + n);
    let mut end = digits(0);
    if text[end..].starts_with('.') {
        end = digits(end + 1);
    }
    let exponent = text[end..].strip_prefix(['e', 'E']).map(|rest| text.len() - rest.len());
    if let Some(start) = exponent.map(|start| start + usize::from(text[start..].starts_with(['+', '-'])))
        && text[start..].starts_with(|c: char| c.is_ascii_digit())
    {
        end = digits(start);
    }
    Some((Token::Literal(number_of(&text[..end])?.into()), end))
}

/// A quoted text and the length of its source.
fn quoted(text: &str, quote: char) -> Option<(String, usize)> {
    let mut value = String::new();
    let mut letters = text.char_indices().skip(1);
    while let Some((place, letter)) = letters.next() {
        match letter {
            _ if letter == quote => return Some((value, place + 1)),
            '\\' => match letters.next()?.1 {
                'n' => value.push('\n'),
                't' => value.push('\t'),
                other @ ('\\' | '\'' | '"') => value.push(other),
                other => value.extend(['\\', other]),
            },
            _ => value.push(letter),
        }
    }
    None
}
