//! Small statistics for the checks.

use crate::statistics::quantile;

/// The mean.
pub(super) fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len().max(1) as f64
}

/// Root mean square.
pub(super) fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|v| v * v).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

/// Standard deviation about the mean.
pub(super) fn deviation(x: &[f64]) -> f64 {
    let mean = mean(x);
    (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

/// Largest value minus smallest.
pub(super) fn span(x: &[f64]) -> f64 {
    let (low, high) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    (high - low).max(0.0)
}

/// The quantile of absolute values at `part` from 0 to 1; zero without values.
pub(super) fn quantile_abs(x: impl Iterator<Item = f64>, part: f64) -> f64 {
    quantile(&x.map(f64::abs).collect::<Vec<_>>(), part)
}

/// Normal standard deviation per median of absolute values.
pub(super) const NORMAL_PER_MEDIAN: f64 = 1.4826;

/// Correlation coefficient about the means; zero if one of the two is constant.
pub(super) fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let (ma, mb) = (mean(a), mean(b));
    let covariance = a.iter().zip(b).map(|(a, b)| (a - ma) * (b - mb)).sum::<f64>() / a.len().max(1) as f64;
    let size = deviation(a) * deviation(b);
    if size > 0.0 { covariance / size } else { 0.0 }
}

/// Correlation of a series with itself one sample later; zero if it is too short.
pub(super) fn autocorrelation(x: &[f64]) -> f64 {
    if x.len() < FEWEST { 0.0 } else { correlation(&x[1..], &x[..x.len() - 1]) }
}

/// Blocks of time.
const BLOCKS: usize = 10;

/// Root of the sum of squares, over blocks of time, of the product of two vectors within a block: the standard deviation of
/// `dot(a, e)` for errors that are correlated within a block. The vectors have `rows` rows for each joint.
pub(super) fn block_score(a: &[f64], e: &[f64], rows: usize) -> f64 {
    let mut score = [0.0; BLOCKS];
    for (i, (a, e)) in a.iter().zip(e).enumerate() {
        score[(i % rows) * BLOCKS / rows] += a * e;
    }
    rms(&score) * (BLOCKS as f64).sqrt()
}

/// Fewest samples for a delay or an autocorrelation.
const FEWEST: usize = 8;

/// The delay in samples by which `a` is later than `b`, to a fraction of a sample: the minimum of the parabola through the
/// smallest sum of squared differences within `reach`. `None` if the smallest sum is at the end of the range.
pub(super) fn delay(a: &[f64], b: &[f64], reach: usize) -> Option<f64> {
    if a.len() < FEWEST {
        return None;
    }
    let reach = reach.clamp(1, a.len() / 4) as isize;
    let (inside, stride) = (reach as usize..a.len() - reach as usize, (a.len() / 4000).max(1));
    let mismatch = |shift: isize| -> f64 {
        inside.clone().step_by(stride).map(|k| (a[(k as isize + shift) as usize] - b[k]).powi(2)).sum()
    };
    let best = (-reach..=reach).map(|s| (s, mismatch(s))).min_by(|x, y| x.1.total_cmp(&y.1)).map_or(0, |b| b.0);
    if best.abs() == reach {
        return None;
    }
    let [before, at, after] = [-1, 0, 1].map(|d| mismatch(best + d));
    let curvature = before - 2.0 * at + after;
    Some(best as f64 + if curvature > 0.0 { 0.5 * (before - after) / curvature } else { 0.0 })
}

/// Differences below this part of the span are rounding.
const ROUNDING: f64 = 1e-12;
/// Largest deviation of a difference from a whole number of steps, in steps.
const OFF_GRID: f64 = 0.02;
/// Smallest part of the differences that must be whole numbers of steps.
const ON_GRID: f64 = 0.9;

/// The step of a quantised signal; `None` if the signal is not quantised.
pub(super) fn step_of(x: &[f64]) -> Option<f64> {
    let smallest = ROUNDING * span(x);
    let differences = || x.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > smallest);
    let step = differences().fold(f64::INFINITY, f64::min);
    let is_on_grid = |d: &f64| (d / step - (d / step).round()).abs() < OFF_GRID;
    let (all, on) = (differences().count(), differences().filter(is_on_grid).count());
    (all > 0 && on as f64 >= ON_GRID * all as f64).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_delay_is_found_to_a_hundredth_of_a_sample() {
        let wave = |t: f64| (0.05 * t).sin() + 0.3 * (0.13 * t).cos();
        let b: Vec<f64> = (0..500).map(|k| wave(f64::from(k))).collect();
        for expected in [-7.4, -0.3, 0.0, 2.6] {
            let a: Vec<f64> = (0..500).map(|k| wave(f64::from(k) - expected)).collect();
            let found = delay(&a, &b, 20).unwrap();
            assert!((found - expected).abs() < 0.01, "{expected}: {found}");
        }
    }

    #[test]
    fn a_delay_beyond_the_range_is_none() {
        let ramp = |late: f64| (0..500).map(|k| (0.01 * (f64::from(k) - late)).tanh()).collect::<Vec<_>>();
        assert_eq!(delay(&ramp(60.0), &ramp(0.0), 20), None);
    }

    #[test]
    fn quantiles_of_sizes() {
        let x = [-3.0, 1.0, 2.0, -5.0, 4.0];
        assert_eq!(quantile_abs(x.into_iter(), 0.5), 3.0);
        assert_eq!(quantile_abs(x.into_iter(), 1.0), 5.0);
        assert_eq!(quantile_abs([].into_iter(), 0.5), 0.0);
    }

    #[test]
    fn the_step_of_a_rounded_signal_is_found_and_a_smooth_one_has_none() {
        let wave: Vec<f64> = (0..2000).map(|k| (0.01 * f64::from(k)).sin()).collect();
        let rounded: Vec<f64> = wave.iter().map(|v| (v / 0.003).round() * 0.003).collect();
        assert!((step_of(&rounded).unwrap() - 0.003).abs() < 1e-12);
        assert_eq!(step_of(&wave), None);
        assert_eq!(step_of(&[1.0; 10]), None);
    }
}
