use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::Real;

/// A number with its derivative in one direction: a kernel of dual numbers gives exact derivatives of what it computes.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Dual {
    pub(crate) value: f64,
    pub(crate) derivative: f64,
}

impl Dual {
    /// A number that does not vary.
    #[inline(always)]
    pub(crate) fn constant(value: f64) -> Self {
        Self { value, derivative: 0.0 }
    }
}

impl Real for Dual {
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Self::constant(value)
    }

    #[inline(always)]
    fn select_less(self, bound: Self, then: Self, otherwise: Self) -> Self {
        if self.value < bound.value { then } else { otherwise }
    }

    #[inline(always)]
    fn largest(self) -> f64 {
        self.value.abs()
    }

    #[inline(always)]
    fn is_positive(self) -> bool {
        self.value > 0.0
    }

    /// Of a function whose derivative is not known here: as if it were constant.
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self::constant(f(self.value))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        let (s, c) = (cosine * self.derivative, -sine * self.derivative);
        (Self { value: sine, derivative: s }, Self { value: cosine, derivative: c })
    }
}

impl Add for Dual {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, derivative: self.derivative + other.derivative }
    }
}

impl Sub for Dual {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, derivative: self.derivative - other.derivative }
    }
}

impl Mul for Dual {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let derivative = self.derivative * other.value + self.value * other.derivative;
        Self { value: self.value * other.value, derivative }
    }
}

impl Mul<f64> for Dual {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self { value: self.value * factor, derivative: self.derivative * factor }
    }
}

impl Div for Dual {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, derivative: (self.derivative - value * other.derivative) / other.value }
    }
}

impl Neg for Dual {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, derivative: -self.derivative }
    }
}

impl AddAssign for Dual {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Dual {
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
