use std::{
    fmt::Debug,
    ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign},
};

/// A number type of the kernels.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// Whether the number carries a derivative.
    const HAS_DERIVATIVE: bool;

    /// A constant, in every lane, of the type of `self`.
    fn like(self, value: f64) -> Self;

    /// In each lane `then` where `self < bound`, otherwise `otherwise`.
    fn select_less(self, bound: Self, then: Self, otherwise: Self) -> Self;

    /// The largest magnitude over the lanes.
    fn largest(self) -> f64;

    /// Whether every lane is above zero; NaN is not.
    fn is_positive(self) -> bool;

    /// A function of each lane.
    fn map(self, f: impl Fn(f64) -> f64) -> Self;

    /// Applies to each lane a function of that lane of several numbers; the derivative is zero.
    fn of_values(self, values: &[Self], f: impl Fn(&[f64]) -> f64) -> Self;

    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
}

/// A parameter of the kernels: one value for all lanes, or one for each.
pub trait Parameter<T>: Copy + Debug {
    /// The value in every lane, of the type of `kind`.
    fn in_lanes(self, kind: T) -> T;
}

impl<T: Real> Parameter<T> for f64 {
    #[inline(always)]
    fn in_lanes(self, kind: T) -> T {
        kind.like(self)
    }
}
