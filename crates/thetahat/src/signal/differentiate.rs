//! Differentiation.

use crate::series::Series;

/// The time derivative of each channel, in its unit per second.
///
/// Second order inside, `dx[k] = (x[k+1] - x[k-1]) / (2 h)` with `h = 1 / sample_rate_hz`; one-sided differences of
/// first order at both ends. No delay: the gain at the frequency `f` is `sin(2 pi f h) / h` instead of the ideal
/// `2 pi f`. Equal to `numpy.gradient(x, h)`.
///
/// # Panics
/// If the series has fewer than two samples.
///
/// ```
/// use thetahat::{series::Series, signal::central_difference};
/// let ramp = Series::from_values(1, vec![0.0, 0.5, 1.0, 1.5]);
/// assert_eq!(central_difference(&ramp, 10.0).values(), [5.0; 4]);
/// ```
#[must_use]
pub fn central_difference(series: &Series, sample_rate_hz: f64) -> Series {
    assert!(series.len() >= 2, "a derivative needs two samples, found {}", series.len());
    let last = series.len() - 1;
    let mut derivative = Series::zeros(series.len(), series.channels());
    for k in 0..=last {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        let per_second = sample_rate_hz / (after - before) as f64;
        let differences = std::iter::zip(series.sample(after), series.sample(before)).map(|(b, a)| b - a);
        derivative.sample_mut(k).iter_mut().zip(differences).for_each(|(dx, d)| *dx = d * per_second);
    }
    derivative
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_differentiated_exactly_inside() {
        let h = 0.1;
        let parabola: Vec<f64> = (0..20).map(|k| (f64::from(k) * h).powi(2)).collect();
        let line: Vec<f64> = (0..20).map(|k| f64::from(k) * h).collect();
        let derivative = central_difference(&Series::from_channels(&[parabola, line]), 1.0 / h);
        for k in 1..19 {
            assert!((derivative.sample(k)[0] - 2.0 * k as f64 * h).abs() < 1e-12);
            assert!((derivative.sample(k)[1] - 1.0).abs() < 1e-12);
        }
        assert!((derivative.sample(0)[0] - h).abs() < 1e-12);
        assert!((derivative.sample(19)[0] - 37.0 * h).abs() < 1e-12);
    }

    #[test]
    #[should_panic(expected = "needs two samples")]
    fn one_sample_has_no_derivative() {
        let _ = central_difference(&Series::zeros(1, 1), 1.0);
    }
}
