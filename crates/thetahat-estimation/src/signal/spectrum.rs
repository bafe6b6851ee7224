//! Power spectral densities, and noise drawn from them.

use std::f64::consts::TAU;

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use realfft::RealFftPlanner;

use thetahat_ground::series::Series;

/// Largest number of samples of a segment: more resolve frequencies that no filter separates.
const LONGEST_SEGMENT: usize = 8192;
/// Fewest segments of a recording, if it is long enough.
const SEGMENTS: usize = 4;

/// One-sided power spectral densities of the channels of a series, at equal steps of frequency from zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Step of the frequencies, Hz.
    pub step_hz: f64,
    /// Density at each frequency, square of the unit per Hz, one list for each channel.
    pub density: Vec<Vec<f64>>,
}

impl Spectrum {
    /// The densities of a series by Welch's method: segments of up to 8192 samples that overlap by half, each detrended by a straight line
    /// and multiplied by Hann's window.
    ///
    /// The integral of a channel's density is its variance. A series of fewer than four samples has no frequencies.
    ///
    /// P. D. Welch, "The use of fast Fourier transform for the estimation of power spectra", IEEE Trans. Audio and
    /// Electroacoustics 15 (1967), equations (1) to (7).
    ///
    /// ```
    /// use thetahat_estimation::signal::Spectrum;
    /// use thetahat_ground::series::Series;
    /// // A sine of amplitude 2 at 5 Hz: its variance of 2 lies around 5 Hz.
    /// let sine = |k: i32| 2.0 * (std::f64::consts::TAU * 5.0 * f64::from(k) / 100.0).sin();
    /// let spectrum = Spectrum::of(&Series::from_values(1, (0..4000).map(sine).collect())?, 100.0);
    /// assert!((spectrum.variance(0, 4.0..6.0) - 2.0).abs() < 0.02);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of(series: &Series, sample_rate_hz: f64) -> Self {
        let length = (2 * series.len() / (SEGMENTS + 1)).min(LONGEST_SEGMENT) & !1;
        if length < 4 {
            return Self { step_hz: 0.5 * sample_rate_hz, density: vec![Vec::new(); series.channels()] };
        }
        let window: Vec<f64> =
            (0..length).map(|k| 0.5 - 0.5 * (TAU * (k as f64 + 0.5) / length as f64).cos()).collect();
        let density = (0..series.channels()).map(|c| density(&series.channel(c), &window, sample_rate_hz)).collect();
        Self { step_hz: sample_rate_hz / length as f64, density }
    }

    /// The frequencies, Hz.
    pub fn frequencies_hz(&self) -> impl Iterator<Item = f64> {
        let count = self.density.first().map_or(0, Vec::len);
        (0..count).map(|i| i as f64 * self.step_hz)
    }

    /// The variance of a channel within frequencies in Hz.
    #[must_use]
    pub fn variance(&self, channel: usize, within_hz: std::ops::Range<f64>) -> f64 {
        let inside = self.frequencies_hz().zip(&self.density[channel]).filter(|(f, _)| within_hz.contains(f));
        inside.map(|(_, density)| density * self.step_hz).sum()
    }

    /// The median density of a channel within frequencies in Hz; none if no frequency is in them.
    #[must_use]
    pub fn median(&self, channel: usize, within_hz: std::ops::Range<f64>) -> Option<f64> {
        let inside = self.frequencies_hz().zip(&self.density[channel]).filter(|(f, _)| within_hz.contains(f));
        let mut inside: Vec<f64> = inside.map(|(_, density)| *density).collect();
        inside.sort_by(f64::total_cmp);
        inside.get(inside.len() / 2).copied()
    }

    /// Gaussian noise with these densities, one channel for each; `rng` draws the spectrum.
    #[must_use]
    pub fn draw(&self, samples: usize, sample_rate_hz: f64, rng: &mut impl Rng) -> Series {
        let mut planner = RealFftPlanner::<f64>::new();
        let inverse = planner.plan_fft_inverse(samples);
        let channels: Vec<Vec<f64>> = (0..self.density.len())
            .map(|c| {
                let mut frequencies = inverse.make_input_vec();
                let last = frequencies.len() - 1;
                let step_hz = sample_rate_hz / samples as f64;
                for (i, value) in frequencies.iter_mut().enumerate().skip(1) {
                    // Real and imaginary part each have half of a line's variance, a quarter at either sign of the frequency.
                    let scale = (0.25 * self.at(c, i as f64 * step_hz) * step_hz).sqrt();
                    let mut normal = || -> f64 { StandardNormal.sample(&mut *rng) };
                    (value.re, value.im) = (scale * normal(), scale * normal());
                }
                if samples.is_multiple_of(2) {
                    frequencies[last].im = 0.0;
                }
                let mut noise = inverse.make_output_vec();
                // The vectors have the transform's lengths, and the real parts required are real.
                inverse.process(&mut frequencies, &mut noise).unwrap_or_default();
                noise
            })
            .collect();
        Series::side_by_side(&channels)
    }

    /// The density of a channel at a frequency, interpolated linearly.
    #[must_use]
    pub fn at(&self, channel: usize, frequency_hz: f64) -> f64 {
        let density = &self.density[channel];
        let place = frequency_hz / self.step_hz;
        let (below, part) = (place.floor() as usize, place.fract());
        match (density.get(below), density.get(below + 1)) {
            (Some(a), Some(b)) => a + part * (b - a),
            (Some(last), None) => *last,
            (None, _) => density.last().copied().unwrap_or(0.0),
        }
    }
}

