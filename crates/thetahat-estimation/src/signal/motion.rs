//! The moving part of a recording.

use std::ops::Range;

use thetahat_ground::series::Series;

use super::error::SignalError;

/// The samples from the first to the last at which any channel moves, without the still periods at both ends.
///
/// A channel moves where its absolute velocity is at least `threshold_fraction` (above 0, below 1) of its own peak. A
/// channel whose peak is not above `still_velocity`, in the unit of the velocity, never moves, so that the noise of a joint
/// at rest does not count as motion. Pauses between motions are kept. The velocity should be filtered, because a single
/// spike counts as motion too.
///
/// # Errors
/// If the fraction is out of range, or no channel moves.
///
/// ```
/// use thetahat_estimation::signal::moving_samples;
/// use thetahat_ground::series::Series;
/// let velocity = Series::from_values(1, vec![0.0, 0.001, 0.5, 1.0, 0.0, 0.5, 0.0])?;
/// assert_eq!(moving_samples(&velocity, 0.01, 0.1)?, 2..6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn moving_samples(
    velocity: &Series,
    threshold_fraction: f64,
    still_velocity: f64,
) -> Result<Range<usize>, SignalError> {
    let peaks = peaks(velocity);
    let thresholds = moving_thresholds(&peaks, threshold_fraction, still_velocity)?;
    let moves = |&k: &usize| std::iter::zip(velocity.sample(k), &thresholds).any(|(v, limit)| v.abs() >= *limit);
    match ((0..velocity.len()).find(moves), (0..velocity.len()).rfind(moves)) {
        (Some(first), Some(last)) => Ok(first..last + 1),
        _ => Err(SignalError::NoMotion { peak_velocity: peaks.into_iter().fold(0.0, f64::max), still_velocity }),
    }
}

/// The absolute velocity from which each channel counts as moving, from its peak over the whole recording; infinite for one
/// that never moves.
///
/// # Errors
/// As [`moving_samples`].
pub fn moving_thresholds(peaks: &[f64], threshold_fraction: f64, still_velocity: f64) -> Result<Vec<f64>, SignalError> {
    if !(f64::MIN_POSITIVE..1.0).contains(&threshold_fraction) {
        return Err(SignalError::InvalidThreshold { threshold_fraction });
    }
    if peaks.iter().all(|peak| *peak <= still_velocity) {
        let peak_velocity = peaks.iter().copied().fold(0.0, f64::max);
        return Err(SignalError::NoMotion { peak_velocity, still_velocity });
    }
    let threshold = |&peak: &f64| if peak > still_velocity { threshold_fraction * peak } else { f64::INFINITY };
    Ok(peaks.iter().map(threshold).collect())
}

/// The largest absolute value of each channel.
pub fn peaks(series: &Series) -> Vec<f64> {
    (0..series.len()).fold(vec![0.0; series.channels()], |mut peaks: Vec<f64>, k| {
        std::iter::zip(&mut peaks, series.sample(k)).for_each(|(peak, v)| *peak = peak.max(v.abs()));
        peaks
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_channel_counts_and_pauses_are_kept() -> Result<(), SignalError> {
        let first = vec![0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0];
        let second = vec![0.0, 0.0, 0.0, 0.0, 0.02, 0.0005, 0.0];
        let velocity = Series::side_by_side(&[first, second]);
        assert_eq!(moving_samples(&velocity, 0.01, 0.001)?, 2..6);
        assert_eq!(moving_samples(&velocity, 0.1, 0.001)?, 2..5);
        Ok(())
    }

    #[test]
    fn the_noise_of_a_still_channel_does_not_count() -> Result<(), SignalError> {
        let noise = vec![1e-5, -1e-5, 1e-5, -1e-5];
        let velocity = Series::side_by_side(&[noise, vec![0.0, 1.0, 0.5, 0.0]]);
        assert_eq!(moving_samples(&velocity, 0.01, 1e-3)?, 1..3);
        assert_eq!(moving_samples(&velocity, 0.01, 0.0)?, 0..4);
        Ok(())
    }

    #[test]
    fn a_recording_at_rest_is_refused() {
        let result = moving_samples(&Series::shaped(2, vec![1e-4, 0.0, -2e-4, 0.0]), 0.01, 1e-3);
        assert_eq!(result, Err(SignalError::NoMotion { peak_velocity: 2e-4, still_velocity: 1e-3 }));
        let result = moving_samples(&Series::zeros(5, 1), 0.01, 0.0);
        assert_eq!(result, Err(SignalError::NoMotion { peak_velocity: 0.0, still_velocity: 0.0 }));
    }

    #[test]
    fn a_fraction_out_of_range_is_refused() {
        for threshold_fraction in [0.0, 1.0, -0.1, f64::NAN] {
            let result = moving_samples(&Series::zeros(5, 1), threshold_fraction, 0.0);
            assert!(matches!(result, Err(SignalError::InvalidThreshold { .. })));
        }
    }
}
