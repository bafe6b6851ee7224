use serde::{Deserialize, Serialize};

/// The normalised time law of one move: `s` goes from 0 to 1.
///
/// `ds = box(T1) * box(T2) * box(T3)`, the convolution of three boxes of unit area that starts at `start_s`, with
/// `T1 >= T2 >= T3 > 0`. This is a trapezoidal velocity whose acceleration is smoothed over T3 (a smoothed bang-bang
/// acceleration where `T1 = T2`). Where `T1 >= T2 + T3` the velocity cruises at `ds = 1 / T1`; it never exceeds that.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeLaw {
    /// Start of the move, in s.
    pub start_s: f64,
    /// T1, width of the first box: displacement divided by peak velocity where there is a cruise, in s.
    pub t1_s: f64,
    /// T2, width of the second box: the acceleration time, in s.
    pub t2_s: f64,
    /// T3, width of the third box: the smoothing time, in s.
    pub t3_s: f64,
}

/// The corners (a, b, c) of the sum over the ends of the three boxes.
const CORNERS: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 1.0, 0.0],
    [0.0, 1.0, 1.0],
    [1.0, 0.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, 1.0, 1.0],
];

/// Phases of a law.
#[doc(hidden)]
pub const PHASES: usize = 7;

/// A law evaluated at a fraction of one of its phases.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct InPhase {
    /// `s` and its first three derivatives by time.
    #[doc(hidden)]
    pub values: [f64; 4],
    /// Their derivatives with respect to T1, T2 and T3; the instant moves with its phase.
    #[doc(hidden)]
    pub slopes: [[f64; 3]; 4],
    /// Derivatives of the phase's duration with respect to T1, T2 and T3.
    #[doc(hidden)]
    pub seconds_by_width: [f64; 3],
}

impl TimeLaw {
    /// The end of the move, `start_s + T1 + T2 + T3`.
    #[must_use]
    #[inline]
    pub fn end_s(&self) -> f64 {
        self.start_s + self.duration()
    }

    /// `(s, ds, dds)` at time `t`: zeros before the start, `(1, 0, 0)` from the end on.
    ///
    /// With `u = t - start_s` and `x = max(0, u - a T1 - b T2 - c T3)`, sums over a, b, c in {0, 1}:
    /// `s = sum (-1)^(a+b+c) x^3 / 6 / (T1 T2 T3)`, and `x^2 / 2`, `x` for its derivatives.
    #[must_use]
    #[inline]
    pub fn evaluate(&self, t: f64) -> (f64, f64, f64) {
        let u = t - self.start_s;
        if u >= self.duration() {
            return (1.0, 0.0, 0.0);
        }
        let (mut s, mut ds, mut dds) = (0.0, 0.0, 0.0);
        for corner in CORNERS {
            let (sign, x) = self.term(u, corner);
            let (first, second) = (sign * x, sign * x * x);
            dds += first;
            ds += second;
            s += second * x;
        }
        let density = 1.0 / self.volume();
        (s * density / 6.0, ds * density / 2.0, dds * density)
    }

    /// The third derivative of `s` at time `t`; at a jump, its value after the jump.
    pub(super) fn jerk(&self, t: f64) -> f64 {
        let u = t - self.start_s;
        if u < 0.0 || u >= self.duration() {
            return 0.0;
        }
        let passed = |[a, b, c]: &[f64; 3]| u >= a * self.t1_s + b * self.t2_s + c * self.t3_s;
        CORNERS.iter().filter(|corner| passed(corner)).map(|corner| self.term(u, *corner).0).sum::<f64>()
            / self.volume()
    }

