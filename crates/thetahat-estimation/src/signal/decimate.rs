//! Decimation: low-pass filtering and keeping every n-th sample.

use std::ops::Range;

use thetahat_ground::series::Series;

use super::design::SecondOrderSections;
use super::error::SignalError;
use super::forward_backward::Kept;
use super::join::{Joined, filter_and_keep, pieces};
use super::pieces::{DecimatedPiece, Extension, PiecePass, Record};
use super::pole_sums::PoleSums;
use super::zero_phase::{Padding, zero_phase};

const ORDER: usize = 8;
const RIPPLE_DB: f64 = 0.05;
/// The cut-off times the factor, over the Nyquist frequency.
const CUTOFF_FRACTION: f64 = 0.8;

/// Decimation by a factor as MATLAB's `decimate(x, factor)`, of all channels alike.
///
/// The filter is a Chebyshev low-pass of type I, order 8, ripple 0.05 dB, cut-off `0.8 / factor` of the Nyquist
/// frequency, run forward and backward with an odd extension of 24 samples. Of `n` samples, `ceil(n / factor)` are
/// kept such that the last one kept is the recording's last. The two passes have the gain `10^(-0.005) = 0.989` at DC,
/// the same for every channel: it cancels in a regression where both sides are decimated (the "decimate" process with
/// the parallel filter `F_p`; Brunot, Janot, Carrillo and Garnier, "Comparison between the IDIM-IV method and the DIDIM
/// method for industrial robots identification", section III-A). Factor 1 filters nothing and keeps every sample.
///
/// The sections are used as such: MATLAB's polynomial form of the same filter loses its digits from factor 13 on.
///
/// ```
/// use thetahat_estimation::signal::Decimator;
/// use thetahat_ground::series::Series;
/// let decimator = Decimator::new(10, 95)?;
/// assert_eq!(decimator.kept().collect::<Vec<_>>(), [4, 14, 24, 34, 44, 54, 64, 74, 84, 94]);
/// assert_eq!(decimator.decimate(&Series::zeros(95, 3))?.len(), decimator.rows());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Decimator {
    samples: usize,
    kept: Kept,
    filter: Option<ParallelFilter>,
    /// Samples that are left out.
    gaps: Vec<Range<usize>>,
    /// Row indices that are kept, among the rows of a recording without gaps; none if all are.
    rows: Option<Vec<usize>>,
    extension: Extension,
}

/// The parallel filter: as sections, which give every sample, and as sums over poles, which give the kept samples.
#[derive(Debug, Clone, PartialEq)]
struct ParallelFilter {
    sections: SecondOrderSections,
    sums: PoleSums,
}

impl Decimator {
    /// The decimation of recordings of `samples` samples by `factor`.
    ///
    /// # Errors
    /// If the factor is zero or the recording is not longer than the padding of 24 samples (empty, for factor 1).
    pub fn new(factor: usize, samples: usize) -> Result<Self, SignalError> {
        if factor == 0 {
            return Err(SignalError::InvalidFactor { factor });
        }
        let needed = if factor == 1 { 1 } else { Padding::Matlab.samples(ORDER) + 1 };
        if samples < needed {
            return Err(SignalError::RecordTooShort { needed, found: samples });
        }
        let kept = Kept { first: (samples - 1) % factor, step: factor };
        let (filter, extension) = (low_pass(factor)?, Extension::Odd(Padding::Matlab.samples(ORDER)));
        Ok(Self { samples, kept, filter, gaps: Vec::new(), rows: None, extension })
    }

    /// The decimation with some samples left out, in rising ranges. Within such a range every channel continues at the mean of its last
    /// samples before it, so that sums of channels stay sums. No row lies within the ranges.
    #[must_use]
    pub fn leaving_out(self, gaps: &[Range<usize>]) -> Self {
        let is_used =
            |k: &usize| !gaps.get(gaps.partition_point(|gap| gap.end <= *k)).is_some_and(|gap| gap.contains(k));
        let kept = self.kept.indices(self.samples).enumerate();
        let rows = (!gaps.is_empty()).then(|| kept.filter(|(_, k)| is_used(k)).map(|(row, _)| row).collect());
        Self { gaps: gaps.to_vec(), rows, ..self }
    }

    /// The decimation of recordings that are zero before their first and after their last sample. MATLAB's odd extension makes the rows at
    /// the ends nearly the values of single samples, with their noise, while the other rows are low-passed. Zeros keep sums of channels
    /// sums.
    #[must_use]
    pub fn with_zero_padding(self) -> Self {
        Self { extension: Extension::Zero, ..self }
    }

