//! One state: a plain number.

use super::{number::Real, sin_cos::sin_cos};

impl Real for f64 {
    const HAS_DERIVATIVE: bool = false;

    #[inline(always)]
    fn like(self, value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn select_less(self, bound: Self, then: Self, otherwise: Self) -> Self {
        if self < bound { then } else { otherwise }
    }

    #[inline(always)]
    fn largest(self) -> f64 {
        self.abs()
    }

    #[inline(always)]
    fn is_positive(self) -> bool {
        self > 0.0
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        f(self)
    }

    #[inline(always)]
    fn of_values(self, values: &[Self], f: impl Fn(&[f64]) -> f64) -> Self {
        f(values)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self)
    }
}
