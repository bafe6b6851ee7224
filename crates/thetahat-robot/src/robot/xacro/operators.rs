//! Operators of expressions, with Python's numbers.

use std::cmp::Ordering;

use super::{
    ExpressionError,
    formats::percent,
    syntax::{Binary, Comparison},
    value::{Number, Value},
};

/// Most bytes of a text, or values of a list.
pub(super) const LARGEST_VALUE: usize = 1 << 20;

/// A value that is not larger than any robot needs.
pub(super) fn bounded(value: Value) -> Result<Value, ExpressionError> {
    if value.size() <= LARGEST_VALUE {
        return Ok(value);
    }
    Err(ExpressionError::TooLarge { what: "letters or entries in one value", limit: LARGEST_VALUE })
}

pub(super) fn binary(operator: Binary, left: &Value, right: &Value) -> Result<Value, ExpressionError> {
    let refused = || ExpressionError::Operands { operator: operator.sign(), left: left.kind(), right: right.kind() };
    if let Some((a, b)) = left.number().zip(right.number()) {
        return arithmetic(operator, a, b).map(Value::from);
    }
    match (operator, left, right) {
        (Binary::Add, Value::Text(a), Value::Text(b)) => bounded(Value::text(&format!("{a}{b}"))),
        (Binary::Add, Value::List(a), Value::List(b)) => {
            bounded(Value::list(a.iter().chain(b.iter()).cloned().collect()))
        }
        (Binary::Multiply, Value::Text(_) | Value::List(_), Value::Integer(count)) => repeated(left, *count),
        (Binary::Multiply, Value::Integer(count), Value::Text(_) | Value::List(_)) => repeated(right, *count),
        (Binary::Remainder, Value::Text(text), values) => percent(text, values).and_then(bounded),
        _ => Err(refused()),
    }
}

fn repeated(value: &Value, count: i64) -> Result<Value, ExpressionError> {
    let count = usize::try_from(count).unwrap_or(0);
    if value.size().max(1).checked_mul(count).is_none_or(|size| size > LARGEST_VALUE) {
        return Err(ExpressionError::TooLarge { what: "letters or entries in one value", limit: LARGEST_VALUE });
    }
    if let Value::Text(text) = value {
        return Ok(Value::text(&text.repeat(count)));
    }
    let Value::List(values) = value else { return Ok(value.clone()) };
    Ok(Value::list(values.iter().cycle().take(values.len() * count).cloned().collect()))
}

fn arithmetic(operator: Binary, a: Number, b: Number) -> Result<Number, ExpressionError> {
    let no_number = || ExpressionError::NoNumber { operation: operation(operator) };
    let found = match (a, b) {
        (Number::Integer(a), Number::Integer(b)) => of_integers(operator, a, b).ok_or_else(no_number)?,
        (a, b) => Number::Float(of_floats(operator, a.float(), b.float()).ok_or_else(no_number)?),
    };
    Ok(found)
}

fn operation(operator: Binary) -> &'static str {
    match operator {
        Binary::Add | Binary::Subtract | Binary::Multiply => "an operation on integers beyond 64 bits",
        Binary::Divide | Binary::FloorDivide | Binary::Remainder => "a division by zero",
        Binary::Power => "this power",
    }
}

fn of_integers(operator: Binary, a: i64, b: i64) -> Option<Number> {
    let floor = |a: i64, b: i64| {
        let quotient = a.checked_div(b)?;
        Some(if a % b != 0 && (a < 0) != (b < 0) { quotient - 1 } else { quotient })
    };
    let integer = match operator {
        Binary::Add => a.checked_add(b),
        Binary::Subtract => a.checked_sub(b),
        Binary::Multiply => a.checked_mul(b),
        Binary::Divide => return (b != 0).then(|| Number::Float(a as f64 / b as f64)),
        Binary::FloorDivide => floor(a, b),
        Binary::Remainder => floor(a, b).map(|quotient| a - b * quotient),
        Binary::Power => match u32::try_from(b) {
            Ok(exponent) => a.checked_pow(exponent),
            Err(_) => return of_floats(operator, a as f64, b as f64).map(Number::Float),
        },
    };
    integer.map(Number::Integer)
}

fn of_floats(operator: Binary, a: f64, b: f64) -> Option<f64> {
    let divided = |value: f64| (b != 0.0).then_some(value);
    match operator {
        Binary::Add => Some(a + b),
        Binary::Subtract => Some(a - b),
        Binary::Multiply => Some(a * b),
        Binary::Divide => divided(a / b),
        Binary::FloorDivide => divided((a / b).floor()),
        Binary::Remainder => divided(if b.is_infinite() { a } else { a - b * (a / b).floor() }),
        Binary::Power => Some(a.powf(b)).filter(|power| power.is_finite() || !(a.is_finite() && b.is_finite())),
    }
}

pub(super) fn negative(value: &Value) -> Result<Value, ExpressionError> {
    binary(Binary::Subtract, &Value::Integer(0), value).map(|found| match (value, found) {
        // 0 - 0.0 is 0.0, but its negative is -0.0.
        (Value::Float(value), _) => Value::Float(-value),
        (_, found) => found,
    })
}

pub(super) fn compare(comparison: Comparison, left: &Value, right: &Value) -> Result<bool, ExpressionError> {
    let ordered = |is: fn(Ordering) -> bool, operator| match (left.order(right), left.number().zip(right.number())) {
        (Some(order), _) => Ok(is(order)),
        // Not a number.
        (None, Some(_)) => Ok(false),
        (None, None) => Err(ExpressionError::Operands { operator, left: left.kind(), right: right.kind() }),
    };
    match comparison {
        Comparison::Equal | Comparison::Is => Ok(left.equals(right)),
        Comparison::NotEqual | Comparison::IsNot => Ok(!left.equals(right)),
        Comparison::Less => ordered(Ordering::is_lt, "<"),
        Comparison::LessOrEqual => ordered(Ordering::is_le, "<="),
        Comparison::Greater => ordered(Ordering::is_gt, ">"),
        Comparison::GreaterOrEqual => ordered(Ordering::is_ge, ">="),
        Comparison::In => contains(right, left),
        Comparison::NotIn => contains(right, left).map(|found| !found),
    }
}

fn contains(whole: &Value, part: &Value) -> Result<bool, ExpressionError> {
    match (whole, part) {
        (Value::Text(whole), Value::Text(part)) => Ok(whole.contains(&**part)),
        (Value::List(values), part) => Ok(values.iter().any(|value| value.equals(part))),
        (Value::Map(_), key) => Ok(whole.get(key).is_some()),
        (whole, part) => Err(ExpressionError::Operands { operator: "in", left: part.kind(), right: whole.kind() }),
    }
}
