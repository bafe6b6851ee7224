//! Values of expressions.

use super::{
    ExpressionError,
    folders::relative_to,
    functions,
    methods::{entry, method, slice},
    operators::{binary, bounded, compare, negative},
    parser::parse,
    scope::GLOBAL,
    state::Expander,
    syntax::{Comparison, Expression},
    value::Value,
    yaml, yaml_scalars,
};

pub(super) type Evaluated = Result<Value, ExpressionError>;

impl Expander {
    /// The value of an expression.
    pub(super) fn evaluate(&mut self, expression: &Expression, scope: usize) -> Evaluated {
        self.enter_expression()?;
        let value = self.value_of(expression, scope);
        self.leave();
        value
    }

    fn value_of(&mut self, expression: &Expression, scope: usize) -> Evaluated {
        self.spend(0)?;
        match expression {
            Expression::Literal(value) => Ok(value.clone()),
            Expression::Name(name) => self.name(name, scope),
            Expression::List(items) => self.list(items, scope),
            Expression::Map(entries) => self.map(entries, scope),
            Expression::Negative(of) => negative(&self.evaluate(of, scope)?),
            Expression::Not(of) => Ok(Value::Bool(!self.evaluate(of, scope)?.is_true())),
            Expression::Binary { operator, left, right } => {
                let (left, right) = (self.evaluate(left, scope)?, self.evaluate(right, scope)?);
                let value = binary(*operator, &left, &right)?;
                self.counted(value)
            }
            Expression::Logical { both, left, right } => {
                let left = self.evaluate(left, scope)?;
                if left.is_true() == *both { self.evaluate(right, scope) } else { Ok(left) }
            }
            Expression::Comparison { first, others } => self.comparison(first, others, scope),
            Expression::Conditional { condition, then, otherwise } => {
                let holds = self.evaluate(condition, scope)?.is_true();
                self.evaluate(if holds { then } else { otherwise }, scope)
            }
            Expression::Call { function, arguments, named } => self.call(function, arguments, named, scope),
            Expression::Attribute { of, name } => self.attribute(of, name, scope),
            Expression::Index { of, index } => {
                let (of, index) = (self.evaluate(of, scope)?, self.evaluate(index, scope)?);
                self.spend(of.size())?;
                entry(&of, &index)
            }
            Expression::Slice { of, from, to } => self.slice(of, from.as_deref(), to.as_deref(), scope),
        }
    }

    /// A value whose size counts as work.
    fn counted(&mut self, value: Value) -> Evaluated {
        self.spend(value.size())?;
        Ok(value)
    }

    fn name(&mut self, name: &str, scope: usize) -> Evaluated {
        if let Some(value) = self.property(scope, name)? {
            return Ok(value);
        }
        let namespace = self.scopes.namespace(scope, name).map(Value::Namespace);
        let unknown = || ExpressionError::UnknownName { name: name.to_owned() };
        namespace.or_else(|| functions::global(name)).ok_or_else(unknown)
    }

    fn values(&mut self, expressions: &[Expression], scope: usize) -> Result<Vec<Value>, ExpressionError> {
        expressions.iter().map(|expression| self.evaluate(expression, scope)).collect()
    }

    fn list(&mut self, items: &[Expression], scope: usize) -> Evaluated {
        let values = self.values(items, scope)?;
        self.counted(bounded(Value::list(values))?)
    }

    fn map(&mut self, entries: &[(Expression, Expression)], scope: usize) -> Evaluated {
        let entry =
            |(key, value): &(Expression, Expression)| Ok((self.evaluate(key, scope)?, self.evaluate(value, scope)?));
        let entries = entries.iter().map(entry).collect::<Result<Vec<_>, ExpressionError>>()?;
        self.counted(bounded(Value::map(entries))?)
    }

    /// `a < b < c` is true if each comparison is.
    fn comparison(&mut self, first: &Expression, others: &[(Comparison, Expression)], scope: usize) -> Evaluated {
        let mut left = self.evaluate(first, scope)?;
        for (comparison, right) in others {
            let right = self.evaluate(right, scope)?;
            self.spend(left.size() + right.size())?;
            if !compare(*comparison, &left, &right)? {
                return Ok(Value::Bool(false));
            }
            left = right;
        }
        Ok(Value::Bool(true))
    }

