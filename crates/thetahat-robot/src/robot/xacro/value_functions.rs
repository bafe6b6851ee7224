//! Python's functions of lists, texts and numbers.

use super::{
    ExpressionError,
    operators::{LARGEST_VALUE, binary},
    syntax::Binary,
    value::{Number, Value, number_of},
};

pub(super) fn wrong(function: &str, expected: &'static str) -> ExpressionError {
    ExpressionError::Arguments { function: function.to_owned(), expected }
}

/// A number, unless finite arguments have none.
pub(super) fn defined(name: &str, value: f64, arguments: &[Number]) -> Result<Value, ExpressionError> {
    if value.is_finite() || arguments.iter().any(|x| !x.float().is_finite()) {
        return Ok(Value::Float(value));
    }
    Err(wrong(name, "a number at which it has a finite value"))
}

pub(super) fn of_values(
    name: &'static str,
    arguments: &[Value],
    named: &[(String, Value)],
) -> Result<Value, ExpressionError> {
    match (name, arguments) {
        ("min", _) => extreme(name, arguments, std::cmp::Ordering::is_lt),
        ("max", _) => extreme(name, arguments, std::cmp::Ordering::is_gt),
        ("dict", _) => dictionary(arguments, named),
        ("range", _) => range(arguments),
        ("log" | "hypot", _) => of_some_numbers(name, arguments),
        ("round", [value, digits @ ..]) => round(value, digits),
        ("list" | "tuple" | "str" | "float" | "int", []) => empty(name),
        ("sum" | "sorted" | "any" | "all" | "list" | "tuple", [values]) => of_list(name, values),
        ("abs" | "floor" | "ceil" | "trunc", [value]) => of_number(name, value),
        ("int", [value]) => integer(value),
        ("float", [value]) => float(value),
        ("str", [value]) => Ok(Value::text(&value.to_text())),
        ("bool", [value]) => Ok(Value::Bool(value.is_true())),
        ("len", [value]) => length(value),
        _ => Err(wrong(name, "another number of arguments")),
    }
}

fn empty(name: &str) -> Result<Value, ExpressionError> {
    Ok(match name {
        "str" => Value::text(""),
        "int" => Value::Integer(0),
        "float" => Value::Float(0.0),
        _ => Value::list(Vec::new()),
    })
}

/// The values of a list, the keys of a dictionary, or the letters of a text.
pub(super) fn items(value: &Value) -> Option<Vec<Value>> {
    match value {
        Value::List(values) => Some(values.to_vec()),
        Value::Map(entries) => Some(entries.iter().map(|(key, _)| key.clone()).collect()),
        Value::Text(text) => Some(text.chars().map(|c| Value::text(&c.to_string())).collect()),
        Value::None
        | Value::Bool(_)
        | Value::Integer(_)
        | Value::Float(_)
        | Value::Function(_)
        | Value::Module
        | Value::Namespace(_) => None,
    }
}

fn extreme(name: &str, arguments: &[Value], is: fn(std::cmp::Ordering) -> bool) -> Result<Value, ExpressionError> {
    let refused = || wrong(name, "numbers or texts, or one list of them");
    let values = match arguments {
        [only] => items(only).ok_or_else(refused)?,
        several => several.to_vec(),
    };
    let mut values = values.into_iter();
    let mut best = values.next().ok_or_else(refused)?;
    for value in values {
        if is(value.order(&best).ok_or_else(refused)?) {
            best = value;
        }
    }
    Ok(best)
}

fn dictionary(arguments: &[Value], named: &[(String, Value)]) -> Result<Value, ExpressionError> {
    let mut entries = match arguments {
        [] => Vec::new(),
        [Value::Map(entries)] => entries.to_vec(),
        _ => return Err(wrong("dict", "named arguments, or one dictionary")),
    };
    entries.extend(named.iter().map(|(name, value)| (Value::text(name), value.clone())));
    Ok(Value::map(entries))
}

fn range(arguments: &[Value]) -> Result<Value, ExpressionError> {
    let refused = || wrong("range", "one to three integers, the third other than zero");
    let integer = |value: &Value| if let Value::Integer(value) = value { Some(*value) } else { None };
    let given: Option<Vec<i64>> = arguments.iter().map(integer).collect();
    let (start, end, step) = match given.ok_or_else(refused)?[..] {
        [end] => (0, end, 1),
        [start, end] => (start, end, 1),
        [start, end, step] if step != 0 => (start, end, step),
        _ => return Err(refused()),
    };
    let mut values = Vec::new();
    let mut next = start;
    while (step > 0 && next < end) || (step < 0 && next > end) {
        values.push(Value::Integer(next));
        if values.len() > LARGEST_VALUE {
            return Err(ExpressionError::TooLarge { what: "entries in one value", limit: LARGEST_VALUE });
        }
        next = next.checked_add(step).ok_or_else(refused)?;
    }
    Ok(Value::list(values))
}