    /// The derivatives of `s` at time `t` with respect to the start and the logarithms of T1, T2 and T3.
    pub(super) fn sensitivity(&self, t: f64) -> [f64; 4] {
        let u = t - self.start_s;
        if u <= 0.0 || u >= self.duration() {
            return [0.0; 4];
        }
        let (s, ds, _) = self.evaluate(t);
        let mut by_width = [0.0; 3];
        for corner in CORNERS {
            let (sign, x) = self.term(u, corner);
            by_width.iter_mut().zip(corner).for_each(|(d, on)| *d -= on * sign * x * x / 2.0);
        }
        let by_log = |width: f64, d: f64| width * d / self.volume() - s;
        let [d1, d2, d3] = by_width;
        [-ds, by_log(self.t1_s, d1), by_log(self.t2_s, d2), by_log(self.t3_s, d3)]
    }

    /// The law at a fraction, from 0 to 1, of one of its seven phases: jerk, acceleration, jerk, cruise, jerk, acceleration, jerk.
    ///
    /// The phases are those of `T1 >= T2 + T3`: the corners of the sum are then in the order of time, and the instant is a sum of
    /// T1, T2 and T3 with constant factors.
    #[doc(hidden)]
    pub fn in_phase(&self, phase: usize, part: f64) -> InPhase {
        let [before, after] = [CORNERS[phase], CORNERS[phase + 1]];
        let widths = [self.t1_s, self.t2_s, self.t3_s];
        let factors = [0, 1, 2].map(|i| before[i] + part * (after[i] - before[i]));
        let (mut values, mut slopes) = ([0.0; 4], [[0.0; 3]; 4]);
        // Later corners are not reached yet, whatever rounding says of phases without duration.
        for corner in &CORNERS[..=phase] {
            let by_width = [0, 1, 2].map(|i| factors[i] - corner[i]);
            let x: f64 = by_width.iter().zip(widths).map(|(b, w)| b * w).sum();
            let sign = (1.0 - 2.0 * corner[0]) * (1.0 - 2.0 * corner[1]) * (1.0 - 2.0 * corner[2]);
            let powers = [x * x * x / 6.0, x * x / 2.0, x, 1.0, 0.0].map(|power| sign * power / self.volume());
            for order in 0..4 {
                values[order] += powers[order];
                slopes[order].iter_mut().zip(by_width).for_each(|(slope, b)| *slope += b * powers[order + 1]);
            }
        }
        for (slopes, value) in slopes.iter_mut().zip(values) {
            slopes.iter_mut().zip(widths).for_each(|(slope, width)| *slope -= value / width);
        }
        InPhase { values, slopes, seconds_by_width: [0, 1, 2].map(|i| after[i] - before[i]) }
    }

    /// The same law with `T1 >= T2 >= T3`: the convolution does not depend on the order of the boxes.
    pub(super) fn ordered(self) -> Self {
        let mut widths = [self.t1_s, self.t2_s, self.t3_s];
        widths.sort_by(|a, b| b.total_cmp(a));
        let [t1_s, t2_s, t3_s] = widths;
        Self { t1_s, t2_s, t3_s, ..self }
    }

    #[inline]
    fn term(&self, u: f64, [a, b, c]: [f64; 3]) -> (f64, f64) {
        let sign = (1.0 - 2.0 * a) * (1.0 - 2.0 * b) * (1.0 - 2.0 * c);
        (sign, (u - a * self.t1_s - b * self.t2_s - c * self.t3_s).max(0.0))
    }

    #[inline]
    fn duration(&self) -> f64 {
        self.t1_s + self.t2_s + self.t3_s
    }

