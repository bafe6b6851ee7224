//! The effective bandwidth of a processing chain, measured by its impulse response.
//!
//! Legend: `h` impulse response, `H(f) = sum_k h[k] exp(-2 pi j f k T)` its Fourier transform, `T` sample time,
//! `k` counted from the impulse.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use num_complex::Complex64;

use thetahat_ground::series::Series;

use super::error::SignalError;

/// Steps of the search per octave: a gain that falls and rises again within a fraction of an octave may be missed.
const STEPS_PER_OCTAVE: f64 = 8.0;
/// Bisections: the bracket shrinks below the rounding of the frequency.
const BISECTIONS: usize = 50;
/// Interleaved sums of a Fourier transform, so that none waits for the others.
const SUMS: usize = 8;
/// Largest response at the ends of the recording, relative to its peak, that counts as died out.
const DIED_OUT: f64 = 1e-6;
/// Smallest gain at DC, relative to the sum of the terms it is made of, that counts as a gain.
const NO_GAIN: f64 = 1e-9;

/// The lowest frequency, in hertz, where the gain of `process` is `1/sqrt(2)` of its gain at DC; none if the gain stays above that up to
/// the Nyquist frequency.
///
/// The bandwidth is measured: an impulse in the middle of `samples` samples of one channel is passed through `process`,
/// and the Fourier transform of the response is searched from low frequencies upwards, then bisected. So the bandwidth
/// includes both passes and all stages of the processing. Processing that differentiates `derivatives` times
/// (0, 1 or 2, as a rule) is compared with the ideal derivative: its gain is `|H(f)| / (2 pi f)^derivatives`.
///
/// A zero-phase Butterworth filter of order `n` with cut-off `f_c` has the gain `1 / (1 + (f/f_c)^(2n))` (frequencies
/// pre-warped, `tan(pi f T)`), so its bandwidth is `f_c (sqrt(2) - 1)^(1/(2n))`: of order 4 at 50 Hz, 44.8 Hz.
///
/// The recording must be long enough for the response to die out: some ten periods of the cut-off at each side. For decimation
/// probe [`Decimator::filter`](super::Decimator::filter), which drops no sample.
///
/// # Errors
/// The errors of `process`; and if the response differs in length from the recording, does not die out at its ends, or
/// has no gain at DC.
///
/// ```
/// use thetahat_estimation::signal::{minus_3_db_bandwidth_hz, zero_phase, Padding, SecondOrderSections};
/// let filter = SecondOrderSections::butterworth_lowpass(4, 50.0, 5000.0)?;
/// let bandwidth_hz = minus_3_db_bandwidth_hz(5000.0, 10_000, 0, |x| zero_phase(&filter, x, Padding::Matlab))?;
/// assert!(bandwidth_hz.is_some_and(|f| (f - 44.78).abs() < 0.01));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn minus_3_db_bandwidth_hz(
    sample_rate_hz: f64,
    samples: usize,
    derivatives: u32,
    process: impl Fn(&Series) -> Result<Series, SignalError>,
) -> Result<Option<f64>, SignalError> {
    let response = ImpulseResponse { taps: probe(samples, process)?, sample_rate_hz, derivatives };
    let threshold = FRAC_1_SQRT_2 * response.dc_gain()?;
    let below = |f: f64| response.gain(f) < threshold;
    Ok(first_bracket(sample_rate_hz, samples, below).map(|(low, high)| bisect(low, high, below)))
}

/// The index of the impulse.
fn middle(samples: usize) -> usize {
    samples / 2
}

/// The response of the process to an impulse in the middle of the recording.
fn probe(samples: usize, process: impl Fn(&Series) -> Result<Series, SignalError>) -> Result<Vec<f64>, SignalError> {
    if samples < 3 {
        return Err(SignalError::RecordTooShort { needed: 3, found: samples });
    }
    let mut impulse = Series::zeros(samples, 1);
    impulse.values_mut()[middle(samples)] = 1.0;
    let response = process(&impulse)?.channel(0);
    if response.len() != samples {
        return Err(SignalError::LengthMismatch { expected: samples, found: response.len() });
    }
    check_died_out(&response)?;
    Ok(response)
}

