//! Differentiation.

use std::fmt;

use serde::Deserialize;

use thetahat_ground::series::Series;

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
/// use thetahat_estimation::signal::central_difference;
/// use thetahat_ground::series::Series;
/// let ramp = Series::from_values(1, vec![0.0, 0.5, 1.0, 1.5])?;
/// assert_eq!(central_difference(&ramp, 10.0).values(), [5.0; 4]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
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

/// How a series is differentiated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Derivative {
    /// [`central_difference`], which loses `(2 pi f h)^2 / 6` at the frequency f: 0.4 % at 3 Hz and 125 Hz.
    Central,
    /// Four samples on either side, of order eight: it loses `(2 pi f h)^8 / 630`.
    #[default]
    NinePoint,
}

impl fmt::Display for Derivative {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Central => "central",
            Self::NinePoint => "nine-point",
        })
    }
}

/// Weights of the differences across one to four steps on either side.
const NINE_POINT: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

impl Derivative {
    /// The time derivative of each channel, in its unit per second; near the ends that of [`central_difference`].
    ///
    /// # Panics
    /// If the series has fewer than two samples.
    ///
    /// ```
    /// use thetahat_estimation::signal::Derivative;
    /// use thetahat_ground::series::Series;
    /// let cubes = Series::from_values(1, (0..20).map(|k| f64::from(k).powi(3)).collect())?;
    /// assert!((Derivative::NinePoint.of(&cubes, 1.0).sample(10)[0] - 300.0).abs() < 1e-9);
    /// assert!((Derivative::Central.of(&cubes, 1.0).sample(10)[0] - 301.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of(self, series: &Series, sample_rate_hz: f64) -> Series {
        let central = central_difference(series, sample_rate_hz);
        match self {
            Self::Central => central,
            Self::NinePoint => nine_point(series, sample_rate_hz, central),
        }
    }

    /// Number of samples that it uses on either side.
    #[must_use]
    pub fn reach(self) -> usize {
        match self {
            Self::Central => 1,
            Self::NinePoint => NINE_POINT.len(),
        }
    }

    /// Its gain at a frequency, per second: the ideal one is `2 pi f`.
    #[must_use]
    pub fn gain(self, hz: f64, sample_rate_hz: f64) -> f64 {
        let w = std::f64::consts::TAU * hz / sample_rate_hz;
        let weights: &[f64] = match self {
            Self::Central => &[0.5],
            Self::NinePoint => &NINE_POINT,
        };
        let term = |(i, weight): (usize, &f64)| 2.0 * weight * ((i + 1) as f64 * w).sin();
        weights.iter().enumerate().map(term).sum::<f64>() * sample_rate_hz
    }
}

/// The derivative in all samples but four at either end, where it stays `at_ends`.
fn nine_point(series: &Series, sample_rate_hz: f64, at_ends: Series) -> Series {
    let mut derivative = at_ends;
    let reach = NINE_POINT.len();
    for k in reach..series.len().saturating_sub(reach) {
        for (j, dx) in derivative.sample_mut(k).iter_mut().enumerate() {
            let difference = |i: usize| series.sample(k + i)[j] - series.sample(k - i)[j];
            let sum: f64 = NINE_POINT.iter().enumerate().map(|(i, weight)| weight * difference(i + 1)).sum();
            *dx = sum * sample_rate_hz;
        }
    }
    derivative
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_are_differentiated_with_the_stated_gains() {
        let (rate, hz) = (125.0, 10.0);
        let w = std::f64::consts::TAU * hz;
        let sine = |phase: f64| -> Vec<f64> { (0..60).map(|k| (w * f64::from(k) / rate + phase).sin()).collect() };
        let series = Series::side_by_side(&[sine(0.0)]);
        let cosine = sine(0.5 * std::f64::consts::PI);
        for (derivative, lost) in
            [(Derivative::Central, (w / rate).powi(2) / 6.0), (Derivative::NinePoint, (w / rate).powi(8) / 630.0)]
        {
            let found = derivative.of(&series, rate);
            let gain = derivative.gain(hz, rate);
            assert!((5..55).all(|k| (found.sample(k)[0] - gain * cosine[k]).abs() < 1e-9), "{derivative:?}");
            let relative = 1.0 - gain / w;
            assert!((0.9..1.01).contains(&(relative / lost)), "{derivative:?} loses {relative:e}, not {lost:e}");
        }
    }

    #[test]
    fn a_parabola_is_differentiated_exactly_inside() {
        let h = 0.1;
        let parabola: Vec<f64> = (0..20).map(|k| (f64::from(k) * h).powi(2)).collect();
        let line: Vec<f64> = (0..20).map(|k| f64::from(k) * h).collect();
        let derivative = central_difference(&Series::side_by_side(&[parabola, line]), 1.0 / h);
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
