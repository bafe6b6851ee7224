//! From recorded positions to the motion that enters the observation matrix (Brunot and others, section III-A).

use thetahat_ground::series::Series;

use super::{
    design::SecondOrderSections,
    differentiate::Derivative,
    error::SignalError,
    zero_phase::{Padding, zero_phase},
};

/// Positions, velocities and accelerations of all coordinates, sample by sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Positions, rad or m.
    pub q: Series,
    /// Velocities, rad/s or m/s.
    pub dq: Series,
    /// Accelerations, rad/s^2 or m/s^2.
    pub ddq: Series,
}

/// The band-passed motion of recorded positions, with the same number of samples and without delay.
///
/// The positions (rad or m, one channel per coordinate) are filtered forward and backward by a Butterworth low-pass of
/// `filter_order` and `cutoff_hz` with MATLAB's padding ([`zero_phase`]), then differentiated twice by
/// `derivative`. Low-pass and differences together are the band-pass of Brunot and others, section III-A: the
/// paper filters with order 4 at some five times the bandwidth of the motion.
///
/// # Errors
/// As [`SecondOrderSections::butterworth_lowpass`] and [`zero_phase`]: an order of zero, a cut-off that is not between
/// 0 and half the sample rate, or a recording no longer than the padding of `3 filter_order` samples.
///
/// ```
/// use thetahat_estimation::signal::{band_pass, Derivative};
/// use thetahat_ground::series::Series;
/// // 0.5 t^2 at 100 Hz: away from the ends, the acceleration is 1.
/// let position = Series::from_values(1, (0..400).map(|k| 0.5 * (0.01 * f64::from(k)).powi(2)).collect())?;
/// let motion = band_pass(&position, 100.0, 4, 10.0, Derivative::NinePoint)?;
/// assert!((motion.ddq.sample(200)[0] - 1.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn band_pass(
    position: &Series,
    sample_rate_hz: f64,
    filter_order: usize,
    cutoff_hz: f64,
    derivative: Derivative,
) -> Result<Motion, SignalError> {
    let filter = SecondOrderSections::butterworth_lowpass(filter_order, cutoff_hz, sample_rate_hz)?;
    let q = zero_phase(&filter, position, Padding::Matlab)?;
    let dq = derivative.of(&q, sample_rate_hz);
    let ddq = derivative.of(&dq, sample_rate_hz);
    Ok(Motion { q, dq, ddq })
}

/// Steps of the integral over the frequencies.
const FREQUENCIES: usize = 2000;

/// Variance of the band-passed velocity per density (variance per Hz) of white noise of the positions, s^-1: the integral of
/// the squared gains of both passes and of the difference.
#[doc(hidden)]
pub fn velocity_noise_per_density(
    filter_order: usize,
    cutoff_hz: f64,
    sample_rate_hz: f64,
    derivative: Derivative,
) -> f64 {
    let half = |hz: f64| std::f64::consts::PI * hz / sample_rate_hz;
    let step = 0.5 * sample_rate_hz / FREQUENCIES as f64;
    let gain = |hz: f64| {
        let low_pass = 1.0 / (1.0 + (half(hz).tan() / half(cutoff_hz).tan()).powi(2 * filter_order as i32));
        low_pass * derivative.gain(hz, sample_rate_hz)
    };
    (0..FREQUENCIES).map(|k| gain((k as f64 + 0.5) * step).powi(2) * step).sum()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const RATE_HZ: f64 = 1000.0;
    const CUTOFF_HZ: f64 = 50.0;

    fn sine(hz: f64) -> Series {
        let w = std::f64::consts::TAU * hz / RATE_HZ;
        Series::shaped(1, (0..4000).map(|k| (w * f64::from(k)).sin()).collect())
    }

    /// Amplitude of a sine's inner half, from its rms over whole periods.
    fn amplitude(series: &Series) -> f64 {
        let inside = &series.values()[1000..3000];
        (2.0 * inside.iter().map(|v| v * v).sum::<f64>() / inside.len() as f64).sqrt()
    }

    /// Both passes have the gain `1 / (1 + (tan(w/2) / tan(wc/2))^(2 n))`, a difference has `sin(w)` times the rate.
    #[test]
    fn a_sine_comes_out_with_the_gains_of_filter_and_differences() -> Result<(), SignalError> {
        for (order, hz) in [(4, 10.0), (4, 50.0), (2, 80.0)] {
            let motion = band_pass(&sine(hz), RATE_HZ, order, CUTOFF_HZ, Derivative::Central)?;
            let half = |hz: f64| std::f64::consts::PI * hz / RATE_HZ;
            let low_pass = 1.0 / (1.0 + (half(hz).tan() / half(CUTOFF_HZ).tan()).powi(2 * order as i32));
            let difference = (2.0 * half(hz)).sin() * RATE_HZ;
            let gains = [low_pass, low_pass * difference, low_pass * difference * difference];
            for (series, gain) in [&motion.q, &motion.dq, &motion.ddq].into_iter().zip(gains) {
                let found = amplitude(series);
                assert!((found / gain - 1.0).abs() < 1e-9, "order {order}, {hz} Hz: {found} in place of {gain}");
            }
        }
        Ok(())
    }

    #[test]
    fn white_noise_of_positions_has_the_expected_variance_in_the_velocity() -> Result<(), SignalError> {
        let mut generator = ChaCha8Rng::seed_from_u64(5);
        let noise: Vec<f64> = (0..200_000).map(|_| StandardNormal.sample(&mut generator)).collect();
        let velocity = band_pass(&Series::shaped(1, noise), RATE_HZ, 4, CUTOFF_HZ, Derivative::NinePoint)?.dq;
        let variance = velocity.values().iter().map(|v| v * v).sum::<f64>() / 200_000.0;
        let expected = velocity_noise_per_density(4, CUTOFF_HZ, RATE_HZ, Derivative::NinePoint) / (0.5 * RATE_HZ);
        assert!((variance / expected - 1.0).abs() < 0.03, "{variance}, not {expected}");
        Ok(())
    }

    #[test]
    fn what_the_filter_refuses_is_refused() {
        let position = sine(10.0);
        assert_eq!(band_pass(&position, RATE_HZ, 0, CUTOFF_HZ, Derivative::Central), Err(SignalError::ZeroOrder));
        let above = SignalError::CutoffAboveNyquist { cutoff_hz: 600.0, nyquist_hz: 500.0 };
        assert_eq!(band_pass(&position, RATE_HZ, 4, 600.0, Derivative::Central), Err(above));
        let short = SignalError::RecordTooShort { needed: 13, found: 12 };
        assert_eq!(band_pass(&position.window(0..12), RATE_HZ, 4, CUTOFF_HZ, Derivative::Central), Err(short));
    }
}
