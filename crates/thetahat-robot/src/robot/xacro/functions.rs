//! Functions of expressions that need nothing but their arguments.

use super::{
    ExpressionError,
    operators::bounded,
    value::{Number, Value},
    value_functions::{defined, of_values, wrong},
};

type OfOne = fn(f64) -> f64;
type OfTwo = fn(f64, f64) -> f64;

/// The constants by name.
const CONSTANTS: [(&str, Value); 8] = [
    ("True", Value::Bool(true)),
    ("False", Value::Bool(false)),
    ("None", Value::None),
    ("pi", Value::Float(std::f64::consts::PI)),
    ("e", Value::Float(std::f64::consts::E)),
    ("tau", Value::Float(std::f64::consts::TAU)),
    ("inf", Value::Float(f64::INFINITY)),
    ("nan", Value::Float(f64::NAN)),
];

/// Functions of one number with a number as their value.
const OF_ONE: [(&str, OfOne); 21] = [
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("sinh", f64::sinh),
    ("cosh", f64::cosh),
    ("tanh", f64::tanh),
    ("asinh", f64::asinh),
    ("acosh", f64::acosh),
    ("atanh", f64::atanh),
    ("sqrt", f64::sqrt),
    ("exp", f64::exp),
    ("log2", f64::log2),
    ("log10", f64::log10),
    ("degrees", f64::to_degrees),
    ("radians", f64::to_radians),
    ("fabs", f64::abs),
    ("expm1", f64::exp_m1),
    ("log1p", f64::ln_1p),
];

/// Functions of two numbers.
const OF_TWO: [(&str, OfTwo); 4] =
    [("atan2", f64::atan2), ("pow", f64::powf), ("copysign", f64::copysign), ("fmod", |a, b| a % b)];

/// Functions of values.
const OF_VALUES: [&str; 22] = [
    "abs", "min", "max", "round", "int", "float", "str", "bool", "len", "list", "tuple", "dict", "range", "sum",
    "sorted", "any", "all", "floor", "ceil", "trunc", "log", "hypot",
];

/// Functions of the namespace `xacro`, which read files or arguments.
const OF_XACRO: [&str; 6] = ["load_yaml", "arg", "fatal", "warning", "error", "message"];

/// The value of a name that is not a property.
pub(super) fn global(name: &str) -> Option<Value> {
    if let Some((_, value)) = CONSTANTS.iter().find(|(known, _)| *known == name) {
        return Some(value.clone());
    }
    if matches!(name, "math" | "python" | "xacro") {
        return Some(Value::Module);
    }
    names().find(|known| *known == name).map(Value::Function)
}

/// The names of all functions.
fn names() -> impl Iterator<Item = &'static str> {
    let numeric = OF_ONE.iter().map(|(name, _)| *name).chain(OF_TWO.iter().map(|(name, _)| *name));
    numeric.chain(OF_VALUES).chain(OF_XACRO)
}

/// The value of a function; none if it needs more than its arguments.
pub(super) fn call(
    name: &'static str,
    arguments: &[Value],
    named: &[(String, Value)],
) -> Result<Option<Value>, ExpressionError> {
    if OF_XACRO.contains(&name) {
        return Ok(None);
    }
    if !named.is_empty() && name != "dict" {
        return Err(wrong(name, "no named arguments"));
    }
    if let Some((_, function)) = OF_ONE.iter().find(|(known, _)| *known == name) {
        let [Some(x)] = numbers(arguments)[..] else { return Err(wrong(name, "one number")) };
        return defined(name, function(x.float()), &[x]).map(Some);
    }
    if let Some((_, function)) = OF_TWO.iter().find(|(known, _)| *known == name) {
        let [Some(x), Some(y)] = numbers(arguments)[..] else { return Err(wrong(name, "two numbers")) };
        return defined(name, function(x.float(), y.float()), &[x, y]).map(Some);
    }
    of_values(name, arguments, named).and_then(bounded).map(Some)
}

fn numbers(values: &[Value]) -> Vec<Option<Number>> {
    values.iter().map(Value::number).collect()
}
