//! Values in an expression, with what follows them: calls, attributes and indices.

use super::{
    ExpressionError,
    syntax::Expression,
    tokens::Token,
    value::Value,
    words_reader::{DEEPEST, Parsed, Parser},
};

impl Parser {
    /// A value with the calls, attributes and indices that follow it.
    pub(super) fn operand(&mut self) -> Parsed {
        let mut operand = self.atom()?;
        let mut count = 0;
        loop {
            if self.takes("(") {
                operand = self.call(operand)?;
            } else if self.takes("[") {
                operand = self.index(operand)?;
            } else if self.takes(".") {
                operand = Expression::Attribute { of: Box::new(operand), name: self.name()? };
            } else {
                return Ok(operand);
            }
            count += 1;
            if count > DEEPEST {
                return Err(ExpressionError::TooLarge { what: "calls and indices of one value", limit: DEEPEST });
            }
        }
    }

    fn call(&mut self, function: Expression) -> Parsed {
        let (mut arguments, mut named) = (Vec::new(), Vec::new());
        while !self.takes(")") {
            match (self.peek(0), self.peek(1)) {
                (Token::Name(name), Token::Operator("=")) => {
                    self.next += 2;
                    named.push((name, self.expression()?));
                }
                (Token::Literal(_) | Token::Name(_) | Token::Operator(_) | Token::End, _) => {
                    arguments.push(self.expression()?);
                }
            }
            self.require_separator(")")?;
        }
        Ok(Expression::Call { function: Box::new(function), arguments, named })
    }

    fn index(&mut self, of: Expression) -> Parsed {
        let of = Box::new(of);
        let is_colon = |parser: &Self| matches!(parser.peek(0), Token::Operator(":"));
        let from = if is_colon(self) { None } else { Some(Box::new(self.expression()?)) };
        if !self.takes(":") {
            self.require("]", "`]`")?;
            return match from {
                Some(index) => Ok(Expression::Index { of, index }),
                None => Err(self.unexpected("an index")),
            };
        }
        let is_end = matches!(self.peek(0), Token::Operator("]"));
        let to = if is_end { None } else { Some(Box::new(self.expression()?)) };
        self.require("]", "`]`")?;
        Ok(Expression::Slice { of, from, to })
    }

    fn atom(&mut self) -> Parsed {
        let word = self.words[self.next.min(self.words.len() - 1)].clone();
        self.next += 1;
        match word.token {
            Token::Literal(value) => Ok(self.with_adjacent_text(value)),
            Token::Name(name) if is_reserved(&name) => {
                self.next -= 1;
                Err(self.unexpected("a value"))
            }
            Token::Name(name) => Ok(Expression::Name(name)),
            Token::Operator("(") => self.parenthesis(),
            Token::Operator("[") => Ok(Expression::List(self.items("]")?)),
            Token::Operator("{") => self.map(),
            Token::Operator(_) | Token::End => {
                self.next -= 1;
                Err(self.unexpected("a value"))
            }
        }
    }

    /// Texts that follow each other are one.
    fn with_adjacent_text(&mut self, mut value: Value) -> Expression {
        while let (Value::Text(first), Token::Literal(Value::Text(second))) = (&value, self.peek(0)) {
            value = Value::text(&format!("{first}{second}"));
            self.next += 1;
        }
        Expression::Literal(value)
    }

    fn parenthesis(&mut self) -> Parsed {
        if self.takes(")") {
            return Ok(Expression::List(Vec::new()));
        }
        let first = self.expression()?;
        if self.takes(")") {
            return Ok(first);
        }
        self.require(",", "`)`")?;
        let mut items = vec![first];
        items.extend(self.items(")")?);
        Ok(Expression::List(items))
    }

    fn items(&mut self, end: &'static str) -> Result<Vec<Expression>, ExpressionError> {
        let mut items = Vec::new();
        while !self.takes(end) {
            items.push(self.expression()?);
            if matches!(self.peek(0), Token::Name(name) if name == "for") {
                let remedy = "write the items one by one";
                return Err(ExpressionError::Unsupported { what: "a list made by `for`", remedy });
            }
            self.require_separator(end)?;
        }
        Ok(items)
    }

    fn map(&mut self) -> Parsed {
        let mut entries = Vec::new();
        while !self.takes("}") {
            let key = self.expression()?;
            self.require(":", "`:`")?;
            entries.push((key, self.expression()?));
            self.require_separator("}")?;
        }
        Ok(Expression::Map(entries))
    }
}

fn is_reserved(name: &str) -> bool {
    matches!(name, "if" | "else" | "and" | "or" | "not" | "in" | "is" | "for" | "lambda" | "import" | "while")
}
