use std::f64::consts::FRAC_2_PI;

use super::{number::Real, tanh::polynomial};

/// `pi / 2` as a sum: the first two parts have 33 bits, so that their products with numbers below 2^20 are exact.
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Largest angle, in rad, at which the reduction keeps its digits.
const LARGEST_ANGLE: f64 = 1e6;
/// Adding and subtracting this number rounds to an integer: `1.5 * 2^52`.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// Taylor coefficients of `sin x / x` from `x^2`, and of `cos x` from `x^4`, up to where the next is below rounding at
/// `pi / 4`.
const SINE: [f64; 8] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];
const COSINE: [f64; 7] = [
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// Sine and cosine, within two units in the last place of std's; bit-identical in every lane and on every machine up to angles of a million
/// rad.
///
/// The angle is reduced to `r + e`, `|r| <= pi / 4`, by the method of Cody and Waite (*Software Manual for the Elementary
/// Functions*, 1980); series in `r`, corrected for `e`, give both functions, and the quadrant selects between them.
#[inline(always)]
pub(super) fn sin_cos<T: Real>(x: T) -> (T, T) {
    if x.largest() > LARGEST_ANGLE {
        return (x.map(|x| of_any(x).0), x.map(|x| of_any(x).1));
    }
    reduced_sin_cos(x)
}

/// Sine and cosine of one angle, from std where the reduction would lose digits.
#[inline(never)]
fn of_any(x: f64) -> (f64, f64) {
    if x.abs() > LARGEST_ANGLE { x.sin_cos() } else { reduced_sin_cos(x) }
}

#[inline(always)]
fn reduced_sin_cos<T: Real>(x: T) -> (T, T) {
    let quarters = rounded(x * FRAC_2_PI);
    let (r, e) = reduced(x, quarters);
    let (sine, cosine) = (sine(r, e), cosine(r, e));
    // The quadrant: 0, 1 or -1, and 2 or -2.
    let quadrant = quarters - rounded(quarters * 0.25) * 4.0;
    let (half, one) = (x.like(0.5), x.like(1.0));
    let square = quadrant * quadrant;
    let (even_or_2, odd) = (square - one, x.like(0.25));
    let swapped = even_or_2 * even_or_2;
    let (a, b) = (swapped.select_less(odd, cosine, sine), swapped.select_less(odd, sine, cosine));
    let (left, right) = (quadrant - half, quadrant + half);
    ((left * left).select_less(one, a, -a), (right * right).select_less(one, b, -b))
}

#[inline(always)]
fn rounded<T: Real>(x: T) -> T {
    let shift = x.like(ROUNDING);
    (x + shift) - shift
}

/// `x - quarters pi / 2` as a rounded number and its rounding error.
#[inline(always)]
fn reduced<T: Real>(x: T, quarters: T) -> (T, T) {
    let first = x - quarters * HALF_PI[0];
    let second = quarters * HALF_PI[1];
    let a = first - second;
    // The rounding error of the subtraction, whichever of the two numbers is larger.
    let back = first - a;
    let lost = (first - (a + back)) + (back - second);
    let third = quarters * HALF_PI[2] - lost;
    let r = a - third;
    (r, (a - r) - third)
}

/// `sin (r + e) = sin r + e cos r`, with the significant terms of the cosine.
#[inline(always)]
fn sine<T: Real>(r: T, e: T) -> T {
    let z = r * r;
    let correction = e - z * e * 0.5;
    r + (r * z * polynomial(z, &SINE) + correction)
}

/// `cos (r + e) = cos r - e sin r`, corrected for the rounding of `1 - r^2 / 2`.
#[inline(always)]
fn cosine<T: Real>(r: T, e: T) -> T {
    let z = r * r;
    let (one, half) = (r.like(1.0), z * 0.5);
    let main = one - half;
    let lost = (one - main) - half;
    main + (lost + (z * z * polynomial(z, &COSINE) - r * e))
}

#[cfg(test)]
mod tests {
    use pulp::{Simd, WithSimd};

    use super::*;
    use crate::real::Lanes;

    /// Dense angles, multiples of a quarter turn and their neighbours, small and large ones.
    fn angles() -> Vec<f64> {
        let dense = (-40_000..40_000).map(|k| f64::from(k) * 1.237e-3);
        let multiples = (-3000..3000).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_2);
        let near = multiples.clone().flat_map(|x| [x.next_up(), x.next_down()]);
        let wide = (-400..120).map(|k| 1.05_f64.powi(k) * 1.7);
        let special = [0.0, -0.0, 1e-300, 9.99e5, 1.1e6, -3e7, 1e300];
        dense.chain(multiples).chain(near).chain(wide).chain(special).collect()
    }

    /// The distance in units of the last place of the expected value.
    fn ulps(found: f64, expected: f64) -> f64 {
        (found - expected).abs() / (expected.abs().next_up() - expected.abs())
    }

    #[test]
    fn sine_and_cosine_are_those_of_std_to_two_units_in_the_last_place() {
        for x in angles() {
            let (s, c) = sin_cos(x);
            let (s_error, c_error) = (ulps(s, x.sin()), ulps(c, x.cos()));
            assert!(s_error <= 2.0 && c_error <= 2.0, "{x:e}: {s_error} {c_error}");
        }
    }

    #[test]
    fn what_is_not_finite_has_none() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (s, c) = sin_cos(x);
            assert!(s.is_nan() && c.is_nan());
        }
    }

    struct InLanes(Vec<f64>);

    impl WithSimd for InLanes {
        type Output = Vec<(f64, f64)>;

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let of_group = |x: &[f64]| {
                let (s, c) = sin_cos(Lanes::from_fn(simd, |lane| x.get(lane).copied().unwrap_or(0.0)));
                std::iter::zip(s.to_array(), c.to_array()).take(x.len()).collect::<Vec<_>>()
            };
            self.0.chunks(Lanes::<S>::COUNT).flat_map(of_group).collect()
        }
    }

    #[test]
    fn lanes_have_the_same_bits() {
        let found = pulp::Arch::new().dispatch(InLanes(angles()));
        for (x, (s, c)) in angles().into_iter().zip(found) {
            let (own_s, own_c) = sin_cos(x);
            assert_eq!((s.to_bits(), c.to_bits()), (own_s.to_bits(), own_c.to_bits()), "{x:e}");
        }
    }
}
