//! Low-pass filters as cascades of second-order sections.
//!
//! Legend: `s` pole of the analogue prototype (cut-off 1 rad/s), `p` pole of the digital filter, `Omega` pre-warped
//! cut-off, `z^-1` the delay by one sample.

use std::f64::consts::PI;

use super::error::SignalError;

/// The numerator of a section with both zeros at `z = -1`.
const TWO_ZEROS: [f64; 3] = [1.0, 2.0, 1.0];
/// The numerator of a section with one zero at `z = -1` and one at `z = 0`.
const ONE_ZERO: [f64; 3] = [1.0, 1.0, 0.0];

/// A low-pass filter as a cascade of sections
/// `H_i(z) = (b0 + b1 z^-1 + b2 z^-2) / (1 + a1 z^-1 + a2 z^-2)`.
///
/// The sections have the order and the scaling of SciPy's `output="sos"`: the poles nearest to the unit circle come
/// last, the gain of the whole cascade is in the first numerator, and an odd order has its zero at `z = 0` in the
/// section of the last poles that are nearer to 0 than to -1.
///
/// ```
/// use thetahat_estimation::signal::SecondOrderSections;
/// let filter = SecondOrderSections::butterworth_lowpass(4, 50.0, 5000.0)?;
/// assert!((filter.gain(0.0) - 1.0).abs() < 1e-12);
/// assert!((filter.gain(50.0) - 0.5_f64.sqrt()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrderSections {
    order: usize,
    sample_rate_hz: f64,
    sections: Vec<[f64; 5]>,
}

impl SecondOrderSections {
    /// The Butterworth low-pass: one pass has gain 1 at DC and `1/sqrt(2)` at `cutoff_hz`.
    ///
    /// Analogue poles `s = -sin(t) + j cos(t)`, `t = pi (2k + 1) / (2 order)`, mapped by the bilinear transform with
    /// the cut-off pre-warped. Equal to SciPy's `butter(order, cutoff_hz, fs=sample_rate_hz, output="sos")`.
    ///
    /// # Errors
    /// If the order is zero, the sample rate is not positive, or the cut-off is not between 0 and half of it.
    pub fn butterworth_lowpass(order: usize, cutoff_hz: f64, sample_rate_hz: f64) -> Result<Self, SignalError> {
        check(order, cutoff_hz, sample_rate_hz)?;
        Ok(Self::from_ellipse(order, cutoff_hz, sample_rate_hz, PoleEllipse { real: 1.0, imaginary: 1.0 }, 1.0))
    }

    /// The Chebyshev low-pass of type I: in one pass the gain stays within `ripple_db` below 1 up to `cutoff_hz`.
    ///
    /// Analogue poles `s = -sinh(m) sin(t) + j cosh(m) cos(t)`, `m = asinh(1/e) / order`,
    /// `e^2 = 10^(ripple_db/10) - 1`, `t` as for Butterworth. The gain at DC is 1 for an odd order and
    /// `-ripple_db` for an even one. Equal to SciPy's `cheby1(.., output="sos")`.
    ///
    /// # Errors
    /// As [`Self::butterworth_lowpass`], and if the ripple is not positive.
    pub fn chebyshev1_lowpass(
        order: usize,
        ripple_db: f64,
        cutoff_hz: f64,
        sample_rate_hz: f64,
    ) -> Result<Self, SignalError> {
        check(order, cutoff_hz, sample_rate_hz)?;
        if !is_positive(ripple_db) {
            return Err(SignalError::InvalidRipple { ripple_db });
        }
        let ripple = (10.0_f64.powf(ripple_db / 10.0) - 1.0).sqrt();
        let m = (1.0 / ripple).asinh() / order as f64;
        let dc_gain = if order.is_multiple_of(2) { 10.0_f64.powf(-ripple_db / 20.0) } else { 1.0 };
        let ellipse = PoleEllipse { real: m.sinh(), imaginary: m.cosh() };
        Ok(Self::from_ellipse(order, cutoff_hz, sample_rate_hz, ellipse, dc_gain))
    }

    /// The order of the filter: the number of its poles.
    #[must_use]
    pub fn order(&self) -> usize {
        self.order
    }

    /// The sections `[b0, b1, b2, a1, a2]` in the order in which they are applied.
    #[must_use]
    pub fn sections(&self) -> &[[f64; 5]] {
        &self.sections
    }

    /// The gain `|H(exp(j w))|` of one pass at a frequency in hertz.
    #[must_use]
    pub fn gain(&self, frequency_hz: f64) -> f64 {
        let w = 2.0 * PI * frequency_hz / self.sample_rate_hz;
        self.sections
            .iter()
            .map(|&[b0, b1, b2, a1, a2]| magnitude([b0, b1, b2], w) / magnitude([1.0, a1, a2], w))
            .product()
    }

