//! Ranges of values, the pixels that they span, and ticks at round values.

use serde::Serialize;

use crate::report::number::{fixed, significant};

/// Units of a path in a pixel: paths hold whole numbers.
pub(in crate::report) const UNITS: f64 = 10.0;

/// To a tenth of a pixel.
pub(in crate::report) fn pixel(position: f64) -> f64 {
    (position * UNITS).round() / UNITS
}

/// A position on an axis, with its label.
#[derive(Debug, Clone, Serialize)]
pub(in crate::report) struct Tick {
    pub(in crate::report) at: f64,
    pub(in crate::report) label: String,
}

/// The mapping from values to positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(in crate::report) enum Scale {
    /// In proportion.
    Linear,
    /// By powers of ten; values are above zero.
    Logarithmic,
}

/// From a smallest to a largest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::report) struct Range {
    pub(in crate::report) low: f64,
    pub(in crate::report) high: f64,
}

impl Range {
    /// The smallest range around the finite values that is not a point.
    pub(in crate::report) fn of(values: impl Iterator<Item = f64>) -> Self {
        let around = |(low, high): (f64, f64), v: f64| (low.min(v), high.max(v));
        let (low, high) = values.filter(|v| v.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), around);
        match (low <= high, low < high) {
            (false, _) => Self { low: 0.0, high: 1.0 },
            (true, true) => Self { low, high },
            (true, false) => Self { low, high }.padded_by(if low == 0.0 { 1.0 } else { 0.1 * low.abs() }),
        }
    }

    fn padded_by(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// Not below a fraction of the largest value, so that a nearly constant curve looks constant.
    pub(in crate::report) fn at_least(self, fraction: f64) -> Self {
        let smallest = fraction * self.low.abs().max(self.high.abs());
        self.padded_by(0.5 * (smallest - (self.high - self.low)).max(0.0))
    }

    pub(in crate::report) fn padded(self, fraction: f64) -> Self {
        self.padded_by(fraction * (self.high - self.low))
    }

    /// The same wide enough for a value.
    pub(in crate::report) fn with(self, value: f64) -> Self {
        Self { low: self.low.min(value), high: self.high.max(value) }
    }

    /// As wide to both sides of zero.
    pub(in crate::report) fn symmetric(self) -> Self {
        let most = self.low.abs().max(self.high.abs());
        Self { low: -most, high: most }
    }
}

/// A range of values and the pixels that it spans.
#[derive(Debug, Clone, Copy)]
pub(in crate::report) struct Axis {
    pub(in crate::report) range: Range,
    pub(in crate::report) scale: Scale,
    pub(in crate::report) from: f64,
    pub(in crate::report) to: f64,
}

/// Fewest ticks that define a scale, and the factor on the requested number if there are fewer.
const FEWEST: usize = 2;
const MORE: f64 = 1.5;
/// Requested number of even ticks instead of powers of ten.
const FEW: f64 = 5.0;

impl Axis {
    #[cfg(test)]
    pub(in crate::report) fn linear(range: Range, from: f64, to: f64) -> Self {
        Self { range, scale: Scale::Linear, from, to }
    }

