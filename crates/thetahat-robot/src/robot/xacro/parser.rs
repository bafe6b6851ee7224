//! The levels of an expression, from `if` to powers.

use super::{
    ExpressionError,
    syntax::{Binary, Comparison, Expression},
    tokens::words,
    value::Value,
    words_reader::{Parsed, Parser},
};

/// Longest expression, bytes.
const LONGEST: usize = 20_000;
/// Most words of an expression: each operator of a long sum is a level of its tree.
const MOST_WORDS: usize = 500;

/// The tree of an expression's text.
pub(super) fn parse(text: &str) -> Result<Expression, ExpressionError> {
    if text.len() > LONGEST {
        return Err(ExpressionError::TooLarge { what: "bytes in one expression", limit: LONGEST });
    }
    let words = words(text)?;
    if words.len() > MOST_WORDS {
        return Err(ExpressionError::TooLarge { what: "words in one expression", limit: MOST_WORDS });
    }
    let mut parser = Parser { words, next: 0, depth: 0 };
    let expression = parser.expression()?;
    parser.require_end()?;
    Ok(expression)
}

impl Parser {
    /// A whole expression: `a if b else c`, or less.
    pub(super) fn expression(&mut self) -> Parsed {
        self.enter()?;
        let then = self.or()?;
        let expression = if self.takes_name("if") { self.conditional(then)? } else { then };
        self.depth -= 1;
        Ok(expression)
    }

    fn conditional(&mut self, then: Expression) -> Parsed {
        let condition = Box::new(self.or()?);
        if !self.takes_name("else") {
            return Err(self.unexpected("`else`"));
        }
        let otherwise = Box::new(self.expression()?);
        Ok(Expression::Conditional { condition, then: Box::new(then), otherwise })
    }

    fn or(&mut self) -> Parsed {
        let mut left = self.and()?;
        while self.takes_name("or") {
            left = Expression::Logical { both: false, left: Box::new(left), right: Box::new(self.and()?) };
        }
        Ok(left)
    }

    fn and(&mut self) -> Parsed {
        let mut left = self.not()?;
        while self.takes_name("and") {
            left = Expression::Logical { both: true, left: Box::new(left), right: Box::new(self.not()?) };
        }
        Ok(left)
    }

    fn not(&mut self) -> Parsed {
        let mut count = 0;
        while self.takes_name("not") {
            count += 1;
        }
        let mut expression = self.comparison()?;
        if count > 0 {
            // An even number of negations leaves the truth value.
            expression = Expression::Not(Box::new(expression));
            if count % 2 == 0 {
                expression = Expression::Not(Box::new(expression));
            }
        }
        Ok(expression)
    }

    fn comparison(&mut self) -> Parsed {
        let first = self.sum()?;
        let mut others = Vec::new();
        while let Some(comparison) = self.comparison_sign()? {
            others.push((comparison, self.sum()?));
        }
        Ok(if others.is_empty() { first } else { Expression::Comparison { first: Box::new(first), others } })
    }

    fn comparison_sign(&mut self) -> Result<Option<Comparison>, ExpressionError> {
        let signs = [
            ("==", Comparison::Equal),
            ("!=", Comparison::NotEqual),
            ("<=", Comparison::LessOrEqual),
            (">=", Comparison::GreaterOrEqual),
            ("<", Comparison::Less),
            (">", Comparison::Greater),
        ];
        if let Some((_, comparison)) = signs.into_iter().find(|(sign, _)| self.takes(sign)) {
            return Ok(Some(comparison));
        }
        if self.takes_name("in") {
            return Ok(Some(Comparison::In));
        }
        if self.takes_name("is") {
            return Ok(Some(if self.takes_name("not") { Comparison::IsNot } else { Comparison::Is }));
        }
        if !self.takes_name("not") {
            return Ok(None);
        }
        if self.takes_name("in") { Ok(Some(Comparison::NotIn)) } else { Err(self.unexpected("`in`")) }
    }

    fn sum(&mut self) -> Parsed {
        let mut left = self.product()?;
        while let Some(operator) = self.operator(&[Binary::Add, Binary::Subtract]) {
            left = binary(operator, left, self.product()?);
        }
        Ok(left)
    }

    fn product(&mut self) -> Parsed {
        let mut left = self.signed()?;
        let operators = [Binary::FloorDivide, Binary::Multiply, Binary::Divide, Binary::Remainder];
        while let Some(operator) = self.operator(&operators) {
            left = binary(operator, left, self.signed()?);
        }
        Ok(left)
    }

    fn signed(&mut self) -> Parsed {
        let mut negative = false;
        let mut any = false;
        loop {
            if self.takes("-") {
                negative = !negative;
            } else if !self.takes("+") {
                break;
            }
            any = true;
        }
        let power = self.power()?;
        match (any, negative) {
            (_, true) => Ok(Expression::Negative(Box::new(power))),
            (true, false) => Ok(binary(Binary::Add, Expression::Literal(Value::Integer(0)), power)),
            (false, false) => Ok(power),
        }
    }

    fn power(&mut self) -> Parsed {
        let base = self.operand()?;
        if !self.takes("**") {
            return Ok(base);
        }
        self.enter()?;
        let exponent = self.signed()?;
        self.depth -= 1;
        Ok(binary(Binary::Power, base, exponent))
    }
}

fn binary(operator: Binary, left: Expression, right: Expression) -> Expression {
    Expression::Binary { operator, left: Box::new(left), right: Box::new(right) }
}
