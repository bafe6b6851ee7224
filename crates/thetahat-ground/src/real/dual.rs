use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::Real;

/// A number with its derivative in one direction, or in several in the lanes of `T`: a kernel of dual numbers gives exact
/// derivatives of what it computes.
#[derive(Debug, Clone, Copy, Default)]
pub struct Dual<T = f64> {
    /// The value.
    pub value: T,
    /// Its derivative.
    pub derivative: T,
}

impl<T: Real> Dual<T> {
    /// A number that does not vary.
    #[inline(always)]
    pub fn constant(value: T) -> Self {
        Self { value, derivative: value.like(0.0) }
    }

    #[inline(always)]
    fn product_rule(self, other: Self) -> Self {
        let derivative = self.derivative * other.value + self.value * other.derivative;
        Self { value: self.value * other.value, derivative }
    }

    #[inline(always)]
    fn quotient_rule(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, derivative: (self.derivative - value * other.derivative) / other.value }
    }
}

impl<T: Real> Real for Dual<T> {
    const HAS_DERIVATIVE: bool = true;

    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Self::constant(self.value.like(value))
    }

    #[inline(always)]
    fn select_less(self, bound: Self, then: Self, otherwise: Self) -> Self {
        let select = |then, otherwise| self.value.select_less(bound.value, then, otherwise);
        Self { value: select(then.value, otherwise.value), derivative: select(then.derivative, otherwise.derivative) }
    }

    #[inline(always)]
    fn largest(self) -> f64 {
        self.value.largest()
    }

    #[inline(always)]
    fn is_positive(self) -> bool {
        self.value.is_positive()
    }

    /// A function whose derivative is not known here is treated as constant.
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self::constant(self.value.map(f))
    }

    #[inline(always)]
    fn of_values(self, values: &[Self], f: impl Fn(&[f64]) -> f64) -> Self {
        let values: Vec<T> = values.iter().map(|value| value.value).collect();
        Self::constant(self.value.of_values(&values, f))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = Real::sin_cos(self.value);
        let (s, c) = (cosine * self.derivative, -sine * self.derivative);
        (Self { value: sine, derivative: s }, Self { value: cosine, derivative: c })
    }
}

impl<T: Real> Add for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, derivative: self.derivative + other.derivative }
    }
}

impl<T: Real> Sub for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, derivative: self.derivative - other.derivative }
    }
}

impl<T: Real> Mul for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.product_rule(other)
    }
}

impl<T: Real> Mul<f64> for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self { value: self.value * factor, derivative: self.derivative * factor }
    }
}

impl<T: Real> Div for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.quotient_rule(other)
    }
}

impl<T: Real> Neg for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, derivative: -self.derivative }
    }
}

impl<T: Real> AddAssign for Dual<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real> SubAssign for Dual<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::{super::tanh, *};

    /// `tanh' = 1 - tanh^2`, also where the kernel's tanh is one to the last bit.
    #[test]
    fn the_derivative_of_tanh_is_exact() {
        for x in [-30.0, -3.0, -1e-3, 0.0, 1e-9, 0.4, 2.0, 19.0, 25.0] {
            let found = tanh(Dual { value: x, derivative: 1.0 });
            let expected = 1.0 / f64::cosh(x).powi(2);
            assert!((found.derivative - expected).abs() < 1e-14, "{x}: {} against {expected}", found.derivative);
            assert_eq!(found.value, tanh(x));
        }
    }

    #[test]
    fn quotients_and_sines_have_their_derivatives() {
        let x = Dual { value: 0.7, derivative: 1.0 };
        let (sine, cosine) = x.sin_cos();
        let tangent = sine / cosine;
        assert!((tangent.derivative - (1.0 + tangent.value * tangent.value)).abs() < 1e-14);
    }
}
