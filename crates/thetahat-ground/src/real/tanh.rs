use super::number::Real;

/// Beyond this argument tanh equals one to the last bit.
const SATURATED: f64 = 19.1;
/// Number of halvings of an argument, so that the series below is short.
const HALVINGS: i32 = 6;
/// Coefficients of `(e^y - 1) / y`, up to where the next is below rounding at `2 SATURATED / 2^HALVINGS`.
const SERIES: [f64; 16] = [
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
    1.0 / 87_178_291_200.0,
    1.0 / 1_307_674_368_000.0,
    1.0 / 20_922_789_888_000.0,
];

/// The hyperbolic tangent, with the same bits in every lane and on every machine.
///
/// `tanh |x| = e / (e + 2)` with `e = e^(2 |x|) - 1`, from the series of a small part of the argument by
/// `e^(2 y) - 1 = e (e + 2)`, which keeps the digits of small arguments.
#[inline(always)]
pub fn tanh<T: Real>(x: T) -> T {
    // The usual case: every lane is saturated.
    if (x * x - x.like(SATURATED * SATURATED)).is_positive() { sign_or(x, x) } else { between(x) }
}

#[inline(always)]
fn between<T: Real>(x: T) -> T {
    let (limit, magnitude) = (x.like(SATURATED), x.select_less(x.like(0.0), -x, x));
    let y = limit.select_less(magnitude, limit, magnitude) * (2.0 / f64::from(1 << HALVINGS));
    let mut e = y * polynomial(y, &SERIES);
    for _ in 0..HALVINGS {
        e = e * (e + e.like(2.0));
    }
    let below = e / (e + e.like(2.0));
    let tanh = limit.select_less(magnitude, x.like(1.0), below);
    x.select_less(x.like(0.0), -tanh, tanh)
}

/// -1 or 1, and `at_zero` where x is zero or NaN.
#[inline(always)]
pub fn sign_or<T: Real>(x: T, at_zero: T) -> T {
    let zero = x.like(0.0);
    x.select_less(zero, x.like(-1.0), zero.select_less(x, x.like(1.0), at_zero))
}

/// Horner's rule.
#[inline(always)]
pub(super) fn polynomial<T: Real, const N: usize>(z: T, coefficients: &[f64; N]) -> T {
    let mut sum = z.like(coefficients[N - 1]);
    for i in (0..N - 1).rev() {
        sum = sum * z + z.like(coefficients[i]);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_that_of_std_to_ten_units_in_the_last_place() {
        let dense = (0..200_000).map(|k| f64::from(k) * 1e-4);
        let small = (0..700).map(|k| 10.0_f64.powf(-0.4 * f64::from(k)));
        for x in dense.chain(small).chain([0.0, 19.09, 19.11, 1e10, f64::INFINITY]) {
            let expected = x.tanh();
            let ulps = (tanh(x) - expected).abs() / (expected.next_up() - expected);
            assert!(ulps <= 10.0, "{x:e}: {ulps}");
            assert_eq!(tanh(-x), -tanh(x));
        }
    }

    #[test]
    fn what_is_not_a_number_has_none() {
        assert!(tanh(f64::NAN).is_nan());
    }
}
