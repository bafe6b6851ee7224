//! The band in which a recorded position is motion and not noise.

use std::ops::Range;

use crate::signal::Spectrum;

/// The noise floor is sought between these parts of the sample rate.
const FLOOR: Range<f64> = 0.1..0.48;
/// Bands in it.
const FLOOR_BANDS: usize = 6;
/// Density over that of the noise up to which a band holds noise alone.
const OF_NOISE: f64 = 3.0;
/// Width of a band, part of its lowest frequency.
const WIDTH: f64 = 0.4;
/// Part of the sample rate above which nothing counts as motion.
const HIGHEST: f64 = 0.4;
/// Part of the torque's density that the model leaves unexplained, up to which motion and torque belong together.
const UNEXPLAINED: f64 = 0.8;

/// The lowest frequency, Hz, from which on a position is its noise floor; at most 0.4 of the sample rate.
pub(super) fn above_noise_hz(positions: &Spectrum, channel: usize, sample_rate_hz: f64) -> f64 {
    let width = (FLOOR.end - FLOOR.start) / FLOOR_BANDS as f64;
    let band = |i: usize| FLOOR.start + width * i as f64..FLOOR.start + width * (i + 1) as f64;
    let in_hz = |band: Range<f64>| band.start * sample_rate_hz..band.end * sample_rate_hz;
    let floors = (0..FLOOR_BANDS).filter_map(|i| positions.median(channel, in_hz(band(i))));
    let floor = floors.fold(f64::INFINITY, f64::min);
    first_band(positions, sample_rate_hz, |band| positions.median(channel, band).is_some_and(|d| d < OF_NOISE * floor))
}

/// The lowest frequency, Hz, above which the model explains little of a torque: `left` is what it leaves of `torque`.
pub(super) fn coherent_hz(torque: &Spectrum, left: &Spectrum, channel: usize, sample_rate_hz: f64) -> f64 {
    first_band(torque, sample_rate_hz, |band| {
        let medians = (left.median(channel, band.clone()), torque.median(channel, band));
        matches!(medians, (Some(left), Some(torque)) if left > UNEXPLAINED * torque)
    })
}

/// The start of the first band that is one of noise; 0.4 of the sample rate where none is.
fn first_band(spectrum: &Spectrum, sample_rate_hz: f64, is_noise: impl Fn(Range<f64>) -> bool) -> f64 {
    let highest = HIGHEST * sample_rate_hz;
    let starts = spectrum.frequencies_hz().skip(2).take_while(|f| *f < highest);
    // A band as wide as three steps at least, so that its median is one of several.
    let band = |start: f64| start..(start * (1.0 + WIDTH)).max(start + 3.5 * spectrum.step_hz);
    starts.into_iter().find(|start| is_noise(band(*start))).unwrap_or(highest)
}