    fn slice(
        &mut self,
        of: &Expression,
        from: Option<&Expression>,
        to: Option<&Expression>,
        scope: usize,
    ) -> Evaluated {
        let of = self.evaluate(of, scope)?;
        let from = from.map(|from| self.evaluate(from, scope)).transpose()?;
        let to = to.map(|to| self.evaluate(to, scope)).transpose()?;
        self.spend(of.size())?;
        slice(&of, from.as_ref(), to.as_ref())
    }

    /// `math.pi`, `namespace.property`, or the entry of a dictionary.
    fn attribute(&mut self, of: &Expression, name: &str, scope: usize) -> Evaluated {
        let of = self.evaluate(of, scope)?;
        let unknown = || ExpressionError::UnknownName { name: name.to_owned() };
        match &of {
            Value::Module => functions::global(name).ok_or_else(unknown),
            Value::Namespace(inner) => match self.property(*inner, name)? {
                Some(value) => Ok(value),
                None => self.scopes.namespace(*inner, name).map(Value::Namespace).ok_or_else(unknown),
            },
            Value::None
            | Value::Bool(_)
            | Value::Integer(_)
            | Value::Float(_)
            | Value::Text(_)
            | Value::List(_)
            | Value::Map(_)
            | Value::Function(_) => {
                self.spend(of.size())?;
                let missing = || ExpressionError::NoEntry { of: of.kind(), key: name.to_owned() };
                of.get(&Value::text(name)).cloned().ok_or_else(missing)
            }
        }
    }

    fn call(
        &mut self,
        function: &Expression,
        arguments: &[Expression],
        named: &[(String, Expression)],
        scope: usize,
    ) -> Evaluated {
        let values = self.values(arguments, scope)?;
        if let Expression::Attribute { of, name } = function {
            let object = self.evaluate(of, scope)?;
            if !matches!(object, Value::Module | Value::Namespace(_)) {
                self.spend(object.size())?;
                let value = method(&object, name, &values)?;
                return self.counted(value);
            }
        }
        let value = |(name, value): &(String, Expression)| Ok((name.clone(), self.evaluate(value, scope)?));
        let named = named.iter().map(value).collect::<Result<Vec<_>, ExpressionError>>()?;
        let called = self.evaluate(function, scope)?;
        let Value::Function(name) = called else {
            return Err(ExpressionError::NotAFunction { found: called.kind(), name: None });
        };
        self.spend(values.iter().map(Value::size).sum())?;
        let value = match functions::call(name, &values, &named)? {
            Some(value) => value,
            None => self.call_of_xacro(name, &values)?,
        };
        self.counted(value)
    }

    /// The functions that read files or arguments, or print.
    fn call_of_xacro(&mut self, name: &'static str, arguments: &[Value]) -> Evaluated {
        let text = || arguments.iter().map(Value::to_text).collect::<Vec<_>>().join(" ");
        match name {
            "load_yaml" => self.load_yaml(&text()),
            "arg" => self.argument(&text()).map(|value| Value::text(&value)),
            "fatal" => Err(ExpressionError::Fatal { message: text() }),
            _ => Ok(Value::text("")),
        }
    }

    fn load_yaml(&mut self, name: &str) -> Evaluated {
        let path = relative_to(self.file(), name);
        let text = self.read(&path).map_err(|error| {
            let (path, reason) = (path.clone(), error.to_string());
            ExpressionError::File { path, reason }
        })?;
        let mut number = |text: &str| {
            let expression = parse(text).ok()?;
            Some(self.evaluate(&expression, GLOBAL).ok()?.number()?.float())
        };
        let read = yaml::parse(&text, &mut number);
        let value =
            read.map_err(|yaml_scalars::Problem { line, problem }| ExpressionError::Yaml { path, line, problem })?;
        self.counted(bounded(value)?)
    }
}
