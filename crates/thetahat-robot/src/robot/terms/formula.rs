//! A user-defined expression as a tree, for generated code.

use std::str::FromStr;

use exmex::{BinOp, Express, FlatEx, FloatOpsFactory, MakeOperators, Operator};

use super::expression::Expression;

/// Arithmetic on the variables of an [`Expression`], by their index.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq)]
pub enum Formula {
    Number(f64),
    Variable(usize),
    Negative(Box<Self>),
    Absolute(Box<Self>),
    Sine(Box<Self>),
    Cosine(Box<Self>),
    Sum(Box<[Self; 2]>),
    Difference(Box<[Self; 2]>),
    Product(Box<[Self; 2]>),
    Quotient(Box<[Self; 2]>),
    /// A function of one or two arguments.
    Function(MathFunction, Vec<Self>),
}

/// A function other than sine and cosine; of one argument, except the last four.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MathFunction {
    Exponential,
    Logarithm,
    SquareRoot,
    CubeRoot,
    Tangent,
    ArcSine,
    ArcCosine,
    ArcTangent,
    HyperbolicSine,
    HyperbolicCosine,
    HyperbolicTangent,
    AreaSine,
    AreaCosine,
    AreaTangent,
    Floor,
    /// `a^b`.
    Power,
    /// The angle of the point (b, a), `atan2`.
    ArcTangentOfPoint,
    Smaller,
    Larger,
}

impl MathFunction {
    /// The value of one argument, or of two.
    pub fn value(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Exponential => a.exp(),
            Self::Logarithm => a.ln(),
            Self::SquareRoot => a.sqrt(),
            Self::CubeRoot => a.cbrt(),
            Self::Tangent => a.tan(),
            Self::ArcSine => a.asin(),
            Self::ArcCosine => a.acos(),
            Self::ArcTangent => a.atan(),
            Self::HyperbolicSine => a.sinh(),
            Self::HyperbolicCosine => a.cosh(),
            Self::HyperbolicTangent => a.tanh(),
            Self::AreaSine => a.asinh(),
            Self::AreaCosine => a.acosh(),
            Self::AreaTangent => a.atanh(),
            Self::Floor => a.floor(),
            Self::Power => a.powf(b),
            Self::ArcTangentOfPoint => a.atan2(b),
            Self::Smaller => a.min(b),
            Self::Larger => a.max(b),
        }
    }
}

impl Default for Formula {
    fn default() -> Self {
        Self::Number(0.0)
    }
}

impl FromStr for Formula {
    type Err = std::num::ParseFloatError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.parse().map(Self::Number)
    }
}

/// The operators of [`Expression`] on trees, with the same precedence as on numbers.
#[derive(Debug, Clone)]
struct Operators;

impl MakeOperators<Formula> for Operators {
    fn make<'a>() -> Vec<Operator<'a, Formula>> {
        FloatOpsFactory::<f64>::make().iter().filter_map(on_trees).collect()
    }
}

/// Converts an operator on numbers to one on trees.
fn on_trees<'a>(operator: &Operator<'a, f64>) -> Option<Operator<'a, Formula>> {
    let name = operator.repr();
    if let Some(value) = operator.constant() {
        return Some(Operator::make_constant(name, Formula::Number(value)));
    }
    let two = operator.bin().ok().and_then(|BinOp { prio, is_commutative, .. }| {
        Some(BinOp { apply: two_arguments(name)?, prio, is_commutative })
    });
    let one = if operator.has_unary() { one_argument(name) } else { None };
    match (two, one) {
        (Some(two), Some(one)) => Some(Operator::make_bin_unary(name, two, one)),
        (Some(two), None) => Some(Operator::make_bin(name, two)),
        (None, Some(one)) => Some(Operator::make_unary(name, one)),
        (None, None) => None,
    }
}

fn two_arguments(name: &str) -> Option<fn(Formula, Formula) -> Formula> {
    Some(match name {
        "+" => |a, b| Formula::Sum(Box::new([a, b])),
        "-" => |a, b| Formula::Difference(Box::new([a, b])),
        "*" => |a, b| Formula::Product(Box::new([a, b])),
        "/" => |a, b| Formula::Quotient(Box::new([a, b])),
        "^" => |a, b| Formula::Function(MathFunction::Power, vec![a, b]),
        "atan2" => |a, b| Formula::Function(MathFunction::ArcTangentOfPoint, vec![a, b]),
        "min" => |a, b| Formula::Function(MathFunction::Smaller, vec![a, b]),
        "max" => |a, b| Formula::Function(MathFunction::Larger, vec![a, b]),
        _ => return None,
    })
}

