//! The band in which a recorded position is motion and not noise.

use std::ops::Range;

use thetahat_estimation::signal::Spectrum;

/// The noise floor is sought between these parts of the sample rate.
const FLOOR: Range<f64> = 0.1..0.48;
/// Bands in it.
const FLOOR_BANDS: usize = 6;
/// Density over that of the noise up to which a band holds noise alone.
const OF_NOISE: f64 = 3.0;
/// The same for a single frequency, whose density is random: one of a million noisy ones is more.
const NOT_BY_CHANCE: f64 = 20.0;
/// Part of the variance of a velocity.
const NEARLY_ALL: f64 = 0.98;
/// Width of a band, part of its lowest frequency.
const WIDTH: f64 = 0.4;
/// Part of the sample rate above which nothing counts as motion.
const HIGHEST: f64 = 0.4;

/// The frequency, Hz, below which nearly all of the variance of a joint's velocity lies that is not noise.
pub(super) fn dynamics_hz(positions: &Spectrum, channel: usize, sample_rate_hz: f64) -> f64 {
    let noise = NOT_BY_CHANCE * floor(positions, channel, sample_rate_hz);
    let velocity = |(f, density): (f64, &f64)| if *density > noise { f * f * density } else { 0.0 };
    let powers: Vec<f64> = positions.frequencies_hz().zip(&positions.density[channel]).map(velocity).collect();
    let wanted = NEARLY_ALL * powers.iter().sum::<f64>();
    let mut sum = 0.0;
    let below = powers.iter().take_while(|power| {
        sum += **power;
        sum < wanted
    });
    (below.count() + 1) as f64 * positions.step_hz
}

/// The noise density of a position: the smallest over several bands.
fn floor(positions: &Spectrum, channel: usize, sample_rate_hz: f64) -> f64 {
    let width = (FLOOR.end - FLOOR.start) / FLOOR_BANDS as f64;
    let start = |i: usize| sample_rate_hz * (FLOOR.start + width * i as f64);
    let floors = (0..FLOOR_BANDS).filter_map(|i| positions.median(channel, start(i)..start(i + 1)));
    floors.fold(f64::INFINITY, f64::min)
}

/// The lowest frequency, Hz, from which on a position is its noise floor; at most 0.4 of the sample rate.
pub(super) fn above_noise_hz(positions: &Spectrum, channel: usize, sample_rate_hz: f64) -> f64 {
    let floor = floor(positions, channel, sample_rate_hz);
    first_band(positions, sample_rate_hz, |band| positions.median(channel, band).is_some_and(|d| d < OF_NOISE * floor))
}

/// The start of the first band that is one of noise; 0.4 of the sample rate where none is.
fn first_band(spectrum: &Spectrum, sample_rate_hz: f64, is_noise: impl Fn(Range<f64>) -> bool) -> f64 {
    let highest = HIGHEST * sample_rate_hz;
    let starts = spectrum.frequencies_hz().skip(2).take_while(|f| *f < highest);
    // A band as wide as three steps at least, so that its median is one of several.
    let band = |start: f64| start..(start * (1.0 + WIDTH)).max(start + 3.5 * spectrum.step_hz);
    starts.into_iter().find(|start| is_noise(band(*start))).unwrap_or(highest)
}
