//! The filters that are compared.

use crate::preparation::{PositionFilter, SignalOptions};
use thetahat_report::results::Filter;

impl SignalOptions {
    /// The cut-off with the decimation; none if the smoother finds the cut-off.
    #[must_use]
    pub fn filter(&self) -> Option<Filter> {
        let filter = Filter { cutoff_hz: self.cutoff_hz, decimation: self.decimation };
        (self.position == PositionFilter::Butterworth).then_some(filter)
    }
}

/// Filters of one octave.
const PER_OCTAVE: f64 = 2.0;
/// Octaves of the parallel filter below and above the dynamics. Further above, flexible joints and the ripple of gears decide.
const OCTAVES: [f64; 2] = [1.5, 3.5];
/// Cut-offs of the position filter in multiples of the parallel filter's.
const POSITION_FACTORS: [f64; 6] = [0.7, 1.0, 1.4, 2.0, 2.8, 4.0];
/// The parallel filter cuts at this part of the sample rate over the factor.
const DECIMATION_CUT_OFF: f64 = 0.4;
/// Part of the sample rate above which no position filter is proposed.
const HIGHEST_CUT_OFF: f64 = 0.4;

/// Filters to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterGrid {
    /// The filters.
    pub filters: Vec<Filter>,
}

impl FilterGrid {
    /// The filters for dynamics of some frequency, sampled at `sample_rate_hz`: parallel filters from a third of the frequency to
    /// eleven times it, and for each position filters from 0.7 to 4 times that, all below 0.4 of the sample rate.
    #[must_use]
    pub fn around(dynamics_hz: f64, sample_rate_hz: f64) -> Self {
        let steps = ((OCTAVES[0] + OCTAVES[1]) * PER_OCTAVE) as i32;
        let parallel_hz = |i: i32| dynamics_hz * (f64::from(i) / PER_OCTAVE - OCTAVES[0]).exp2();
        let decimation = |i: i32| (DECIMATION_CUT_OFF * sample_rate_hz / parallel_hz(i)).round().max(1.0) as usize;
        let mut decimations: Vec<usize> = (0..=steps).map(decimation).collect();
        decimations.dedup();
        let of_decimation = |decimation: usize| {
            let parallel_hz = DECIMATION_CUT_OFF * sample_rate_hz / decimation as f64;
            let lower = if decimation == 1 { &[0.125, 0.18, 0.25, 0.35, 0.5][..] } else { &[] };
            let factors = lower.iter().chain(&POSITION_FACTORS);
            let cutoffs = factors.map(move |factor| two_digits(factor * parallel_hz));
            let below = cutoffs.filter(move |f| *f <= HIGHEST_CUT_OFF * sample_rate_hz);
            below.map(move |cutoff_hz| Filter { cutoff_hz, decimation })
        };
        Self { filters: decimations.into_iter().flat_map(of_decimation).collect() }
    }
}

/// The filters for motion and torques below a frequency: a position filter at five times it and a parallel filter at twice it
/// (Brunot and others, section V-A).
pub(super) fn for_dynamics(dynamics_hz: f64, sample_rate_hz: f64) -> Filter {
    let decimation = (DECIMATION_CUT_OFF * sample_rate_hz / (2.0 * dynamics_hz)).round().max(1.0) as usize;
    Filter { cutoff_hz: (5.0 * dynamics_hz).min(HIGHEST_CUT_OFF * sample_rate_hz), decimation }
}

/// A number with two digits that count.
fn two_digits(value: f64) -> f64 {
    let unit = 10_f64.powf(value.log10().floor() - 1.0);
    // A division by a power of ten rounds to the shortest decimal, where a product would leave 0.1 + 0.2.
    if unit < 1.0 { (value / unit).round() / (1.0 / unit).round() } else { (value / unit).round() * unit }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, short) in [(123.4, 120.0), (0.0376, 0.038), (7.77, 7.8), (0.999, 1.0)] {
            assert_eq!(two_digits(value), short);
        }
    }

    #[test]
    fn a_slow_record_has_position_filters_below_its_half_rate() {
        let grid = FilterGrid::around(5.0, 30.0);
        assert!(grid.filters.iter().all(|f| f.cutoff_hz <= 12.0 && f.decimation >= 1));
        assert!(grid.filters.iter().any(|f| f.decimation == 1 && f.cutoff_hz < 3.0));
    }
}
