//! The tree of an expression.

use super::{
    ExpressionError,
    tokens::{Token, Word, words},
    value::Value,
};

/// Most parentheses, operators and so on in one another.
const DEEPEST: usize = 60;
/// Most words of an expression: each operator of a long sum is a level of its tree.
const MOST_WORDS: usize = 500;

/// An expression.
#[derive(Debug, Clone)]
pub(super) enum Expression {
    Literal(Value),
    Name(String),
    List(Vec<Expression>),
    Map(Vec<(Expression, Expression)>),
    Negative(Box<Expression>),
    Not(Box<Expression>),
    Binary {
        operator: Binary,
        left: Box<Expression>,
        right: Box<Expression>,
    },
    /// `and` if true, otherwise `or`.
    Logical {
        both: bool,
        left: Box<Expression>,
        right: Box<Expression>,
    },
    /// `a < b < c`: the first value, and each comparison with its right side.
    Comparison {
        first: Box<Expression>,
        others: Vec<(Comparison, Expression)>,
    },
    Conditional {
        condition: Box<Expression>,
        then: Box<Expression>,
        otherwise: Box<Expression>,
    },
    Call {
        function: Box<Expression>,
        arguments: Vec<Expression>,
        named: Vec<(String, Expression)>,
    },
    Attribute {
        of: Box<Expression>,
        name: String,
    },
    Index {
        of: Box<Expression>,
        index: Box<Expression>,
    },
    Slice {
        of: Box<Expression>,
        from: Option<Box<Expression>>,
        to: Option<Box<Expression>>,
    },
}

/// An operator of two values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    FloorDivide,
    Remainder,
    Power,
}

impl Binary {
    pub(super) fn sign(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::FloorDivide => "//",
            Self::Remainder => "%",
            Self::Power => "**",
        }
    }
}

/// A comparison of two values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Comparison {
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    In,
    NotIn,
    Is,
    IsNot,
}

/// The tree of an expression's text.
pub(super) fn parse(text: &str) -> Result<Expression, ExpressionError> {
    let words = words(text)?;
    if words.len() > MOST_WORDS {
        return Err(ExpressionError::TooLarge { what: "words in one expression", limit: MOST_WORDS });
    }
    let mut parser = Parser { words, next: 0, depth: 0 };
    let expression = parser.expression()?;
    parser.require_end()?;
    Ok(expression)
}

struct Parser {
    words: Vec<Word>,
    next: usize,
    depth: usize,
}

type Parsed = Result<Expression, ExpressionError>;

impl Parser {
    /// A whole expression: `a if b else c`, or less.
    fn expression(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(ExpressionError::TooLarge { what: "levels of nesting in one expression", limit: DEEPEST });
        }
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
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(ExpressionError::TooLarge { what: "levels of nesting in one expression", limit: DEEPEST });
        }
        let exponent = self.signed()?;
        self.depth -= 1;
        Ok(binary(Binary::Power, base, exponent))
    }

    /// A value with the calls, attributes and indices that follow it.
    fn operand(&mut self) -> Parsed {
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

    fn peek(&self, ahead: usize) -> Token {
        self.words.get(self.next + ahead).map_or(Token::End, |word| word.token.clone())
    }

    fn takes(&mut self, operator: &str) -> bool {
        let found = matches!(self.peek(0), Token::Operator(found) if found == operator);
        self.next += usize::from(found);
        found
    }

    fn takes_name(&mut self, name: &str) -> bool {
        let found = matches!(self.peek(0), Token::Name(found) if found == name);
        self.next += usize::from(found);
        found
    }

    fn operator(&mut self, of: &[Binary]) -> Option<Binary> {
        of.iter().copied().find(|operator| self.takes(operator.sign()))
    }

    fn name(&mut self) -> Result<String, ExpressionError> {
        let Token::Name(name) = self.peek(0) else { return Err(self.unexpected("a name")) };
        self.next += 1;
        Ok(name)
    }

    fn require(&mut self, operator: &str, expected: &'static str) -> Result<(), ExpressionError> {
        if self.takes(operator) { Ok(()) } else { Err(self.unexpected(expected)) }
    }

    /// A comma, or the end, which is left.
    fn require_separator(&mut self, end: &str) -> Result<(), ExpressionError> {
        let is_end = matches!(self.peek(0), Token::Operator(found) if found == end);
        if is_end || self.takes(",") { Ok(()) } else { Err(self.unexpected("a comma or the closing bracket")) }
    }

    fn require_end(&mut self) -> Result<(), ExpressionError> {
        if matches!(self.peek(0), Token::End) { Ok(()) } else { Err(self.unexpected("an operator or the end")) }
    }

    fn unexpected(&self, expected: &'static str) -> ExpressionError {
        let word = &self.words[self.next.min(self.words.len() - 1)];
        ExpressionError::Syntax { column: word.column, expected, found: word.shown() }
    }
}

fn binary(operator: Binary, left: Expression, right: Expression) -> Expression {
    Expression::Binary { operator, left: Box::new(left), right: Box::new(right) }
}

fn is_reserved(name: &str) -> bool {
    matches!(name, "if" | "else" | "and" | "or" | "not" | "in" | "is" | "for" | "lambda" | "import" | "while")
}
