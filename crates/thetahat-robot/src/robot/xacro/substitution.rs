//! Texts with `${expression}` and `$(command)`.

use std::rc::Rc;

use super::{
    ExpressionError, evaluation::Evaluated, folders::folder_of, parser::parse, scope::Property, state::Expander,
    value::Value,
};

/// A piece of a text.
#[derive(Debug, PartialEq)]
enum Piece<'t> {
    Text(&'t str),
    Expression(&'t str),
    Command(&'t str),
}

impl Expander {
    /// The value of a text: that of its expression if it is nothing else, otherwise text.
    pub(super) fn text_value(&mut self, text: &str, scope: usize) -> Evaluated {
        self.spend(text.len())?;
        if !text.contains('$') {
            return Ok(Value::text(text));
        }
        self.enter_expression()?;
        let value = self.value_of_pieces(text, scope);
        self.leave();
        value
    }

    fn value_of_pieces(&mut self, text: &str, scope: usize) -> Evaluated {
        let mut values = Vec::new();
        for piece in pieces(text)? {
            values.push(match piece {
                Piece::Text(text) => Value::text(text),
                Piece::Expression(text) => self.expression_value(text, scope)?,
                Piece::Command(text) => self.command_value(text, scope)?,
            });
        }
        if let [only] = &values[..] {
            return Ok(only.clone());
        }
        let joined: String = values.iter().map(Value::to_text).collect();
        self.spend(joined.len())?;
        super::operators::bounded(Value::text(&joined))
    }

    /// An expression may hold commands, such as `${$(arg length) / 2}`.
    fn expression_value(&mut self, text: &str, scope: usize) -> Evaluated {
        let text = if text.contains('$') { self.text_value(text, scope)?.to_text() } else { text.to_owned() };
        let expression = parse(&text)?;
        self.evaluate(&expression, scope)
    }

    fn command_value(&mut self, text: &str, scope: usize) -> Evaluated {
        let text = if text.contains('$') { self.text_value(text, scope)?.to_text() } else { text.to_owned() };
        let words: Vec<&str> = text.split_whitespace().collect();
        let value = match words[..] {
            ["arg", name] => self.argument(name)?,
            ["find", name] => {
                let unknown = || ExpressionError::UnknownPackage { name: name.to_owned() };
                self.folders.package(name).ok_or_else(unknown)?.display().to_string()
            }
            ["optenv", _, ref default @ ..] if !default.is_empty() => default.join(" "),
            ["env" | "optenv", ..] => return Err(ExpressionError::Environment { command: text }),
            ["dirname"] => folder_of(self.file()).display().to_string(),
            _ => return Err(ExpressionError::UnknownCommand { command: text }),
        };
        Ok(Value::text(&value))
    }

    /// The value of an argument.
    pub(super) fn argument(&self, name: &str) -> Result<String, ExpressionError> {
        let unknown = || ExpressionError::UnknownArgument { name: name.to_owned() };
        self.arguments.get(name).cloned().ok_or_else(unknown)
    }

    /// The value of a property, evaluated where it was defined when it is first used; none if there is no such property.
    pub(super) fn property(&mut self, scope: usize, name: &str) -> Result<Option<Value>, ExpressionError> {
        let Some(owner) = self.scopes.owner(scope, name) else { return Ok(None) };
        let text = match self.scopes.property(owner, name) {
            None => return Ok(None),
            Some(Property::Known(value)) => return Ok(Some(value.clone())),
            Some(Property::InEvaluation) => return Err(ExpressionError::Circular { name: name.to_owned() }),
            Some(Property::Text(text)) => Rc::clone(text),
        };
        self.scopes.set(owner, name, Property::InEvaluation);
        let value = literal(self.text_value(&text, owner)?);
        self.scopes.set(owner, name, Property::Known(value.clone()));
        Ok(Some(value))
    }
}

/// The value that a text stands for; other values stay.
pub(super) fn literal(value: Value) -> Value {
    if let Value::Text(text) = &value { Value::literal(text) } else { value }
}

/// The pieces of a text. `$${` and `$$(` are the letters `${` and `$(`.
fn pieces(text: &str) -> Result<Vec<Piece<'_>>, ExpressionError> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let (piece, length) = if let Some(inner) = rest.strip_prefix("${") {
            let end = inner.find('}').ok_or(ExpressionError::Open { open: "${" })?;
            (Piece::Expression(&inner[..end]), end + 3)
        } else if let Some(inner) = rest.strip_prefix("$(") {
            let end = inner.find(')').ok_or(ExpressionError::Open { open: "$(" })?;
            (Piece::Command(&inner[..end]), end + 3)
        } else {
            plain(rest)
        };
        pieces.push(piece);
        rest = &rest[length..];
    }
    Ok(pieces)
}

/// Text up to the next expression or command.
fn plain(text: &str) -> (Piece<'_>, usize) {
    let dollars = text.len() - text.trim_start_matches('$').len();
    if dollars >= 2 && text[dollars..].starts_with(['{', '(']) {
        return (Piece::Text(&text[1..=dollars]), dollars + 1);
    }
    let start = dollars.max(1).min(text.len());
    let start = (start..=text.len()).find(|place| text.is_char_boundary(*place)).unwrap_or(text.len());
    let end = text[start..].find('$').map_or(text.len(), |place| start + place);
    (Piece::Text(&text[..end]), end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_has_expressions_commands_and_letters() {
        let of = |text: &'static str| pieces(text).unwrap();
        assert_eq!(
            of("a${x}b$(arg k)"),
            [Piece::Text("a"), Piece::Expression("x"), Piece::Text("b"), Piece::Command("arg k"),]
        );
        assert_eq!(of("$${x}"), [Piece::Text("${"), Piece::Text("x}")]);
        assert_eq!(of("5 $ ä$"), [Piece::Text("5 "), Piece::Text("$ ä"), Piece::Text("$")]);
        assert_eq!(of("€${x}"), [Piece::Text("€"), Piece::Expression("x")]);
        assert!(matches!(pieces("${x"), Err(ExpressionError::Open { open: "${" })));
        assert!(matches!(pieces("a $(arg"), Err(ExpressionError::Open { open: "$(" })));
    }
}
