//! Functions of torque terms: the standard library's in each lane, with exact first derivatives.

use super::number::Real;

/// `f(x)` with its first derivative `slope(x)`.
#[inline]
pub fn lifted<T: Real>(x: T, f: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> T {
    if !T::HAS_DERIVATIVE {
        return x.map(f);
    }
    // `x - value(x)` is zero and has the derivative of x, so that only the derivative is added.
    x.map(f) + x.map(slope) * (x - x.map(|value| value))
}

/// `e^x`.
#[inline]
pub fn exp<T: Real>(x: T) -> T {
    lifted(x, f64::exp, f64::exp)
}

/// The square root of what is above zero.
#[inline]
pub fn square_root<T: Real>(x: T) -> T {
    lifted(x, f64::sqrt, |value| 0.5 / value.sqrt())
}

/// `x^exponent` for x of at least zero. The derivative at zero is set to zero.
#[inline]
pub fn power<T: Real>(x: T, exponent: f64) -> T {
    let slope = |value: f64| if value == 0.0 { 0.0 } else { exponent * value.powf(exponent - 1.0) };
    lifted(x, |value| value.powf(exponent), slope)
}

/// The magnitude.
#[inline]
pub fn absolute<T: Real>(x: T) -> T {
    x.select_less(x.like(0.0), -x, x)
}

/// Step of the central differences of [`function_of`]: relative to the value, and absolute below one.
const STEP: f64 = 1e-6;

/// A function of at least one number. Its derivatives are central differences.
pub fn function_of<T: Real>(values: &[T], f: impl Fn(&[f64]) -> f64) -> T {
    let kind = values[0];
    let mut result = kind.of_values(values, &f);
    if !T::HAS_DERIVATIVE {
        return result;
    }
    for (place, value) in values.iter().enumerate() {
        let slope = kind.of_values(values, |values| {
            let step = STEP * values[place].abs().max(1.0);
            let moved = |by: f64| {
                let mut values = values.to_vec();
                values[place] += by;
                f(&values)
            };
            (moved(step) - moved(-step)) / (2.0 * step)
        });
        result += slope * (*value - value.map(|value| value));
    }
    result
}

#[cfg(test)]
mod tests {
    use super::{super::Dual, *};

    #[test]
    fn derivatives_are_those_of_the_functions() {
        for x in [0.3, 1.0, 2.7] {
            let dual = Dual { value: x, derivative: 2.0 };
            for (found, value, slope) in [
                (exp(dual), x.exp(), x.exp()),
                (square_root(dual), x.sqrt(), 0.5 / x.sqrt()),
                (power(dual, 1.3), x.powf(1.3), 1.3 * x.powf(0.3)),
                (absolute(-dual), x, 1.0),
                (function_of(&[dual], |v| v[0].sin() * v[0]), x * x.sin(), x.sin() + x * x.cos()),
            ] {
                assert_eq!(found.value, value);
                assert!((found.derivative - 2.0 * slope).abs() < 1e-8, "{x}: {} {slope}", found.derivative);
            }
        }
    }

    #[test]
    fn a_power_has_a_derivative_at_zero() {
        let found = power(Dual { value: 0.0, derivative: 1.0 }, 0.5);
        assert_eq!((found.value, found.derivative), (0.0, 0.0));
    }
}
