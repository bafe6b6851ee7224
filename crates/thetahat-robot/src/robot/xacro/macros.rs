//! Macros and the text of their parameters.

use super::tree::Node;

/// A macro.
#[derive(Debug, Clone)]
pub(super) struct Macro {
    pub(super) name: String,
    pub(super) parameters: Vec<Parameter>,
    pub(super) body: Vec<Node>,
}

/// A parameter of a macro; `*name` is a block, `**name` the content of one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Parameter {
    pub(super) name: String,
    pub(super) default: Option<Default>,
}

/// What a parameter is if the call does not give it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Default {
    /// Whether it is the caller's property of the same name, if there is one.
    pub(super) forwarded: bool,
    /// The text of its value.
    pub(super) text: Option<String>,
}

impl Parameter {
    /// The name of a block and whether the element itself is inserted.
    pub(super) fn block(&self) -> Option<(&str, bool)> {
        let name = self.name.strip_prefix('*')?;
        Some(name.strip_prefix('*').map_or((name, true), |name| (name, false)))
    }
}

/// The parameters of a text such as `parent prefix:='' mass:=^|1 *origin`.
pub(super) fn parameters(text: &str) -> Vec<Parameter> {
    let mut parameters = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let end = rest.find(|c: char| c.is_whitespace() || matches!(c, ':' | '=')).unwrap_or(rest.len());
        let (name, after) = rest.split_at(end);
        let trimmed = after.trim_start();
        match trimmed.strip_prefix(":=").or_else(|| trimmed.strip_prefix('=')) {
            Some(value) => {
                let (default, after) = default(value.trim_start());
                parameters.push(Parameter { name: name.to_owned(), default: Some(default) });
                rest = after.trim_start();
            }
            None => {
                // A letter that separates nothing is skipped, so that the loop ends.
                let skipped = usize::from(name.is_empty()) * after.chars().next().map_or(0, char::len_utf8);
                if !name.is_empty() {
                    parameters.push(Parameter { name: name.to_owned(), default: None });
                }
                rest = after[skipped..].trim_start();
            }
        }
    }
    parameters
}

/// A default at the beginning of a text, and what follows it.
fn default(text: &str) -> (Default, &str) {
    let forwarded = text.starts_with('^');
    let value = text.strip_prefix("^|").or_else(|| text.strip_prefix('^')).unwrap_or(text);
    let length = value_length(value);
    let text = (length > 0).then(|| value[..length].to_owned());
    (Default { forwarded, text }, &value[length..])
}

/// The length of a value: up to a blank outside of quotes, `${...}` and `$(...)`.
fn value_length(text: &str) -> usize {
    let mut closing: Option<char> = None;
    let mut before = ' ';
    for (place, letter) in text.char_indices() {
        match closing {
            Some(end) if letter == end => closing = None,
            Some(_) => {}
            None if letter.is_whitespace() => return place,
            None => closing = closing_of(before, letter),
        }
        before = letter;
    }
    text.len()
}

fn closing_of(before: char, letter: char) -> Option<char> {
    match (before, letter) {
        ('$', '{') => Some('}'),
        ('$', '(') => Some(')'),
        (_, '\'' | '"') => Some(letter),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_have_defaults_of_many_forms() {
        let given = "parent  a:=1 b:='two words' c = ${x + 1} d:=^ e:=^|$(arg k) *origin **rest f:=''";
        let text = |text: &str| Some(Default { forwarded: false, text: Some(text.to_owned()) });
        let forwarded = |text: Option<&str>| Some(Default { forwarded: true, text: text.map(str::to_owned) });
        let expected = [
            ("parent", None),
            ("a", text("1")),
            ("b", text("'two words'")),
            ("c", text("${x + 1}")),
            ("d", forwarded(None)),
            ("e", forwarded(Some("$(arg k)"))),
            ("*origin", None),
            ("**rest", None),
            ("f", text("''")),
        ];
        assert_eq!(parameters(given), expected.map(|(name, default)| Parameter { name: name.to_owned(), default }));
        assert_eq!(parameters(" : x").len(), 1);
    }
}