fn one_argument(name: &str) -> Option<fn(Formula) -> Formula> {
    use MathFunction as F;
    Some(match name {
        "+" => |a| a,
        "-" => |a| Formula::Negative(Box::new(a)),
        "abs" => |a| Formula::Absolute(Box::new(a)),
        "sin" => |a| Formula::Sine(Box::new(a)),
        "cos" => |a| Formula::Cosine(Box::new(a)),
        "exp" => |a| of(F::Exponential, a),
        "ln" | "log" => |a| of(F::Logarithm, a),
        "log2" => |a| quotient(of(F::Logarithm, a), std::f64::consts::LN_2),
        "log10" => |a| quotient(of(F::Logarithm, a), std::f64::consts::LN_10),
        "sqrt" => |a| of(F::SquareRoot, a),
        "cbrt" => |a| of(F::CubeRoot, a),
        "tan" => |a| of(F::Tangent, a),
        "asin" => |a| of(F::ArcSine, a),
        "acos" => |a| of(F::ArcCosine, a),
        "atan" => |a| of(F::ArcTangent, a),
        "sinh" => |a| of(F::HyperbolicSine, a),
        "cosh" => |a| of(F::HyperbolicCosine, a),
        "tanh" => |a| of(F::HyperbolicTangent, a),
        "asinh" => |a| of(F::AreaSine, a),
        "acosh" => |a| of(F::AreaCosine, a),
        "atanh" => |a| of(F::AreaTangent, a),
        "floor" => |a| of(F::Floor, a),
        "ceil" => ceiling,
        "trunc" => truncated,
        "fract" => |a| Formula::Difference(Box::new([a.clone(), truncated(a)])),
        // Halves are rounded away from zero.
        "round" => |a| {
            let half = |sign: f64| Formula::Sum(Box::new([a.clone(), Formula::Number(0.5 * sign)]));
            outer_part(of(F::Floor, half(1.0)), ceiling(half(-1.0)))
        },
        _ => return None,
    })
}

fn of(function: MathFunction, a: Formula) -> Formula {
    Formula::Function(function, vec![a])
}

fn quotient(a: Formula, by: f64) -> Formula {
    Formula::Quotient(Box::new([a, Formula::Number(by)]))
}

fn ceiling(a: Formula) -> Formula {
    Formula::Negative(Box::new(of(MathFunction::Floor, Formula::Negative(Box::new(a)))))
}

fn truncated(a: Formula) -> Formula {
    outer_part(of(MathFunction::Floor, a.clone()), ceiling(a))
}

/// `max(up, 0) + min(down, 0)`: a step up above zero and a step down below, of which one is zero.
fn outer_part(up: Formula, down: Formula) -> Formula {
    let with_zero = |function, part| Formula::Function(function, vec![part, Formula::Number(0.0)]);
    let (up, down) = (with_zero(MathFunction::Larger, up), with_zero(MathFunction::Smaller, down));
    Formula::Sum(Box::new([up, down]))
}

impl Expression {
    #[doc(hidden)]
    /// Its tree, whose variables are those of [`Expression::variables`].
    ///
    /// # Errors
    /// What cannot be converted, in words.
    pub fn formula(&self) -> Result<Formula, String> {
        let parsed = FlatEx::<Formula, Operators>::parse(self.text()).map_err(|e| e.to_string())?;
        let variables: Vec<Formula> = (0..self.variables().len()).map(Formula::Variable).collect();
        parsed.eval(&variables).map_err(|e| e.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(formula: &Formula, variables: &[f64]) -> f64 {
        let of = |formula: &Formula| value(formula, variables);
        match formula {
            Formula::Number(number) => *number,
            Formula::Variable(place) => variables[*place],
            Formula::Negative(a) => -of(a),
            Formula::Absolute(a) => of(a).abs(),
            Formula::Sine(a) => of(a).sin(),
            Formula::Cosine(a) => of(a).cos(),
            Formula::Sum(both) => of(&both[0]) + of(&both[1]),
            Formula::Difference(both) => of(&both[0]) - of(&both[1]),
            Formula::Product(both) => of(&both[0]) * of(&both[1]),
            Formula::Quotient(both) => of(&both[0]) / of(&both[1]),
            Formula::Function(function, arguments) => {
                function.value(of(&arguments[0]), arguments.get(1).map_or(f64::NAN, of))
            }
        }
    }

    /// Every operator of the crate has its tree, with its precedence.
    #[test]
    fn trees_have_the_values_of_their_texts() {
        let names: Vec<String> = FloatOpsFactory::<f64>::make()
            .iter()
            .filter(|o| o.has_unary() && o.repr() != "signum")
            .map(|o| format!("{}(0.9*q - 0.3*dq)", o.repr()))
            .collect();
        let texts = [
            "-q^2 + dq*q - 3/q/dq",
            "2^q^dq",
            "-2*-q",
            "q - dq - 1",
            "q/dq*3",
            "(q+1)*PI - E*TAU",
            "q min dq*2",
            "atan2(q, dq)",
            "max(q, dq)^2",
            "dq max 0.1 + q",
            "1 - s*exp(-abs(dq)/0.1)^2",
        ];
        for text in names.iter().map(String::as_str).chain(texts) {
            let expression = Expression::parse(text, 0, 1).unwrap_or_else(|e| panic!("{text}: {e}"));
            let formula = expression.formula().unwrap_or_else(|e| panic!("{text}: {e}"));
            for [a, b, c] in [[0.7, -0.4, 1.0], [2.6, 0.5, -1.0], [-1.2, 1.6, 0.3], [-0.55, -2.2, 2.0]] {
                let variables = &[a, b, c][..expression.variables().len()];
                let (found, expected) = (value(&formula, variables), expression.value(variables));
                let close = (found - expected).abs() <= 1e-14 * expected.abs().max(1.0);
                assert!(close || (found.is_nan() && expected.is_nan()), "{text} at {variables:?}: {found} {expected}");
            }
        }
    }
}