    /// The filter's gain for a constant.
    #[must_use]
    pub fn constant_gain(&self) -> f64 {
        if self.filter.is_some() { 10_f64.powf(-2.0 * RIPPLE_DB / 20.0) } else { 1.0 }
    }

    /// The indices of the kept samples, rising; the last one is the recording's last, unless it is left out.
    pub fn kept(&self) -> impl Iterator<Item = usize> {
        let Kept { first, step } = self.kept;
        (0..self.rows()).map(move |row| first + step * self.rows.as_ref().map_or(row, |rows| rows[row]))
    }

    /// The number of kept samples, `ceil(samples / factor)` less those left out.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows.as_ref().map_or_else(|| self.samples.div_ceil(self.kept.step), Vec::len)
    }

    /// The samples [`Self::kept`] of the filtered series.
    ///
    /// # Errors
    /// If the series does not have the announced number of samples.
    pub fn decimate(&self, series: &Series) -> Result<Series, SignalError> {
        if series.len() != self.samples {
            return Err(SignalError::LengthMismatch { expected: self.samples, found: series.len() });
        }
        self.decimate_computed(series.channels(), |k, sample| sample.copy_from_slice(series.sample(k)))
    }

    /// [`Self::decimate`] of a series that is computed and not stored: `fill` is called for each sample in order and writes its channels.
    ///
    /// # Errors
    /// None for a decimator that was built successfully.
    pub fn decimate_computed(
        &self,
        channels: usize,
        mut fill: impl FnMut(usize, &mut [f64]),
    ) -> Result<Series, SignalError> {
        let Some(rows) = &self.rows else { return Ok(self.all_rows(channels, fill)) };
        let mut bridge = Bridge::new(&self.gaps, channels, self.kept.step);
        let all = self.all_rows(channels, |k, sample| {
            fill(k, sample);
            bridge.pass(k, sample);
        });
        let values = rows.iter().flat_map(|&row| all.sample(row)).copied().collect();
        Ok(Series::shaped(channels, values))
    }

    /// The rows of a recording without gaps.
    fn all_rows(&self, channels: usize, mut fill: impl FnMut(usize, &mut [f64])) -> Series {
        if let Some(filter) = &self.filter {
            let record = Record { samples: self.samples, channels, extension: self.extension };
            return filter_and_keep(&filter.sums, record, self.kept, fill);
        }
        let mut series = Series::zeros(self.samples, channels);
        (0..self.samples).for_each(|k| fill(k, series.sample_mut(k)));
        series
    }

    /// Ranges of at least `rows` rows, which can be decimated one by one. The recording must have no samples that are left out.
    #[must_use]
    pub fn pieces(&self, rows: usize) -> Vec<Range<usize>> {
        pieces(self.rows(), rows.max(Padding::Matlab.samples(ORDER) + 1))
    }

    /// The samples of a piece: from the sample after the last kept one of the piece before, to its own last kept one.
    #[must_use]
    pub fn samples_of(&self, piece: &Range<usize>) -> Range<usize> {
        let end = |row: usize| if row == 0 { 0 } else { self.kept.first + (row - 1) * self.kept.step + 1 };
        end(piece.start)..end(piece.end)
    }

    /// One of [`Self::pieces`], decimated without its neighbours. `fill` writes samples of the recording as in
    /// [`Self::decimate_computed`], and is asked only for [`Self::samples_of`] the piece.
    ///
    /// # Errors
    /// None for a decimator that was built successfully.
    pub fn decimate_piece(
        &self,
        piece: Range<usize>,
        channels: usize,
        mut fill: impl FnMut(usize, &mut [f64]),
    ) -> Result<DecimatedPiece, SignalError> {
        if let Some(filter) = &self.filter {
            let record = Record { samples: self.samples, channels, extension: self.extension };
            return Ok(PiecePass::new(&filter.sums, record, self.kept, fill).run(piece));
        }
        let mut rows = Series::zeros(piece.len(), channels);
        piece.enumerate().for_each(|(row, k)| fill(k, rows.sample_mut(row)));
        Ok(DecimatedPiece::of_samples(rows))
    }

    /// Joins pieces, given in order, into the rows of [`Self::decimate`].
    #[must_use]
    pub fn joiner(&self) -> Joiner<'_> {
        Joiner(self.filter.as_ref().map(|filter| Joined::new(&filter.sums, self.rows())))
    }

    /// All samples of the series filtered with an odd extension, of which [`Self::decimate`] with that extension keeps some. The length is
    /// free, so that the filter can be probed.
    ///
    /// # Errors
    /// If the series is not longer than the padding.
    pub fn filter(&self, series: &Series) -> Result<Series, SignalError> {
        let mut series = series.clone();
        let mut bridge = Bridge::new(&self.gaps, series.channels(), self.kept.step);
        (0..series.len()).for_each(|k| bridge.pass(k, series.sample_mut(k)));
        match &self.filter {
            Some(filter) => zero_phase(&filter.sections, &series, Padding::Matlab),
            None => Ok(series),
        }
    }
}

