use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use pulp::Simd;

use super::{
    number::{Parameter, Real},
    sin_cos::sin_cos,
};

/// Several states, one in each lane of a vector of this machine. All functions that work on them must be inlined into the function that
/// `pulp` compiles for the machine's instructions.
#[derive(Debug, Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

/// Upper bound of the number of lanes on any machine.
pub const MOST_LANES: usize = 8;

impl<S: Simd> Lanes<S> {
    /// The number of lanes.
    pub const COUNT: usize = S::F64_LANES;

    /// One number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, values: simd.splat_f64s(value) }
    }

    /// The value of each lane.
    #[inline(always)]
    pub fn from_fn(simd: S, mut value: impl FnMut(usize) -> f64) -> Self {
        let mut array = [0.0; MOST_LANES];
        for (lane, v) in array.iter_mut().take(Self::COUNT).enumerate() {
            *v = value(lane);
        }
        match S::as_simd_f64s(&array[..Self::COUNT]).0 {
            [values, ..] => Self { simd, values: *values },
            [] => Self::splat(simd, 0.0),
        }
    }

    /// Writes the lanes to a slice of the same length.
    #[inline(always)]
    pub fn store(self, to: &mut [f64]) {
        if let [first, ..] = S::as_mut_simd_f64s(to).0 {
            *first = self.values;
        }
    }

    /// The lanes, followed by zeros.
    #[inline(always)]
    pub fn to_array(self) -> [f64; MOST_LANES] {
        let mut array = [0.0; MOST_LANES];
        self.store(&mut array[..Self::COUNT]);
        array
    }

    #[inline(always)]
    fn with(self, values: S::f64s) -> Self {
        Self { values, ..self }
    }
}

impl<S: Simd> Real for Lanes<S> {
    const HAS_DERIVATIVE: bool = false;

    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    #[inline(always)]
    fn select_less(self, bound: Self, then: Self, otherwise: Self) -> Self {
        let less = self.simd.less_than_f64s(self.values, bound.values);
        self.with(self.simd.select_f64s(less, then.values, otherwise.values))
    }

    #[inline(always)]
    fn largest(self) -> f64 {
        self.simd.reduce_max_f64s(self.simd.abs_f64s(self.values))
    }

    #[inline(always)]
    fn is_positive(self) -> bool {
        let ones = self.like(0.0).select_less(self, self.like(1.0), self.like(0.0));
        self.simd.reduce_min_f64s(ones.values) > 0.0
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let array = self.to_array();
        Self::from_fn(self.simd, |lane| f(array[lane]))
    }

    #[inline(always)]
    fn of_values(self, values: &[Self], f: impl Fn(&[f64]) -> f64) -> Self {
        let arrays: Vec<[f64; MOST_LANES]> = values.iter().map(|value| value.to_array()).collect();
        Self::from_fn(self.simd, |lane| f(&arrays.iter().map(|array| array[lane]).collect::<Vec<_>>()))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self)
    }
}

impl<S: Simd> Parameter<Self> for Lanes<S> {
    #[inline(always)]
    fn in_lanes(self, _: Self) -> Self {
        self
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(self.simd.add_f64s(self.values, other.values))
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(self.simd.sub_f64s(self.values, other.values))
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(self.simd.mul_f64s(self.values, other.values))
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * self.like(factor)
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(self.simd.div_f64s(self.values, other.values))
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.neg_f64s(self.values))
    }
}

impl<S: Simd> AddAssign for Lanes<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Simd> SubAssign for Lanes<S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