    /// The number of samples after which the slowest part of a transient has decayed to `remainder` of itself: the powers of
    /// the poles are below it.
    #[must_use]
    pub fn settling_samples(&self, remainder: f64) -> usize {
        let largest = self.sections.iter().map(|&[.., a1, a2]| largest_pole(a1, a2)).fold(0.0, f64::max);
        if largest > 0.0 { (remainder.ln() / largest.ln()).ceil() as usize } else { 0 }
    }

    fn from_ellipse(order: usize, cutoff_hz: f64, sample_rate_hz: f64, ellipse: PoleEllipse, dc_gain: f64) -> Self {
        let omega = (PI * cutoff_hz / sample_rate_hz).tan();
        let denominators = ellipse.denominators(order, omega);
        let numerators = numerators(order, &denominators);
        let mut sections: Vec<[f64; 5]> =
            std::iter::zip(numerators, denominators).map(|([b0, b1, b2], [a1, a2])| [b0, b1, b2, a1, a2]).collect();
        let gain = dc_gain / sections.iter().map(dc_gain_of_section).product::<f64>();
        sections[0][..3].iter_mut().for_each(|b| *b *= gain);
        Self { order, sample_rate_hz, sections }
    }
}

/// The larger absolute value of the two poles of `1 + a1 z^-1 + a2 z^-2`.
fn largest_pole(a1: f64, a2: f64) -> f64 {
    let discriminant = 0.25 * a1 * a1 - a2;
    if discriminant < 0.0 { a2.sqrt() } else { 0.5 * a1.abs() + discriminant.sqrt() }
}

/// The half axes of the ellipse on which the analogue poles lie: a circle for Butterworth.
struct PoleEllipse {
    real: f64,
    imaginary: f64,
}

impl PoleEllipse {
    /// `[a1, a2]` of each section, the poles nearest to the unit circle last.
    fn denominators(&self, order: usize, omega: f64) -> Vec<[f64; 2]> {
        let real_pole = (!order.is_multiple_of(2)).then(|| denominator_of_real_pole(-omega * self.real));
        // Along the ellipse, the nearer a pole is to the imaginary axis, the nearer its image is to the unit circle.
        let pairs = (0..order / 2).rev().map(|k| {
            let t = PI * (2 * k + 1) as f64 / (2 * order) as f64;
            denominator_of_pair(-omega * self.real * t.sin(), omega * self.imaginary * t.cos())
        });
        real_pole.into_iter().chain(pairs).collect()
    }
}

/// `[-p, 0]` for `p = (1 + s) / (1 - s)`, the bilinear transform of a real pole.
fn denominator_of_real_pole(s: f64) -> [f64; 2] {
    [-(1.0 + s) / (1.0 - s), 0.0]
}

/// `[-2 Re p, |p|^2]` for `p = (1 + s) / (1 - s)`, the bilinear transform of a pole `s` and its conjugate.
fn denominator_of_pair(re: f64, im: f64) -> [f64; 2] {
    let scale = (1.0 - re).powi(2) + im * im;
    [-2.0 * (1.0 - re * re - im * im) / scale, ((1.0 + re).powi(2) + im * im) / scale]
}

/// The zeros of each section. All are at `z = -1`, where the bilinear transform maps infinity; for an odd order
/// SciPy adds a zero (and a pole) at `z = 0` and gives it to the last section whose poles are nearer to 0 than to -1.
fn numerators(order: usize, denominators: &[[f64; 2]]) -> Vec<[f64; 3]> {
    let mut numerators = vec![TWO_ZEROS; denominators.len()];
    if !order.is_multiple_of(2) {
        // |p| < |p + 1| is 2 Re p > -1; the section of the real pole, the first, takes the zero otherwise.
        let nearer_to_zero = (1..denominators.len()).rev().find(|&i| denominators[i][0] < 1.0);
        numerators[nearer_to_zero.unwrap_or(0)] = ONE_ZERO;
    }
    numerators
}

/// `H_i(1)`, from the rounded coefficients: so the cascade's gain at DC is exact although the poles are rounded.
fn dc_gain_of_section(&[b0, b1, b2, a1, a2]: &[f64; 5]) -> f64 {
    (b0 + b1 + b2) / (1.0 + a1 + a2)
}

/// `|c0 + c1 exp(-j w) + c2 exp(-2 j w)|`.
fn magnitude(c: [f64; 3], w: f64) -> f64 {
    let re = c[0] + c[1] * w.cos() + c[2] * (2.0 * w).cos();
    let im = c[1] * w.sin() + c[2] * (2.0 * w).sin();
    re.hypot(im)
}

fn is_positive(x: f64) -> bool {
    x.is_finite() && x > 0.0
}

