//! Filtering without a delay.

use thetahat_ground::series::Series;

use super::design::SecondOrderSections;
use super::error::SignalError;
use super::forward_backward::{Kept, Shape, forward_backward};

/// Number of samples by which a recording is extended at both ends before it is filtered forward and backward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Padding {
    /// MATLAB's `filtfilt(b, a, x)`: three times the order.
    Matlab,
    /// The default of SciPy's `sosfiltfilt(sos, x)`: three times the order plus one.
    Scipy,
}

impl Padding {
    /// The number of samples added at each end for a filter of this order.
    #[must_use]
    pub fn samples(self, order: usize) -> usize {
        match self {
            Self::Matlab => 3 * order,
            Self::Scipy => 3 * (order + 1),
        }
    }
}

/// The series filtered forward and backward: no delay, and the gain of one pass squared.
///
/// Both ends are extended by the odd reflection `2 x[0] - x[k]`, and each pass starts in the steady state of its first value, so that a
/// constant passes unchanged (for a filter with gain 1 at DC). The padding is MATLAB's or
/// SciPy's, see [`Padding`]; away from the ends the two agree. The effective bandwidth is below the cut-off, see
/// [`minus_3_db_bandwidth_hz`](super::minus_3_db_bandwidth_hz).
///
/// # Errors
/// [`SignalError::RecordTooShort`] if the series is not longer than the padding.
///
/// ```
/// use thetahat_estimation::signal::{zero_phase, Padding, SecondOrderSections};
/// use thetahat_ground::series::Series;
/// let filter = SecondOrderSections::butterworth_lowpass(4, 50.0, 1000.0)?;
/// let constant = Series::from_values(1, vec![2.0; 100])?;
/// let filtered = zero_phase(&filter, &constant, Padding::Matlab)?;
/// assert!(filtered.values().iter().all(|y| (y - 2.0).abs() < 1e-11));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn zero_phase(filter: &SecondOrderSections, series: &Series, padding: Padding) -> Result<Series, SignalError> {
    let fill = |k: usize, sample: &mut [f64]| sample.copy_from_slice(series.sample(k));
    let (samples, padding) = (series.len(), padding.samples(filter.order()));
    if samples <= padding {
        return Err(SignalError::RecordTooShort { needed: padding + 1, found: samples });
    }
    let shape = Shape { samples, channels: series.channels(), padding };
    Ok(forward_backward(filter, shape, Kept::ALL, fill))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of the coefficients, amplified by the poles near the unit circle, relative to the largest value.
    const ROUNDING: f64 = 1e-12;

    fn filter(order: usize) -> Result<SecondOrderSections, SignalError> {
        SecondOrderSections::butterworth_lowpass(order, 50.0, 1000.0)
    }

    fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
        std::iter::zip(a, b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_constant_passes_unchanged() -> Result<(), SignalError> {
        for order in 1..=8 {
            let constant = Series::shaped(3, vec![-7.5; 300]);
            for padding in [Padding::Matlab, Padding::Scipy] {
                let filtered = zero_phase(&filter(order)?, &constant, padding)?;
                assert!(largest_difference(filtered.values(), constant.values()) < 7.5 * ROUNDING, "order {order}");
            }
        }
        Ok(())
    }

    /// Only away from the ends, where the passes start in the steady state of a constant.
    #[test]
    fn a_ramp_passes_unchanged_inside() -> Result<(), SignalError> {
        let ramp = Series::shaped(1, (0..2000).map(|k| 3.0 + 0.01 * f64::from(k)).collect());
        for order in 1..=8 {
            let filtered = zero_phase(&filter(order)?, &ramp, Padding::Matlab)?;
            let inside = 800..1200;
            let difference = largest_difference(&filtered.values()[inside.clone()], &ramp.values()[inside]);
            assert!(difference < 23.0 * ROUNDING, "order {order}: {difference}");
        }
        Ok(())
    }

    #[test]
    fn the_impulse_response_is_symmetric() -> Result<(), SignalError> {
        for order in 1..=8 {
            let mut impulse = Series::zeros(1001, 1);
            impulse.values_mut()[500] = 1.0;
            let response = zero_phase(&filter(order)?, &impulse, Padding::Matlab)?.channel(0);
            let reversed: Vec<f64> = response.iter().rev().copied().collect();
            assert!(largest_difference(&response, &reversed) < ROUNDING * response[500], "order {order}");
            assert!(response.iter().all(|&y| y <= response[500]), "order {order}");
        }
        Ok(())
    }

    #[test]
    fn each_channel_is_filtered_by_itself() -> Result<(), SignalError> {
        let columns: Vec<Vec<f64>> = (0..19)
            .map(|c| (0..200).map(|k| (f64::from(k * (c + 1)) * 0.013).sin() + f64::from(c)).collect())
            .collect();
        let together = zero_phase(&filter(5)?, &Series::side_by_side(&columns), Padding::Scipy)?;
        for (c, column) in columns.into_iter().enumerate() {
            let alone = zero_phase(&filter(5)?, &Series::shaped(1, column), Padding::Scipy)?;
            assert_eq!(together.channel(c), alone.values(), "channel {c}");
        }
        Ok(())
    }

    #[test]
    fn a_recording_as_short_as_the_padding_is_refused() -> Result<(), SignalError> {
        let result = zero_phase(&filter(4)?, &Series::zeros(12, 1), Padding::Matlab);
        assert_eq!(result, Err(SignalError::RecordTooShort { needed: 13, found: 12 }));
        assert!(zero_phase(&filter(4)?, &Series::zeros(13, 1), Padding::Matlab).is_ok());
        let result = zero_phase(&filter(4)?, &Series::zeros(15, 1), Padding::Scipy);
        assert_eq!(result, Err(SignalError::RecordTooShort { needed: 16, found: 15 }));
        Ok(())
    }
}
