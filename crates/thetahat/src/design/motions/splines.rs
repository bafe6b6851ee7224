//! B-splines of degree five that rest at zero at both ends (C. de Boor, "A Practical Guide to Splines", 1978, chapter IX).

use crate::design::motions::fourier::ORDERS;

const DEGREE: usize = 5;
/// Splines at either end that do not rest there: position, velocity or acceleration of them is not zero.
const MOVING: usize = 3;

/// Values and derivatives of all splines on equal intervals of a period, order by order.
pub(in crate::design) fn raw(period_s: f64, splines: usize, t: f64) -> [Vec<f64>; ORDERS] {
    let intervals = splines + 2 * MOVING - DEGREE;
    let knot = |i: usize| period_s * i.saturating_sub(DEGREE).min(intervals) as f64 / intervals as f64;
    let knots: Vec<f64> = (0..=intervals + 2 * DEGREE).map(knot).collect();
    std::array::from_fn(|order| {
        (MOVING..MOVING + splines).map(|i| spline(&knots, Spline { number: i, degree: DEGREE }, order, t)).collect()
    })
}

/// A spline on given knots.
#[derive(Clone, Copy)]
struct Spline {
    number: usize,
    degree: usize,
}

/// A derivative of a spline at a time: zero where its knots do not enclose it.
fn spline(knots: &[f64], of: Spline, order: usize, t: f64) -> f64 {
    let Spline { number: i, degree } = of;
    let (first, last) = (knots[i], knots[i + degree + 1]);
    let is_end = t == last && last == knots[knots.len() - 1];
    if t < first || (t >= last && !is_end) {
        return 0.0;
    }
    if degree == 0 {
        return 1.0;
    }
    // Over an interval without length a part is zero.
    let over = |value: f64, length: f64| if length > 0.0 { value / length } else { 0.0 };
    let lengths = [knots[i + degree] - first, last - knots[i + 1]];
    let next = order.saturating_sub(1);
    let [a, b] = [i, i + 1].map(|number| spline(knots, Spline { number, degree: degree - 1 }, next, t));
    if order > 0 {
        return degree as f64 * (over(a, lengths[0]) - over(b, lengths[1]));
    }
    over((t - first) * a, lengths[0]) + over((last - t) * b, lengths[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_rest_at_both_ends() {
        for t in [0.0, 7.0] {
            let [q, dq, ddq, dddq] = raw(7.0, 9, t);
            for values in [q, dq, ddq] {
                assert!(values.iter().all(|v| v.abs() < 1e-12), "{t}: {values:?}");
            }
            assert!(dddq.iter().filter(|v| v.abs() > 0.1).count() == 1, "{t}: {dddq:?}");
        }
    }

    /// Away from the ends they add to one everywhere, and are not negative.
    #[test]
    fn splines_add_to_one() {
        for k in 0..40 {
            let t = 2.8 + 0.105 * f64::from(k);
            let [q, ..] = raw(10.0, 16, t);
            assert!((q.iter().sum::<f64>() - 1.0).abs() < 1e-12 && q.iter().all(|v| *v >= 0.0), "{t}: {q:?}");
        }
    }

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        let h = 1e-5;
        for t in [0.3, 1.7, 2.0, 3.9] {
            let (before, here, after) = (raw(4.0, 7, t - h), raw(4.0, 7, t), raw(4.0, 7, t + h));
            for order in 0..3 {
                for m in 0..7 {
                    let central = (after[order][m] - before[order][m]) / (2.0 * h);
                    let exact = here[order + 1][m];
                    assert!((central - exact).abs() < 1e-7 * exact.abs().max(10.0), "{order} {m} at {t}: {central}");
                }
            }
        }
    }
}