fn check_died_out(response: &[f64]) -> Result<(), SignalError> {
    let largest = |values: &[f64]| values.iter().fold(0.0, |m: f64, h| m.max(h.abs()));
    let edge = response.len().div_ceil(100);
    let end = largest(&response[..edge]).max(largest(&response[response.len() - edge..]));
    let peak = largest(response);
    if end > DIED_OUT * peak {
        return Err(SignalError::ResponseTruncated { end_fraction: end / peak, samples: response.len() });
    }
    Ok(())
}

struct ImpulseResponse {
    taps: Vec<f64>,
    sample_rate_hz: f64,
    derivatives: u32,
}

impl ImpulseResponse {
    /// Each value of the response with its time from the impulse, in samples.
    fn timed(&self) -> impl Iterator<Item = (f64, f64)> {
        let start = -(middle(self.taps.len()) as f64);
        self.taps.iter().enumerate().map(move |(k, &h)| (start + k as f64, h))
    }

    /// `|H(f)| / (2 pi f)^n`, by Horner's rule on every eighth value; the magnitude does not depend on where time starts.
    fn gain(&self, frequency_hz: f64) -> f64 {
        let turn = Complex64::cis(2.0 * PI * frequency_hz / self.sample_rate_hz);
        let turns = turn.powu(SUMS as u32);
        let mut sums = [Complex64::ZERO; SUMS];
        for taps in self.taps.rchunks(SUMS).rev() {
            // The first values may be fewer: they are the last of their sums.
            let skipped = SUMS - taps.len();
            sums.iter_mut().for_each(|sum| *sum *= turns);
            sums[skipped..].iter_mut().zip(taps).for_each(|(sum, h)| *sum += h);
        }
        let sum = sums.iter().fold(Complex64::ZERO, |sum, of_eighth| sum * turn + of_eighth);
        sum.norm() / (2.0 * PI * frequency_hz).powi(self.derivatives as i32)
    }

    /// The limit of the gain at 0 Hz: `|sum_k h[k] (k T)^n| / n!`, the n-th derivative of `H` with respect to `w`.
    fn dc_gain(&self) -> Result<f64, SignalError> {
        let n = self.derivatives as i32;
        let moment: f64 = self.timed().map(|(k, h)| h * k.powi(n)).sum();
        let terms: f64 = self.timed().map(|(k, h)| (h * k.powi(n)).abs()).sum();
        let scale: f64 = (1..=n).map(|i| self.sample_rate_hz * f64::from(i)).product();
        let dc_gain = moment.abs() / scale;
        // Also refuses a response that is not a number.
        if moment.abs() > NO_GAIN * terms { Ok(dc_gain) } else { Err(SignalError::NoDcGain { dc_gain }) }
    }
}

/// The first two frequencies of a geometric scale between which the gain falls below the threshold.
fn first_bracket(sample_rate_hz: f64, samples: usize, below: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    let (lowest, nyquist) = (sample_rate_hz / samples as f64, sample_rate_hz / 2.0);
    let steps = (STEPS_PER_OCTAVE * (nyquist / lowest).log2()).ceil() as i32;
    let frequency = |i: i32| (lowest * (f64::from(i) / STEPS_PER_OCTAVE).exp2()).min(nyquist);
    let first = (0..=steps).find(|&i| below(frequency(i)))?;
    let low = if first == 0 { 0.0 } else { frequency(first - 1) };
    Some((low, frequency(first)))
}