fn check(order: usize, cutoff_hz: f64, sample_rate_hz: f64) -> Result<(), SignalError> {
    let nyquist_hz = sample_rate_hz / 2.0;
    if order == 0 {
        Err(SignalError::ZeroOrder)
    } else if !is_positive(sample_rate_hz) {
        Err(SignalError::InvalidSampleRate { sample_rate_hz })
    } else if cutoff_hz >= nyquist_hz {
        Err(SignalError::CutoffAboveNyquist { cutoff_hz, nyquist_hz })
    } else if !is_positive(cutoff_hz) {
        Err(SignalError::NonPositiveCutoff { cutoff_hz })
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of the coefficients, amplified by poles near the unit circle.
    const ROUNDING: f64 = 1e-11;

    #[test]
    fn butterworth_is_one_at_dc_and_minus_3_db_at_the_cutoff() -> Result<(), SignalError> {
        for order in 1..=9 {
            for cutoff_hz in [20.0, 120.0, 250.0, 400.0] {
                let filter = SecondOrderSections::butterworth_lowpass(order, cutoff_hz, 1000.0)?;
                assert!((filter.gain(0.0) - 1.0).abs() < ROUNDING, "order {order} at {cutoff_hz} Hz");
                assert!((filter.gain(cutoff_hz) - 0.5_f64.sqrt()).abs() < ROUNDING, "order {order} at {cutoff_hz} Hz");
                assert!(filter.gain(500.0) < ROUNDING, "order {order} at {cutoff_hz} Hz");
            }
        }
        Ok(())
    }

    #[test]
    fn chebyshev_ends_its_ripple_at_the_cutoff() -> Result<(), SignalError> {
        let lower_edge = 10.0_f64.powf(-0.5 / 20.0);
        for order in 1..=9 {
            let filter = SecondOrderSections::chebyshev1_lowpass(order, 0.5, 80.0, 1000.0)?;
            let dc_gain = if order % 2 == 0 { lower_edge } else { 1.0 };
            assert!((filter.gain(0.0) - dc_gain).abs() < ROUNDING, "order {order}");
            assert!((filter.gain(80.0) - lower_edge).abs() < ROUNDING, "order {order}");
            let pass_band = (0..=80).map(|f| filter.gain(f64::from(f)));
            assert!(pass_band.into_iter().all(|g| (lower_edge - ROUNDING..=1.0 + ROUNDING).contains(&g)));
        }
        Ok(())
    }

    #[test]
    fn the_first_order_is_its_closed_form() -> Result<(), SignalError> {
        let filter = SecondOrderSections::butterworth_lowpass(1, 250.0, 1000.0)?;
        let [b0, b1, b2, a1, a2] = filter.sections()[0];
        // A quarter of the sample rate: Omega = 1, so H = (1 + z^-1) / 2.
        assert!((b0 - 0.5).abs() < ROUNDING && (b1 - 0.5).abs() < ROUNDING && a1.abs() < ROUNDING);
        assert!(b2.abs() < ROUNDING && a2.abs() < ROUNDING);
        Ok(())
    }

    #[test]
    fn the_poles_nearest_to_the_unit_circle_come_last() -> Result<(), SignalError> {
        for order in [3, 6, 9] {
            let filter = SecondOrderSections::chebyshev1_lowpass(order, 0.05, 300.0, 1000.0)?;
            let radii: Vec<f64> = filter.sections().iter().skip(order % 2).map(|s| s[4]).collect();
            assert!(radii.is_sorted());
        }
        Ok(())
    }

    #[test]
    fn order_zero_is_refused() {
        assert_eq!(SecondOrderSections::butterworth_lowpass(0, 10.0, 1000.0), Err(SignalError::ZeroOrder));
    }

    #[test]
    fn a_cutoff_at_nyquist_is_refused() {
        assert_eq!(
            SecondOrderSections::butterworth_lowpass(2, 500.0, 1000.0),
            Err(SignalError::CutoffAboveNyquist { cutoff_hz: 500.0, nyquist_hz: 500.0 })
        );
    }

    #[test]
    fn a_cutoff_that_is_not_positive_is_refused() {
        for cutoff_hz in [0.0, -1.0, f64::NAN] {
            let result = SecondOrderSections::butterworth_lowpass(2, cutoff_hz, 1000.0);
            assert!(matches!(result, Err(SignalError::NonPositiveCutoff { .. })));
        }
    }

    #[test]
    fn a_sample_rate_that_is_not_positive_is_refused() {
        for sample_rate_hz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let result = SecondOrderSections::butterworth_lowpass(2, 10.0, sample_rate_hz);
            assert!(matches!(result, Err(SignalError::InvalidSampleRate { .. })));
        }
    }

    #[test]
    fn a_ripple_that_is_not_positive_is_refused() {
        assert_eq!(
            SecondOrderSections::chebyshev1_lowpass(2, 0.0, 10.0, 1000.0),
            Err(SignalError::InvalidRipple { ripple_db: 0.0 })
        );
    }
}
