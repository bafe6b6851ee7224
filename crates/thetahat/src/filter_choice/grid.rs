//! The filters that are compared.

use crate::preparation::Settings;

/// Filters of one octave.
const PER_OCTAVE: f64 = 2.0;
/// Octaves of the parallel filter below and above the band of the motion.
const OCTAVES: [f64; 2] = [3.0, 2.0];
/// Cut-offs of the position filter in multiples of the parallel filter's, about a factor of the square root of two apart.
const POSITION_FACTORS: [f64; 6] = [0.7, 1.0, 1.4, 2.0, 2.8, 5.6];
/// The parallel filter cuts at this part of the sample rate over the factor.
const DECIMATION_CUT_OFF: f64 = 0.4;
/// Part of the sample rate above which no position filter is proposed.
const HIGHEST_CUT_OFF: f64 = 0.4;

/// A cut-off of the position filter with a decimation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filter {
    /// Cut-off of the position filter, Hz.
    pub cutoff_hz: f64,
    /// Every how many samples one is kept, behind the parallel filter.
    pub decimation: usize,
}

/// Filters to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterGrid {
    /// The filters.
    pub filters: Vec<Filter>,
}

impl FilterGrid {
    /// The filters around a motion below `band_hz` sampled at `sample_rate_hz`: parallel filters from an eighth of the band to
    /// four times it, and for each position filters from 0.7 to 5.6 times that, all below 0.4 of the sample rate.
    #[must_use]
    pub fn around(band_hz: f64, sample_rate_hz: f64) -> Self {
        let steps = ((OCTAVES[0] + OCTAVES[1]) * PER_OCTAVE) as i32;
        let parallel_hz = |i: i32| band_hz * (f64::from(i) / PER_OCTAVE - OCTAVES[0]).exp2();
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

impl Filter {
    /// A position filter at the end of the band of the motion, and a parallel filter at half of it.
    pub(super) fn at_band(band_hz: f64, sample_rate_hz: f64) -> Self {
        let decimation = (2.0 * DECIMATION_CUT_OFF * sample_rate_hz / band_hz).round().max(1.0) as usize;
        Self { cutoff_hz: band_hz.min(HIGHEST_CUT_OFF * sample_rate_hz), decimation }
    }

    /// Settings with the filter.
    pub(super) fn settings(self) -> Settings {
        Settings::new(self.cutoff_hz, self.decimation)
    }

    /// Cut-off of the parallel filter, Hz; half the sample rate where every sample is kept.
    #[must_use]
    pub fn parallel_cutoff_hz(&self, sample_rate_hz: f64) -> f64 {
        match self.decimation {
            1 => 0.5 * sample_rate_hz,
            factor => DECIMATION_CUT_OFF * sample_rate_hz / factor as f64,
        }
    }
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