    /// An axis by powers of ten, a little beyond the smallest and largest value above zero.
    pub(in crate::report) fn logarithmic(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let exponents = Range::of(values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10)).padded(0.06);
        let range = Range { low: 10f64.powf(exponents.low), high: 10f64.powf(exponents.high) };
        Self { range, scale: Scale::Logarithmic, from, to }
    }

    pub(in crate::report) fn position(&self, value: f64) -> f64 {
        let Range { low, high } = self.range;
        let part = match self.scale {
            Scale::Linear => (value - low) / (high - low),
            Scale::Logarithmic => (value.max(f64::MIN_POSITIVE) / low).log10() / (high / low).log10(),
        };
        self.from + part * (self.to - self.from)
    }

    /// Round values, about as many as requested.
    pub(in crate::report) fn ticks(&self, count: f64, smallest_step: f64) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => self.linear_ticks(count, smallest_step),
            Scale::Logarithmic => match self.powers() {
                powers if powers.len() < FEWEST => self.linear_ticks(FEW, smallest_step),
                powers => powers,
            },
        }
    }

    /// Ticks at even steps; with a smaller step if there would be only one.
    fn linear_ticks(&self, count: f64, smallest_step: f64) -> Vec<Tick> {
        let step = |count: f64| round_step((self.range.high - self.range.low) / count).max(smallest_step);
        let ticks = self.ticks_at(step(count));
        if ticks.len() < FEWEST { self.ticks_at(step(MORE * count)) } else { ticks }
    }

    fn ticks_at(&self, step: f64) -> Vec<Tick> {
        let decimals = usize::try_from(-(step.log10() + 1e-9).floor() as i32).unwrap_or(0);
        let first = (self.range.low / step).ceil() as i64;
        let last = (self.range.high / step).floor() as i64;
        let tick = |k: i64| {
            let value = k as f64 * step;
            Tick { at: pixel(self.position(value)), label: fixed(value, decimals) }
        };
        (first..=last).map(tick).collect()
    }

    /// Powers of ten; with values between them if there are few, and every second, third ... if there are many.
    fn powers(&self) -> Vec<Tick> {
        let [low, high] = [self.range.low.log10(), self.range.high.log10()];
        let steps: &[i32] = match high - low {
            extent if extent > 2.5 => &[1],
            extent if extent > 1.2 => &[1, 3],
            extent if extent > 0.5 => &[1, 2, 5],
            _ => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
        };
        let every = ((high - low) / 6.0).ceil().max(1.0) as i32;
        let decades = (low.floor() as i32..=high.ceil() as i32).filter(|d| d.rem_euclid(every) == 0);
        let values = decades.flat_map(|d| steps.iter().map(move |s| f64::from(*s) * 10_f64.powi(d)));
        let inside = values.filter(|v| (self.range.low..=self.range.high).contains(v));
        inside.map(|v| Tick { at: pixel(self.position(v)), label: significant(v, 1) }).collect()
    }
}

/// 1, 2 or 5 times a power of ten, not below the step asked for.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|m| m * power).find(|s| *s >= step).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        assert_eq!([0.03, 0.7, 1.0, 3.0].map(round_step), [0.05, 1.0, 1.0, 5.0]);
    }

    #[test]
    fn a_logarithmic_axis_has_powers_of_ten_at_equal_steps() {
        let axis = Axis::logarithmic([1e-3, 0.0, f64::NAN, 1e2].into_iter(), 100.0, 0.0);
        let ticks = axis.ticks(5.0, 0.0);
        let labels: Vec<&str> = ticks.iter().map(|t| t.label.as_str()).collect();
        assert_eq!(labels, ["0.001", "0.01", "0.1", "1", "10", "100"]);
        let steps: Vec<f64> = ticks.windows(2).map(|t| t[0].at - t[1].at).collect();
        assert!(steps.iter().all(|s| (s - steps[0]).abs() < 0.2 && *s > 0.0), "{steps:?}");
    }

    #[test]
    fn a_narrow_logarithmic_axis_has_ticks_between_the_powers() {
        let labels = |low: f64, high: f64| {
            let ticks = Axis::logarithmic([low, high].into_iter(), 0.0, 1.0).ticks(5.0, 0.0);
            ticks.into_iter().map(|t| t.label).collect::<Vec<_>>()
        };
        assert_eq!(labels(2.0, 4.0), ["2", "3", "4"]);
        assert_eq!(labels(1.0, 8.0), ["1", "2", "5"]);
        assert_eq!(labels(0.0027, 0.0034), ["0.0028", "0.0030", "0.0032", "0.0034"]);
        assert!(labels(1e-12, 1e12).len() <= 8);
    }
}