    #[inline]
    fn volume(&self) -> f64 {
        self.t1_s * self.t2_s * self.t3_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CRUISE: TimeLaw = TimeLaw { start_s: 0.2, t1_s: 0.3, t2_s: 0.15, t3_s: 0.03 };
    const BANG_BANG: TimeLaw = TimeLaw { start_s: -0.1, t1_s: 0.2, t2_s: 0.2, t3_s: 0.05 };

    fn times(law: &TimeLaw) -> impl Iterator<Item = f64> {
        let (start, step) = (law.start_s - 0.01, (law.end_s() - law.start_s + 0.02) / 997.0);
        (0..=997).map(move |k| start + step * f64::from(k))
    }

    /// Finite differences over h are right to h^2 of the next derivative but one, and to rounding.
    #[test]
    fn derivatives_are_those_of_finite_differences() {
        let h = 1e-6;
        for law in [CRUISE, BANG_BANG] {
            for t in times(&law) {
                let ((s0, ds0, _), (s1, ds1, _)) = (law.evaluate(t - h), law.evaluate(t + h));
                let (_, ds, dds) = law.evaluate(t);
                assert!(((s1 - s0) / (2.0 * h) - ds).abs() < 1e-6, "ds at {t}");
                assert!(((ds1 - ds0) / (2.0 * h) - dds).abs() < 2e-3, "dds at {t}");
            }
        }
    }

    #[test]
    fn sensitivity_is_that_of_finite_differences() {
        let h = 1e-6;
        let shifted = |law: TimeLaw, i: usize, h: f64| match i {
            0 => TimeLaw { start_s: law.start_s + h, ..law },
            1 => TimeLaw { t1_s: law.t1_s * h.exp(), ..law },
            2 => TimeLaw { t2_s: law.t2_s * h.exp(), ..law },
            _ => TimeLaw { t3_s: law.t3_s * h.exp(), ..law },
        };
        for law in [CRUISE, BANG_BANG] {
            for t in times(&law) {
                for (i, d) in law.sensitivity(t).into_iter().enumerate() {
                    let s = |h| shifted(law, i, h).evaluate(t).0;
                    assert!(((s(h) - s(-h)) / (2.0 * h) - d).abs() < 1e-6, "parameter {i} at {t}");
                }
            }
        }
    }

    #[test]
    fn phases_are_parts_of_the_law_with_exact_slopes() {
        let h = 1e-6;
        for (phase, part) in (0..PHASES).flat_map(|phase| [0.2, 0.7].map(|part| (phase, part))) {
            let found = CRUISE.in_phase(phase, part);
            let seconds =
                |k: usize| CORNERS[k][0] * CRUISE.t1_s + CORNERS[k][1] * CRUISE.t2_s + CORNERS[k][2] * CRUISE.t3_s;
            let t = CRUISE.start_s + seconds(phase) + part * (seconds(phase + 1) - seconds(phase));
            let (s, ds, dds) = CRUISE.evaluate(t);
            for (found, expected) in found.values.into_iter().zip([s, ds, dds, CRUISE.jerk(t)]) {
                assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{phase}: {found} {expected}");
            }
            let moved = |i: usize, h: f64| {
                let mut law = CRUISE;
                *[&mut law.t1_s, &mut law.t2_s, &mut law.t3_s][i] += h;
                law.in_phase(phase, part).values
            };
            for i in 0..3 {
                for (order, (after, before)) in moved(i, h).into_iter().zip(moved(i, -h)).enumerate() {
                    let (central, exact) = ((after - before) / (2.0 * h), found.slopes[order][i]);
                    assert!(
                        (central - exact).abs() < 1e-6 * exact.abs().max(1.0),
                        "{phase} {order} {i}: {central} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn s_goes_from_zero_to_exactly_one_and_never_back() {
        for law in [CRUISE, BANG_BANG] {
            assert_eq!(law.evaluate(law.start_s), (0.0, 0.0, 0.0));
            assert_eq!(law.evaluate(law.end_s() + 1e-12), (1.0, 0.0, 0.0));
            let s: Vec<f64> = times(&law).map(|t| law.evaluate(t).0).collect();
            assert!(s.windows(2).all(|w| w[1] >= w[0] - 1e-13));
        }
    }

    #[test]
    fn the_cruise_velocity_is_one_over_t1() {
        let peak = |law: TimeLaw| times(&law).map(|t| law.evaluate(t).1).fold(0.0, f64::max);
        assert!((peak(CRUISE) - 1.0 / 0.3).abs() < 1e-12);
        assert!(peak(BANG_BANG) < 1.0 / 0.2);
    }
}