/// The mean periodogram of the segments of a channel.
fn density(channel: &[f64], window: &[f64], rate: f64) -> Vec<f64> {
    let length = window.len();
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let power: f64 = window.iter().map(|w| w * w).sum();
    let mut sum = vec![0.0; length / 2 + 1];
    let starts: Vec<usize> = (0..=channel.len() - length).step_by(length / 2).collect();
    let (mut segment, mut frequencies) = (forward.make_input_vec(), forward.make_output_vec());
    for &start in &starts {
        write_without_line(&channel[start..start + length], &mut segment);
        segment.iter_mut().zip(window).for_each(|(value, w)| *value *= w);
        // The vectors have the transform's lengths.
        forward.process(&mut segment, &mut frequencies).unwrap_or_default();
        sum.iter_mut().zip(&frequencies).for_each(|(s, f)| *s += f.norm_sqr());
    }
    let scale = 2.0 / (rate * power * starts.len() as f64);
    sum.iter_mut().for_each(|s| *s *= scale);
    // Zero and half the sample rate have no negative counterpart.
    sum[0] *= 0.5;
    sum[length / 2] *= 0.5;
    sum
}

/// Values minus their least-squares straight line.
fn write_without_line(values: &[f64], out: &mut [f64]) {
    let n = values.len() as f64;
    let centre = 0.5 * (n - 1.0);
    let mean = values.iter().sum::<f64>() / n;
    let moment: f64 = values.iter().enumerate().map(|(k, v)| (k as f64 - centre) * v).sum();
    let slope = moment / (n * (n * n - 1.0) / 12.0);
    for (k, (out, value)) in out.iter_mut().zip(values).enumerate() {
        *out = value - mean - slope * (k as f64 - centre);
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    const RATE_HZ: f64 = 200.0;

    fn white(samples: usize, deviation: f64) -> Series {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        Series::shaped(1, (0..samples).map(|_| deviation * normal()).collect())
    }

    #[test]
    fn white_noise_has_the_same_density_everywhere() {
        let spectrum = Spectrum::of(&white(100_000, 0.3), RATE_HZ);
        let expected = 0.09 / (0.5 * RATE_HZ);
        for band in [1.0..20.0, 40.0..60.0, 80.0..99.0] {
            let mean = spectrum.variance(0, band.clone()) / (band.end - band.start);
            assert!((mean / expected - 1.0).abs() < 0.03, "{band:?}: {mean} in place of {expected}");
        }
        assert!((spectrum.variance(0, 0.0..RATE_HZ) / 0.09 - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_straight_line_has_no_power() {
        let line = Series::shaped(1, (0..1000).map(|k| 3.0 + 0.1 * f64::from(k)).collect());
        assert!(Spectrum::of(&line, RATE_HZ).variance(0, 0.0..RATE_HZ) < 1e-20);
    }

    #[test]
    fn noise_drawn_from_a_density_has_it() {
        // Falls by 40 dB in between.
        let density = (0..=100).map(|f| if f < 30 { 1e-2 } else { 1e-6 }).collect();
        let wanted = Spectrum { step_hz: 1.0, density: vec![density] };
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for samples in [60_000, 60_001] {
            let found = Spectrum::of(&wanted.draw(samples, RATE_HZ, &mut rng), RATE_HZ);
            assert!((found.variance(0, 2.0..28.0) / 26e-2 - 1.0).abs() < 0.05);
            assert!((found.variance(0, 35.0..95.0) / 60e-6 - 1.0).abs() < 0.05);
        }
    }

    #[test]
    fn a_recording_too_short_has_no_frequencies() {
        let spectrum = Spectrum::of(&Series::zeros(5, 2), RATE_HZ);
        assert_eq!((spectrum.density.len(), spectrum.median(0, 0.0..RATE_HZ)), (2, None));
    }
}