/// Replaces samples that are left out by the mean of the last ones before, channel by channel.
struct Bridge<'a> {
    gaps: &'a [Range<usize>],
    mean: Vec<f64>,
    seen: usize,
    /// Number of samples in the mean.
    length: usize,
}

impl<'a> Bridge<'a> {
    fn new(gaps: &'a [Range<usize>], channels: usize, length: usize) -> Self {
        Self { gaps, mean: vec![0.0; channels], seen: 0, length }
    }

    /// Receives the samples in order.
    fn pass(&mut self, k: usize, sample: &mut [f64]) {
        while self.gaps.first().is_some_and(|gap| gap.end <= k) {
            self.gaps = &self.gaps[1..];
        }
        if self.gaps.first().is_some_and(|gap| gap.contains(&k)) {
            sample.copy_from_slice(&self.mean);
            return;
        }
        self.seen = (self.seen + 1).min(self.length);
        let part = 1.0 / self.seen as f64;
        self.mean.iter_mut().zip(sample).for_each(|(mean, value)| *mean += part * (*value - *mean));
    }
}

/// Joins the pieces of a recording into its rows: [`Decimator::joiner`].
///
/// The rows of a piece are complete once the samples after it are known up to the filter's look-ahead.
#[derive(Debug)]
pub struct Joiner<'a>(Option<Joined<'a>>);

impl Joiner<'_> {
    /// Receives the next piece and returns the rows of the pieces that it completes. The last piece completes all.
    pub fn take(&mut self, piece: DecimatedPiece) -> Vec<Series> {
        match &mut self.0 {
            Some(joined) => joined.take(piece),
            None => vec![piece.rows],
        }
    }
}

