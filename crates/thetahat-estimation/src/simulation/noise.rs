//! Noisy recordings of a simulated motion: every twin, prediction and study adds its random numbers here.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::signal::Spectrum;
use thetahat_ground::series::Series;

/// Random numbers: equal seed and stream give equal numbers, and streams of one seed are independent.
#[must_use]
pub fn random_numbers(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stream);
    rng
}

/// Gaussian noise on the channels of a signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SignalNoise<'a> {
    /// White noise with a standard deviation for each channel.
    White(&'a [f64]),
    /// Noise with power spectral densities.
    Coloured {
        /// The densities, one list for each channel.
        spectrum: &'a Spectrum,
        /// Samples per second of the signal.
        sample_rate_hz: f64,
    },
    /// Noise that an autoregression makes.
    Autoregressive(&'a Autoregression),
}

/// An autoregression of the first order, `x_k = c x_(k-1) + s n_k` with white noise n of variance one.
#[derive(Debug, Clone, PartialEq)]
pub struct Autoregression {
    /// c.
    pub correlation: f64,
    /// Standard deviation of the first sample, one for each channel.
    pub first: Vec<f64>,
    /// s, one for each channel.
    pub innovation: Vec<f64>,
}

impl Autoregression {
    fn draw(&self, samples: usize, rng: &mut ChaCha8Rng) -> Series {
        let mut noise = Series::zeros(samples, self.first.len());
        let mut state = vec![0.0; self.first.len()];
        for k in 0..samples {
            let deviations = if k == 0 { &self.first } else { &self.innovation };
            for (state, deviation) in state.iter_mut().zip(deviations) {
                let normal: f64 = StandardNormal.sample(rng);
                *state = self.correlation * *state + deviation * normal;
            }
            noise.sample_mut(k).copy_from_slice(&state);
        }
        noise
    }
}

impl SignalNoise<'_> {
    /// Samples of the noise.
    #[must_use]
    pub fn draw(&self, samples: usize, rng: &mut ChaCha8Rng) -> Series {
        match self {
            Self::White(deviations) => {
                let mut noise = Series::zeros(samples, deviations.len());
                noise.add_white_noise(deviations, rng);
                noise
            }
            Self::Coloured { spectrum, sample_rate_hz } => spectrum.draw(samples, *sample_rate_hz, rng),
            Self::Autoregressive(autoregression) => autoregression.draw(samples, rng),
        }
    }

    /// The signal with noise added.
    #[must_use]
    pub fn added_to(&self, mut signal: Series, rng: &mut ChaCha8Rng) -> Series {
        match self {
            Self::White(deviations) => signal.add_white_noise(deviations, rng),
            Self::Coloured { .. } | Self::Autoregressive(_) => signal.add(&self.draw(signal.len(), rng)),
        }
        signal
    }
}

/// The noise of a recording of the joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordingNoise<'a> {
    /// On the positions, rad or m.
    pub position: SignalNoise<'a>,
    /// On the torques, N m or N.
    pub torque: SignalNoise<'a>,
}

/// Recorded positions and torques of the joints.
#[derive(Debug, Clone, PartialEq)]
pub struct NoisySignals {
    /// The positions, rad or m.
    pub position: Series,
    /// The torques, N m or N.
    pub torque: Series,
}

impl RecordingNoise<'_> {
    /// True positions and torques with noise added. The random numbers of the positions are drawn first.
    ///
    /// ```
    /// use thetahat_estimation::simulation::{RecordingNoise, SignalNoise, random_numbers};
    /// use thetahat_ground::series::Series;
    /// let noise = RecordingNoise { position: SignalNoise::White(&[0.0]), torque: SignalNoise::White(&[0.5]) };
    /// let (q, tau) = (Series::zeros(100, 1), Series::zeros(100, 1));
    /// let [one, same, other] = [1, 1, 2].map(|seed| noise.record(q.clone(), tau.clone(), &mut random_numbers(seed, 0)));
    /// assert!(one == same && one.position == q && one.torque != other.torque);
    /// ```
    #[must_use]
    pub fn record(&self, position: Series, torque: Series, rng: &mut ChaCha8Rng) -> NoisySignals {
        let position = self.position.added_to(position, rng);
        NoisySignals { position, torque: self.torque.added_to(torque, rng) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(x: &[f64]) -> [f64; 2] {
        let square = x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64;
        [square, x.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / x.len() as f64 / square]
    }

    #[test]
    fn streams_are_independent_and_repeat() {
        let draw = |seed, stream| SignalNoise::White(&[1.0]).draw(2000, &mut random_numbers(seed, stream)).channel(0);
        assert_eq!(draw(7, 3), draw(7, 3));
        let (a, b) = (draw(7, 3), draw(7, 4));
        let mixed = a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>() / 2000.0;
        assert!(mixed.abs() < 0.1, "{mixed}");
    }

    #[test]
    fn an_autoregression_has_its_variance_and_correlation_from_the_first_sample_on() {
        let (correlation, deviation): (f64, f64) = (0.8, 3.0);
        let innovation = vec![(1.0 - correlation * correlation).sqrt() * deviation];
        let noise = Autoregression { correlation, first: vec![deviation], innovation };
        let [square, neighbours] = moments(&noise.draw(200_000, &mut random_numbers(1, 0)).channel(0));
        assert!((square / deviation.powi(2) - 1.0).abs() < 0.05 && (neighbours - correlation).abs() < 0.01);
        let first = |seed| noise.draw(1, &mut random_numbers(seed, 0)).values()[0];
        let [square, _] = moments(&(0..4000).map(first).collect::<Vec<f64>>());
        assert!((square / deviation.powi(2) - 1.0).abs() < 0.1, "{square}");
    }
}