fn bisect(mut low: f64, mut high: f64, below: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..BISECTIONS {
        let centre = f64::midpoint(low, high);
        if below(centre) { high = centre } else { low = centre }
    }
    f64::midpoint(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{Decimator, Padding, SecondOrderSections, central_difference, zero_phase};

    const SAMPLE_RATE_HZ: f64 = 5000.0;
    const SAMPLES: usize = 20_000;

    fn butterworth(order: usize, series: &Series) -> Result<Series, SignalError> {
        let filter = SecondOrderSections::butterworth_lowpass(order, 50.0, SAMPLE_RATE_HZ)?;
        zero_phase(&filter, series, Padding::Matlab)
    }

    /// `f_c (sqrt(2) - 1)^(1/(2n))` on the pre-warped scale.
    fn closed_form_hz(order: usize) -> f64 {
        let warped = (PI * 50.0 / SAMPLE_RATE_HZ).tan() * (2.0_f64.sqrt() - 1.0).powf(0.5 / order as f64);
        warped.atan() * SAMPLE_RATE_HZ / PI
    }

    #[test]
    fn the_zero_phase_butterworth_has_its_closed_form() -> Result<(), SignalError> {
        for order in [1, 2, 4, 7] {
            let measured = minus_3_db_bandwidth_hz(SAMPLE_RATE_HZ, SAMPLES, 0, |x| butterworth(order, x))?;
            assert!(measured.is_some_and(|f| (f - closed_form_hz(order)).abs() < 1e-8), "order {order}: {measured:?}");
        }
        assert!((closed_form_hz(4) - 44.8).abs() < 0.05);
        Ok(())
    }

    /// `sin(x)/x = 1/sqrt(2)` at `x = 2 pi f T = 1.39155737825151`.
    #[test]
    fn the_central_difference_has_its_closed_form() -> Result<(), SignalError> {
        let measured = minus_3_db_bandwidth_hz(1000.0, 100, 1, |x| Ok(central_difference(x, 1000.0)))?;
        assert!(measured.is_some_and(|f| (f - 1.391_557_378_251_51 * 1000.0 / (2.0 * PI)).abs() < 1e-9));
        Ok(())
    }

    #[test]
    fn differentiation_narrows_a_low_pass_a_little() -> Result<(), SignalError> {
        let twice = |x: &Series| {
            let velocity = central_difference(&butterworth(4, x)?, SAMPLE_RATE_HZ);
            Ok(central_difference(&velocity, SAMPLE_RATE_HZ))
        };
        let measured = minus_3_db_bandwidth_hz(SAMPLE_RATE_HZ, SAMPLES, 2, twice)?;
        assert!(measured.is_some_and(|f| f < closed_form_hz(4) && f > 0.99 * closed_form_hz(4)), "{measured:?}");
        Ok(())
    }

    #[test]
    fn a_decimator_is_probed_before_it_drops_samples() -> Result<(), SignalError> {
        let decimator = Decimator::new(100, SAMPLES)?;
        let measured = minus_3_db_bandwidth_hz(SAMPLE_RATE_HZ, SAMPLES, 0, |x| decimator.filter(x))?;
        // The cut-off, where both passes are 0.1 dB below their peak, is 0.8 / 100 of 2500 Hz.
        assert!(measured.is_some_and(|f| f > 20.0 && f < 22.0), "{measured:?}");
        let result = minus_3_db_bandwidth_hz(SAMPLE_RATE_HZ, SAMPLES, 0, |x| decimator.decimate(x));
        assert_eq!(result, Err(SignalError::LengthMismatch { expected: SAMPLES, found: 200 }));
        Ok(())
    }

    #[test]
    fn no_filter_has_no_bandwidth() -> Result<(), SignalError> {
        assert_eq!(minus_3_db_bandwidth_hz(SAMPLE_RATE_HZ, 100, 0, |x| Ok(x.clone()))?, None);
        Ok(())
    }

    #[test]
    fn a_recording_too_short_for_the_response_is_refused() {
        let result = minus_3_db_bandwidth_hz(SAMPLE_RATE_HZ, 100, 0, |x| butterworth(4, x));
        assert!(matches!(result, Err(SignalError::ResponseTruncated { samples: 100, .. })));
        let result = minus_3_db_bandwidth_hz(SAMPLE_RATE_HZ, 2, 0, |x| Ok(x.clone()));
        assert_eq!(result, Err(SignalError::RecordTooShort { needed: 3, found: 2 }));
    }

    #[test]
    fn a_derivative_has_no_gain_at_dc() {
        let result = minus_3_db_bandwidth_hz(1000.0, 100, 0, |x| Ok(central_difference(x, 1000.0)));
        assert!(matches!(result, Err(SignalError::NoDcGain { .. })));
        let result = minus_3_db_bandwidth_hz(1000.0, 100, 0, |x| Ok(Series::zeros(x.len(), 1)));
        assert!(matches!(result, Err(SignalError::NoDcGain { .. })));
    }
}
