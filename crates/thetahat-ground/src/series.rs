//! Equally sampled channels: the one container for time series.
//!
//! ```
//! use thetahat_ground::series::Series;
//! let series = Series::from_channels(&[vec![0.0, 1.0, 2.0], vec![5.0, 6.0, 7.0]])?;
//! assert_eq!(series.sample(1), [1.0, 6.0]);
//! assert_eq!(series.channel(1), [5.0, 6.0, 7.0]);
//! assert_eq!(series.window(1..3).len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::ops::Range;

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Why values are no series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SeriesError {
    /// There is no channel.
    #[error("expected a series of at least one channel, found none")]
    NoChannel,
    /// The values are no whole number of samples.
    #[error("expected a multiple of {channels} values, a value of each channel for each sample, found {found}")]
    IncompleteSample {
        /// Number of channels.
        channels: usize,
        /// Number of values.
        found: usize,
    },
    /// A channel has another number of samples than the first.
    #[error("channel {channel} (counted from 0): expected {expected} samples, as the first channel has, found {found}")]
    DifferentLengths {
        /// The channel, counted from 0.
        channel: usize,
        /// Samples of the first channel.
        expected: usize,
        /// Samples of this one.
        found: usize,
    },
}

/// Equally sampled channels, stored sample by sample: `values[k * channels + c]` is channel `c` at sample `k`.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    channels: usize,
    values: Vec<f64>,
}

impl Series {
    /// A series from values stored sample by sample.
    ///
    /// # Errors
    /// [`SeriesError`] for no channel, and for values that are no whole number of samples.
    pub fn from_values(channels: usize, values: Vec<f64>) -> Result<Self, SeriesError> {
        match channels {
            0 => Err(SeriesError::NoChannel),
            _ if !values.len().is_multiple_of(channels) => {
                Err(SeriesError::IncompleteSample { channels, found: values.len() })
            }
            _ => Ok(Self { channels, values }),
        }
    }

    /// A series from one vector per channel.
    ///
    /// # Errors
    /// [`SeriesError`] for no channel, and for channels that differ in length.
    pub fn from_channels(columns: &[Vec<f64>]) -> Result<Self, SeriesError> {
        let expected = columns.first().ok_or(SeriesError::NoChannel)?.len();
        match columns.iter().position(|column| column.len() != expected) {
            Some(channel) => Err(SeriesError::DifferentLengths { channel, expected, found: columns[channel].len() }),
            None => Ok(Self::side_by_side(columns)),
        }
    }

    /// A series of zeros.
    ///
    /// # Panics
    /// If `channels` is zero.
    #[must_use]
    pub fn zeros(samples: usize, channels: usize) -> Self {
        Self::shaped(channels, vec![0.0; samples * channels])
    }

    /// A series from values stored sample by sample, for kernels that make them in this shape.
    ///
    /// # Panics
    /// If `channels` is zero or does not divide the number of values.
    #[doc(hidden)]
    #[must_use]
    pub fn shaped(channels: usize, values: Vec<f64>) -> Self {
        assert!(
            channels > 0 && values.len().is_multiple_of(channels),
            "{} values in {channels} channels",
            values.len()
        );
        Self { channels, values }
    }

    /// A series from one vector per channel, for kernels that make them of one length.
    ///
    /// # Panics
    /// If there is no channel or the channels differ in length.
    #[doc(hidden)]
    #[must_use]
    pub fn side_by_side(columns: &[Vec<f64>]) -> Self {
        let samples = columns[0].len();
        assert!(columns.iter().all(|c| c.len() == samples), "channels of different lengths");
        let values = (0..samples).flat_map(|k| columns.iter().map(move |c| c[k])).collect();
        Self::shaped(columns.len(), values)
    }

