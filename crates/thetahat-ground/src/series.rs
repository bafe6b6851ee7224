//! Equally sampled channels: the one container for time series.
//!
//! ```
//! use thetahat_ground::series::Series;
//! let series = Series::from_channels(&[vec![0.0, 1.0, 2.0], vec![5.0, 6.0, 7.0]]);
//! assert_eq!(series.sample(1), [1.0, 6.0]);
//! assert_eq!(series.channel(1), [5.0, 6.0, 7.0]);
//! assert_eq!(series.window(1..3).len(), 2);
//! ```

use std::ops::Range;

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Equally sampled channels, stored sample by sample: `values[k * channels + c]` is channel `c` at sample `k`.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    channels: usize,
    values: Vec<f64>,
}

impl Series {
    /// A series of zeros.
    ///
    /// # Panics
    /// If `channels` is zero.
    #[must_use]
    pub fn zeros(samples: usize, channels: usize) -> Self {
        Self::from_values(channels, vec![0.0; samples * channels])
    }

    /// A series from values stored sample by sample.
    ///
    /// # Panics
    /// If `channels` is zero or does not divide the number of values.
    #[must_use]
    pub fn from_values(channels: usize, values: Vec<f64>) -> Self {
        assert!(
            channels > 0 && values.len().is_multiple_of(channels),
            "{} values in {channels} channels",
            values.len()
        );
        Self { channels, values }
    }

    /// A series from one vector per channel.
    ///
    /// # Panics
    /// If there is no channel or the channels differ in length.
    #[must_use]
    pub fn from_channels(columns: &[Vec<f64>]) -> Self {
        let samples = columns[0].len();
        assert!(columns.iter().all(|c| c.len() == samples), "channels of different lengths");
        let values = (0..samples).flat_map(|k| columns.iter().map(move |c| c[k])).collect();
        Self::from_values(columns.len(), values)
    }

    /// Number of channels.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len() / self.channels
    }

    /// Whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// All values, sample by sample.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// All values, sample by sample, taken out.
    #[must_use]
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// All values, sample by sample, to write.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// The channels at sample `k`.
    #[must_use]
    pub fn sample(&self, k: usize) -> &[f64] {
        &self.values[k * self.channels..(k + 1) * self.channels]
    }

    /// The channels at sample `k`, to write.
    pub fn sample_mut(&mut self, k: usize) -> &mut [f64] {
        &mut self.values[k * self.channels..(k + 1) * self.channels]
    }

    /// Adds white noise with a standard deviation for each channel: one number is drawn for each value, sample by sample.
    pub fn add_white_noise(&mut self, deviations: &[f64], rng: &mut ChaCha8Rng) {
        for k in 0..self.len() {
            for (value, deviation) in self.sample_mut(k).iter_mut().zip(deviations) {
                let noise: f64 = StandardNormal.sample(rng);
                *value += deviation * noise;
            }
        }
    }

    /// Adds a series of the same form.
    pub fn add(&mut self, other: &Self) {
        self.values.iter_mut().zip(&other.values).for_each(|(value, other)| *value += other);
    }

    /// A copy of channel `c` over time.
    #[must_use]
    pub fn channel(&self, c: usize) -> Vec<f64> {
        self.values.iter().skip(c).step_by(self.channels).copied().collect()
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