/// The parallel filter; none for factor 1.
fn low_pass(factor: usize) -> Result<Option<ParallelFilter>, SignalError> {
    if factor == 1 {
        return Ok(None);
    }
    // At a sample rate of 2 the Nyquist frequency is 1.
    let cutoff = CUTOFF_FRACTION / factor as f64;
    let sections = SecondOrderSections::chebyshev1_lowpass(ORDER, RIPPLE_DB, cutoff, 2.0)?;
    let sums = PoleSums::new(&sections).ok_or(SignalError::InvalidFactor { factor })?;
    Ok(Some(ParallelFilter { sections, sums }))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn the_last_sample_kept_is_the_last() -> Result<(), SignalError> {
        for samples in 25..80 {
            for factor in [1, 2, 3, 7, 100] {
                let decimator = Decimator::new(factor, samples)?;
                let kept: Vec<usize> = decimator.kept().collect();
                // MATLAB's start index, counted from 0.
                assert_eq!(kept[0], factor - (factor * samples.div_ceil(factor) - samples) - 1);
                assert_eq!(kept.last(), Some(&(samples - 1)));
                assert_eq!(kept.len(), decimator.rows());
            }
        }
        Ok(())
    }

    #[test]
    fn decimating_is_filtering_and_keeping() -> Result<(), SignalError> {
        let series = Series::shaped(3, (0..900).map(|k| (f64::from(k) * 0.7).sin() + f64::from(k % 3)).collect());
        let decimator = Decimator::new(7, 300)?;
        let (decimated, filtered) = (decimator.decimate(&series)?, decimator.filter(&series)?);
        for (row, k) in decimator.kept().enumerate() {
            for (d, f) in std::iter::zip(decimated.sample(row), filtered.sample(k)) {
                assert!((d - f).abs() < 1e-11, "{d} {f}");
            }
        }
        Ok(())
    }

    /// The sums over poles equal the two recursions at every factor, also for recordings barely longer than the padding and for values far
    /// from zero.
    #[test]
    fn sums_over_poles_are_the_two_recursions() -> Result<(), SignalError> {
        for (factor, samples) in [(2, 25), (2, 400), (7, 31), (10, 1000), (100, 90), (100, 7001), (1000, 5000)] {
            let value = |k: usize| 50.0 + (k as f64 * 0.37).sin() + ((k * k) % 17) as f64 + k as f64 * 1e-3;
            let series = Series::shaped(3, (0..3 * samples).map(value).collect());
            let decimator = Decimator::new(factor, samples)?;
            let (decimated, filtered) = (decimator.decimate(&series)?, decimator.filter(&series)?);
            for (row, k) in decimator.kept().enumerate() {
                for (d, f) in std::iter::zip(decimated.sample(row), filtered.sample(k)) {
                    assert!((d - f).abs() < 1e-10 * f.abs(), "factor {factor}, sample {k} of {samples}: {d} {f}");
                }
            }
        }
        Ok(())
    }

    /// Joined pieces equal the whole recording for any piece length, shorter or longer than the filter's look-ahead.
    #[test]
    fn pieces_put_together_are_the_whole() -> Result<(), SignalError> {
        for (factor, samples, rows) in [(1, 300, 60), (2, 3001, 25), (10, 9999, 30), (10, 9999, 333), (100, 60_003, 50)]
        {
            let value = |k: usize| 50.0 + (k as f64 * 0.37).sin() + ((k * k) % 17) as f64 + k as f64 * 1e-3;
            let series = Series::shaped(3, (0..3 * samples).map(value).collect());
            let decimator = Decimator::new(factor, samples)?;
            let (whole, mut joiner) = (decimator.decimate(&series)?, decimator.joiner());
            let mut joined: Vec<f64> = Vec::new();
            for piece in decimator.pieces(rows) {
                let own = decimator.samples_of(&piece);
                let piece = decimator.decimate_piece(piece, 3, |k, sample| {
                    assert!(own.contains(&k), "sample {k} of {own:?}");
                    sample.copy_from_slice(series.sample(k));
                })?;
                joiner.take(piece).iter().for_each(|rows| joined.extend(rows.values()));
            }
            assert_eq!(joined.len(), whole.values().len());
            for (j, w) in joined.iter().zip(whole.values()) {
                assert!((j - w).abs() < 1e-12 * w.abs(), "factor {factor}, pieces of {rows}: {j} {w}");
            }
        }
        Ok(())
    }

    /// A recording of more rows than are one piece, and the same as one piece.
    #[test]
    fn a_long_recording_in_pieces_is_the_whole() -> Result<(), SignalError> {
        for extension in [Decimator::new(3, 30_001)?, Decimator::new(3, 30_001)?.with_zero_padding()] {
            let value = |k: usize| 50.0 + (k as f64 * 0.037).sin() + ((k * k) % 17) as f64;
            let series = Series::shaped(2, (0..60_002).map(value).collect());
            let all = 0..extension.rows();
            let one = extension.decimate_piece(all, 2, |k, sample| sample.copy_from_slice(series.sample(k)))?;
            let one: Vec<f64> = extension.joiner().take(one).into_iter().flat_map(Series::into_values).collect();
            let found = extension.decimate(&series)?;
            assert_eq!((found.len(), found.values().len()), (10_001, one.len()));
            assert!(one.iter().zip(found.values()).all(|(a, b)| (a - b).abs() < 1e-12 * a.abs()));
        }
        Ok(())
    }

    /// Many zeros before and after the recording, where the extension of their ends no longer matters.
    #[test]
    fn zeros_beyond_the_ends_are_zeros() -> Result<(), SignalError> {
        for (factor, samples, rows) in [(2, 25, 40), (10, 999, 30), (100, 3001, 50)] {
            let margin = 200 * factor;
            let value = |k: usize| 50.0 + (k as f64 * 0.37).sin() + ((k * k) % 17) as f64;
            let decimator = Decimator::new(factor, samples)?.with_zero_padding();
            let found = decimator.decimate_computed(1, |k, sample| sample[0] = value(k))?;
            let of_padded = |k: usize| k.checked_sub(margin).filter(|k| *k < samples).map_or(0.0, value);
            let padded = Series::shaped(1, (0..samples + 2 * margin).map(of_padded).collect());
            let padded = Decimator::new(factor, padded.len())?.filter(&padded)?;
            let (mut joiner, mut joined) = (decimator.joiner(), Vec::new());
            for piece in decimator.pieces(rows) {
                let piece = decimator.decimate_piece(piece, 1, |k, sample| sample[0] = value(k))?;
                joiner.take(piece).iter().for_each(|rows| joined.extend(rows.values().iter().copied()));
            }
            for ((row, k), piecewise) in decimator.kept().enumerate().zip(joined) {
                let (row, expected) = (found.sample(row)[0], padded.sample(margin + k)[0]);
                assert!((row - expected).abs() < 1e-9, "factor {factor}, sample {k} of {samples}: {row} {expected}");
                assert!((row - piecewise).abs() < 1e-9);
            }
        }
        Ok(())
    }

    #[test]
    fn factor_1_keeps_the_series() -> Result<(), SignalError> {
        let series = Series::shaped(2, (0..10).map(f64::from).collect());
        let decimator = Decimator::new(1, 5)?;
        assert_eq!(decimator.decimate(&series)?, series);
        assert_eq!(decimator.filter(&series)?, series);
        Ok(())
    }

    #[test]
    fn a_sine_below_the_cutoff_stays_a_sine() -> Result<(), SignalError> {
        let (factor, samples) = (5, 4000);
        let w = 2.0 * PI * 0.01;
        let sine = Series::shaped(1, (0..samples).map(|k| (w * k as f64).sin()).collect());
        let decimator = Decimator::new(factor, samples)?;
        let decimated = decimator.decimate(&sine)?.channel(0);
        let gain = low_pass(factor)?.map_or(1.0, |filter| filter.sections.gain(2.0 * 0.01).powi(2));
        // The ends keep a transient; inside it has died out.
        for (y, k) in std::iter::zip(decimated, decimator.kept()).skip(300).take(200) {
            assert!((y - gain * (w * k as f64).sin()).abs() < 1e-11);
        }
        Ok(())
    }

    #[test]
    fn a_sine_above_the_cutoff_is_gone() -> Result<(), SignalError> {
        let sine = Series::shaped(1, (0..4000).map(|k| (2.0 * PI * 0.4 * f64::from(k)).sin()).collect());
        let decimated = Decimator::new(5, 4000)?.decimate(&sine)?.channel(0);
        assert!(decimated[300..500].iter().all(|y| y.abs() < 1e-11));
        Ok(())
    }

    #[test]
    fn factor_0_is_refused() {
        assert_eq!(Decimator::new(0, 100), Err(SignalError::InvalidFactor { factor: 0 }));
    }

    #[test]
    fn a_recording_as_short_as_the_padding_is_refused() {
        assert_eq!(Decimator::new(2, 24), Err(SignalError::RecordTooShort { needed: 25, found: 24 }));
        assert_eq!(Decimator::new(1, 0), Err(SignalError::RecordTooShort { needed: 1, found: 0 }));
    }

    #[test]
    fn a_recording_of_another_length_is_refused() -> Result<(), SignalError> {
        let result = Decimator::new(2, 100)?.decimate(&Series::zeros(99, 1));
        assert_eq!(result, Err(SignalError::LengthMismatch { expected: 100, found: 99 }));
        Ok(())
    }

    /// Sums of channels stay sums, also next to samples that are left out and hold arbitrary values.
    #[test]
    fn sums_of_channels_stay_sums_next_to_gaps() -> Result<(), SignalError> {
        let gaps = [40..55, 130..131, 390..500];
        for factor in [1, 10] {
            let decimator = Decimator::new(factor, 500)?.leaving_out(&gaps);
            let value = |k: usize, c: usize| ((0.03 + 0.02 * c as f64) * k as f64).sin() + 0.1 * c as f64;
            let sample = |k: usize| {
                let (a, b) = (value(k, 0), value(k, 1));
                if gaps.iter().any(|gap| gap.contains(&k)) { [1e6, -3.0, 7.0] } else { [a, b, 2.0 * a - 3.0 * b] }
            };
            let rows = decimator.decimate_computed(3, |k, s| s.copy_from_slice(&sample(k)))?;
            assert_eq!((rows.len(), decimator.kept().count()), (decimator.rows(), decimator.rows()));
            assert!(decimator.kept().all(|k| !gaps.iter().any(|gap| gap.contains(&k))));
            for row in 0..rows.len() {
                let [a, b, sum] = [0, 1, 2].map(|c| rows.sample(row)[c]);
                assert!((sum - (2.0 * a - 3.0 * b)).abs() < 1e-9 && a.abs() < 2.0, "{factor} {row}");
            }
        }
        Ok(())
    }
}
