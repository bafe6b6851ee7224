use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::Real;

/// A number with its derivatives in `D` directions: a kernel of dual numbers gives exact derivatives of what it computes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dual<const D: usize = 1> {
    pub(crate) value: f64,
    pub(crate) derivatives: [f64; D],
}

impl<const D: usize> Dual<D> {
    /// A number that does not vary.
    #[inline(always)]
    pub(crate) fn constant(value: f64) -> Self {
        Self { value, derivatives: [0.0; D] }
    }

    /// Another value, with the derivatives of each direction.
    #[inline(always)]
    fn with(value: f64, derivative: impl Fn(usize) -> f64) -> Self {
        Self { value, derivatives: std::array::from_fn(derivative) }
    }
}

impl<const D: usize> Real for Dual<D> {
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
        let (sine, cosine) = Real::sin_cos(self.value);
        let d = self.derivatives;
        (Self::with(sine, |i| cosine * d[i]), Self::with(cosine, |i| -sine * d[i]))
    }
}

impl<const D: usize> Add for Dual<D> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::with(self.value + other.value, |i| self.derivatives[i] + other.derivatives[i])
    }
}

impl<const D: usize> Sub for Dual<D> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::with(self.value - other.value, |i| self.derivatives[i] - other.derivatives[i])
    }
}

impl<const D: usize> Mul for Dual<D> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let derivative = |i: usize| self.derivatives[i] * other.value + self.value * other.derivatives[i];
        Self::with(self.value * other.value, derivative)
    }
}

impl<const D: usize> Mul<f64> for Dual<D> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self::with(self.value * factor, |i| self.derivatives[i] * factor)
    }
}

impl<const D: usize> Div for Dual<D> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::with(value, |i| (self.derivatives[i] - value * other.derivatives[i]) / other.value)
    }
}

impl<const D: usize> Neg for Dual<D> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::with(-self.value, |i| -self.derivatives[i])
    }
}

impl<const D: usize> AddAssign for Dual<D> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const D: usize> SubAssign for Dual<D> {
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
            let found = tanh(Dual { value: x, derivatives: [1.0, -2.0] });
            let expected = 1.0 / f64::cosh(x).powi(2);
            let [first, second] = found.derivatives;
            assert!((first - expected).abs() < 1e-14, "{x}: {first} against {expected}");
            assert!((second + 2.0 * expected).abs() < 2e-14, "{x}: {second}");
            assert_eq!(found.value, tanh(x));
        }
    }

    #[test]
    fn quotients_and_sines_have_their_derivatives() {
        let x = Dual { value: 0.7, derivatives: [1.0] };
        let (sine, cosine) = x.sin_cos();
        let tangent = sine / cosine;
        assert!((tangent.derivatives[0] - (1.0 + tangent.value * tangent.value)).abs() < 1e-14);
    }
}
