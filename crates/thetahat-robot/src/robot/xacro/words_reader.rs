//! Reads the words of an expression one by one.

use super::{
    ExpressionError,
    syntax::{Binary, Expression},
    tokens::{Token, Word},
};

/// Most parentheses, operators and so on in one another.
pub(super) const DEEPEST: usize = 60;

pub(super) type Parsed = Result<Expression, ExpressionError>;

/// The words of an expression, and how far they are read.
pub(super) struct Parser {
    pub(super) words: Vec<Word>,
    pub(super) next: usize,
    pub(super) depth: usize,
}

impl Parser {
    /// Goes one level deeper.
    pub(super) fn enter(&mut self) -> Result<(), ExpressionError> {
        self.depth += 1;
        if self.depth <= DEEPEST {
            return Ok(());
        }
        Err(ExpressionError::TooLarge { what: "levels of nesting in one expression", limit: DEEPEST })
    }

    pub(super) fn peek(&self, ahead: usize) -> Token {
        self.words.get(self.next + ahead).map_or(Token::End, |word| word.token.clone())
    }

    pub(super) fn takes(&mut self, operator: &str) -> bool {
        let found = matches!(self.peek(0), Token::Operator(found) if found == operator);
        self.next += usize::from(found);
        found
    }

    pub(super) fn takes_name(&mut self, name: &str) -> bool {
        let found = matches!(self.peek(0), Token::Name(found) if found == name);
        self.next += usize::from(found);
        found
    }

    pub(super) fn operator(&mut self, of: &[Binary]) -> Option<Binary> {
        of.iter().copied().find(|operator| self.takes(operator.sign()))
    }

    pub(super) fn name(&mut self) -> Result<String, ExpressionError> {
        let Token::Name(name) = self.peek(0) else { return Err(self.unexpected("a name")) };
        self.next += 1;
        Ok(name)
    }

    pub(super) fn require(&mut self, operator: &str, expected: &'static str) -> Result<(), ExpressionError> {
        if self.takes(operator) { Ok(()) } else { Err(self.unexpected(expected)) }
    }

    /// A comma, or the end, which is left.
    pub(super) fn require_separator(&mut self, end: &str) -> Result<(), ExpressionError> {
        let is_end = matches!(self.peek(0), Token::Operator(found) if found == end);
        if is_end || self.takes(",") { Ok(()) } else { Err(self.unexpected("a comma or the closing bracket")) }
    }

    pub(super) fn require_end(&mut self) -> Result<(), ExpressionError> {
        if matches!(self.peek(0), Token::End) { Ok(()) } else { Err(self.unexpected("an operator or the end")) }
    }

    pub(super) fn unexpected(&self, expected: &'static str) -> ExpressionError {
        let word = &self.words[self.next.min(self.words.len() - 1)];
        ExpressionError::Syntax { column: word.column, expected, found: word.shown() }
    }
}
