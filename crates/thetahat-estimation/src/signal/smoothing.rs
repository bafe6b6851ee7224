use std::ops::Range;

use super::{design::SecondOrderSections, error::SignalError, zero_phase::Padding, zero_phase::zero_phase};
use thetahat_ground::series::Series;

/// Steps of the search per octave.
const STEPS_PER_OCTAVE: i32 = 4;
/// Octaves searched below the cut-off.
const OCTAVES: i32 = 4;
/// Largest ratio of the removed rms to the expected noise: beyond it more motion than noise is removed.
const OF_NOISE: f64 = std::f64::consts::SQRT_2;
/// Removed rms that is always allowed, relative to the rms of the motion about its mean.
const OF_MOTION: f64 = 1e-3;

/// Positions low-passed as strongly as the motion allows.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// The positions.
    pub q: Series,
    /// Cut-off of the filter, Hz: each of its two passes is 3 dB down there.
    pub cutoff_hz: f64,
}

/// Smooths recorded positions by the lowest cut-off that removes noise and keeps the motion.
///
/// The filter is Butterworth's, forward and backward: on equal steps its gain `1 / (1 + (f / f_c)^2n)` is that of the
/// smoothing spline that penalises the n-th derivative. `cutoff_hz` is the highest cut-off, `motion` the positions filtered with it. The
/// difference above it is treated as white noise, and gives the noise expected between any two frequencies. A lower cut-off is
/// allowed if, for each joint, the rms of what it removes in `window` is at most sqrt(2) times the noise expected there, or 0.1 % of the
/// rms of the motion about its mean.
///
/// # Errors
/// As [`zero_phase`].
pub fn smooth(
    position: &Series,
    motion: &Series,
    window: &Range<usize>,
    sample_rate_hz: f64,
    filter_order: usize,
    cutoff_hz: f64,
) -> Result<Smoothed, SignalError> {
    let densities = noise_densities(position, motion, window, sample_rate_hz, cutoff_hz);
    let motions: Vec<f64> =
        (0..motion.channels()).map(|j| deviation(&motion.window(window.clone()).channel(j))).collect();
    let mut smoothed = Smoothed { q: motion.clone(), cutoff_hz };
    for step in 1..=OCTAVES * STEPS_PER_OCTAVE {
        let lower = cutoff_hz * (-f64::from(step) / f64::from(STEPS_PER_OCTAVE)).exp2();
        let filter = SecondOrderSections::butterworth_lowpass(filter_order, lower, sample_rate_hz)?;
        let q = zero_phase(&filter, position, Padding::Matlab)?;
        let taken = rms_differences(motion, &q, window);
        let allowed = |j: usize| (OF_NOISE * (densities[j] * (cutoff_hz - lower)).sqrt()).max(OF_MOTION * motions[j]);
        if taken.iter().enumerate().any(|(j, taken)| *taken > allowed(j)) {
            break;
        }
        smoothed = Smoothed { q, cutoff_hz: lower };
    }
    Ok(smoothed)
}

/// Noise variance per Hz above the cut-off, per channel.
pub fn noise_densities(
    position: &Series,
    motion: &Series,
    window: &Range<usize>,
    rate: f64,
    cutoff_hz: f64,
) -> Vec<f64> {
    densities_of_squares(&squared_differences(position, motion, window), window.len(), rate, cutoff_hz)
}

/// [`noise_densities`] from the sums of squares of what the filter removes over `samples` samples.
#[doc(hidden)]
pub fn densities_of_squares(squares: &[f64], samples: usize, rate: f64, cutoff_hz: f64) -> Vec<f64> {
    let above = 0.5 * rate - cutoff_hz;
    squares.iter().map(|s| s / samples as f64 / above).collect()
}

/// The sum of the squares of the difference of each channel in a window.
#[doc(hidden)]
pub fn squared_differences(a: &Series, b: &Series, window: &Range<usize>) -> Vec<f64> {
    let mut squares = vec![0.0; a.channels()];
    for k in window.clone() {
        squares.iter_mut().zip(a.sample(k).iter().zip(b.sample(k))).for_each(|(s, (a, b))| *s += (a - b).powi(2));
    }
    squares
}

fn rms_differences(a: &Series, b: &Series, window: &Range<usize>) -> Vec<f64> {
    squared_differences(a, b, window).iter().map(|s| (s / window.len() as f64).sqrt()).collect()
}

fn deviation(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 500.0;
    const CUTOFF_HZ: f64 = 40.0;

    /// A motion of 1 and `highest_hz` Hz with noise of a standard deviation.
    fn record(highest_hz: f64, noise: f64) -> Series {
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let wave = |t: f64| (6.0 * t).sin() + 0.1 * (std::f64::consts::TAU * highest_hz * t).cos();
        let values = (0..10_000).map(|k| wave(f64::from(k) / RATE_HZ) + noise * 12_f64.sqrt() * uniform()).collect();
        Series::shaped(1, values)
    }

    fn cutoff_of(highest_hz: f64, noise: f64) -> f64 {
        let record = record(highest_hz, noise);
        let filter = SecondOrderSections::butterworth_lowpass(4, CUTOFF_HZ, RATE_HZ).unwrap();
        let motion = zero_phase(&filter, &record, Padding::Matlab).unwrap();
        smooth(&record, &motion, &(500..9500), RATE_HZ, 4, CUTOFF_HZ).unwrap().cutoff_hz
    }

    #[test]
    fn the_cut_off_stays_above_the_motion() {
        for noise in [0.0, 1e-4, 1e-3] {
            let (slow, fast) = (cutoff_of(3.0, noise), cutoff_of(12.0, noise));
            assert!((4.0..=10.0).contains(&slow), "{noise}: {slow}");
            assert!((14.0..=40.0).contains(&fast), "{noise}: {fast}");
        }
    }
}