    /// Some of the channels, in the order given.
    ///
    /// # Panics
    /// If no channel is given, or one that does not exist.
    #[doc(hidden)]
    #[must_use]
    pub fn select(&self, channels: &[usize]) -> Self {
        let values = self.values.chunks_exact(self.channels).flat_map(|sample| channels.iter().map(|&c| sample[c]));
        Self::shaped(channels.len(), values.collect())
    }

    /// Writes another series of as many samples to some of the channels.
    ///
    /// # Panics
    /// If the other has not one channel for each of `channels`, or more samples.
    #[doc(hidden)]
    pub fn write(&mut self, channels: &[usize], other: &Self) {
        for k in 0..other.len() {
            let sample = self.sample_mut(k);
            channels.iter().zip(other.sample(k)).for_each(|(&c, value)| sample[c] = *value);
        }
    }

    /// Number of channels.
    #[must_use]
    #[inline]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Number of samples.
    #[must_use]
    #[inline]
    pub fn len(&self) -> usize {
        self.values.len() / self.channels
    }

    /// Whether there is no sample.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// All values, sample by sample.
    #[must_use]
    #[inline]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// All values, sample by sample; consumes the series.
    #[must_use]
    #[inline]
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// All values, sample by sample, to write.
    #[inline]
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// The channels at sample `k`.
    #[must_use]
    #[inline]
    pub fn sample(&self, k: usize) -> &[f64] {
        &self.values[k * self.channels..(k + 1) * self.channels]
    }

    /// The channels at sample `k`, to write.
    #[inline]
    pub fn sample_mut(&mut self, k: usize) -> &mut [f64] {
        &mut self.values[k * self.channels..(k + 1) * self.channels]
    }

    /// Adds white noise with a standard deviation for each channel: one random number for each value, sample by sample.
    pub fn add_white_noise(&mut self, deviations: &[f64], rng: &mut ChaCha8Rng) {
        for k in 0..self.len() {
            for (value, deviation) in self.sample_mut(k).iter_mut().zip(deviations) {
                let noise: f64 = StandardNormal.sample(rng);
                *value += deviation * noise;
            }
        }
    }

    /// Adds a series of the same shape.
    pub fn add(&mut self, other: &Self) {
        self.values.iter_mut().zip(&other.values).for_each(|(value, other)| *value += other);
    }

    /// A copy of channel `c` over time.
    #[must_use]
    pub fn channel(&self, c: usize) -> Vec<f64> {
        self.values.iter().skip(c).step_by(self.channels).copied().collect()
    }

    /// The mean of each channel; zeros without samples.
    #[must_use]
    pub fn means(&self) -> Vec<f64> {
        let count = self.len().max(1) as f64;
        (0..self.channels).map(|c| self.values.iter().skip(c).step_by(self.channels).sum::<f64>() / count).collect()
    }

    /// A copy of the samples in `range`.
    #[must_use]
    pub fn window(&self, range: Range<usize>) -> Self {
        Self {
            channels: self.channels,
            values: self.values[range.start * self.channels..range.end * self.channels].to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_fill_every_sample_are_a_series() {
        assert_eq!(Series::from_values(2, vec![1.0, 2.0, 3.0, 4.0]).map(|series| series.len()), Ok(2));
    }

    #[test]
    fn no_channel_is_no_series() {
        assert_eq!(Series::from_values(0, vec![1.0]), Err(SeriesError::NoChannel));
        assert_eq!(Series::from_channels(&[]), Err(SeriesError::NoChannel));
    }

    #[test]
    fn a_sample_that_lacks_a_value_is_refused() {
        let expected = SeriesError::IncompleteSample { channels: 2, found: 3 };
        assert_eq!(Series::from_values(2, vec![1.0, 2.0, 3.0]), Err(expected));
    }

    #[test]
    fn a_channel_of_another_length_is_refused() {
        let expected = SeriesError::DifferentLengths { channel: 1, expected: 2, found: 1 };
        assert_eq!(Series::from_channels(&[vec![1.0, 2.0], vec![3.0]]), Err(expected));
    }
}