fn of_some_numbers(name: &'static str, arguments: &[Value]) -> Result<Value, ExpressionError> {
    let refused = || wrong(name, "one or two numbers");
    let given: Option<Vec<Number>> = arguments.iter().map(Value::number).collect();
    let given = given.ok_or_else(refused)?;
    let value = match (name, &given[..]) {
        ("log", [x]) => x.float().ln(),
        ("log", [x, base]) => x.float().ln() / base.float().ln(),
        ("hypot", [x, y]) => x.float().hypot(y.float()),
        _ => return Err(refused()),
    };
    defined(name, value, &given)
}

fn round(value: &Value, digits: &[Value]) -> Result<Value, ExpressionError> {
    let refused = || wrong("round", "a number, and the number of decimals from 0 to 300");
    match (value.number().ok_or_else(refused)?, digits) {
        (Number::Integer(value), []) => Ok(Value::Integer(value)),
        (Number::Float(value), []) => to_integer(value.round_ties_even()),
        (number, [Value::Integer(digits)]) if (0..=300).contains(digits) => match number {
            Number::Integer(value) => Ok(Value::Integer(value)),
            Number::Float(value) => {
                let digits = usize::try_from(*digits).unwrap_or_default();
                format!("{value:.digits$}").parse().map(Value::Float).map_err(|_| refused())
            }
        },
        _ => Err(refused()),
    }
}

fn of_list(name: &str, values: &Value) -> Result<Value, ExpressionError> {
    let items = items(values).ok_or_else(|| wrong(name, "a list"))?;
    match name {
        "sum" => items.iter().try_fold(Value::Integer(0), |total, value| binary(Binary::Add, &total, value)),
        "sorted" => sorted(items),
        "any" => Ok(Value::Bool(items.iter().any(Value::is_true))),
        "all" => Ok(Value::Bool(items.iter().all(Value::is_true))),
        _ => Ok(Value::list(items)),
    }
}

fn sorted(mut items: Vec<Value>) -> Result<Value, ExpressionError> {
    let comparable = items.windows(2).all(|pair| matches!(pair, [a, b] if a.order(b).is_some()));
    if !comparable {
        return Err(wrong("sorted", "a list of numbers, or one of texts"));
    }
    items.sort_by(|a, b| a.order(b).unwrap_or(std::cmp::Ordering::Equal));
    Ok(Value::list(items))
}

fn of_number(name: &str, value: &Value) -> Result<Value, ExpressionError> {
    match (name, value.number().ok_or_else(|| wrong(name, "one number"))?) {
        ("abs", Number::Integer(value)) => {
            value.checked_abs().map(Value::Integer).ok_or_else(|| wrong(name, "an integer of 64 bits"))
        }
        ("abs", Number::Float(value)) => Ok(Value::Float(value.abs())),
        ("floor", Number::Float(value)) => to_integer(value.floor()),
        ("ceil", Number::Float(value)) => to_integer(value.ceil()),
        (_, Number::Float(value)) => to_integer(value.trunc()),
        (_, Number::Integer(value)) => Ok(Value::Integer(value)),
    }
}

fn to_integer(value: f64) -> Result<Value, ExpressionError> {
    const BEYOND: f64 = 9.2e18;
    if value.abs() < BEYOND {
        return Ok(Value::Integer(value as i64));
    }
    Err(ExpressionError::NoNumber { operation: "an integer beyond 64 bits" })
}

fn integer(value: &Value) -> Result<Value, ExpressionError> {
    match (value, value.number()) {
        (Value::Text(text), _) => {
            let found = text.trim().parse().map(Value::Integer);
            found.map_err(|_| wrong("int", "a number, or the digits of one"))
        }
        (_, Some(Number::Integer(value))) => Ok(Value::Integer(value)),
        (_, Some(Number::Float(value))) => to_integer(value.trunc()),
        (_, None) => Err(wrong("int", "a number, or the digits of one")),
    }
}

fn float(value: &Value) -> Result<Value, ExpressionError> {
    let number = if let Value::Text(text) = value { number_of(text) } else { value.number() };
    number.map(|number| Value::Float(number.float())).ok_or_else(|| wrong("float", "a number, or the digits of one"))
}

fn length(value: &Value) -> Result<Value, ExpressionError> {
    let count = items(value).ok_or_else(|| wrong("len", "a list, a dictionary or a text"))?.len();
    Ok(Value::Integer(i64::try_from(count).unwrap_or(i64::MAX)))
}
