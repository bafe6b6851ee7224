//! Checks between signals and over time.

use std::path::Path;

use super::error::RecordingError;
use super::table::{MissingValues, is_plausible};
use thetahat_ground::series::Series;

/// Largest deviation of a time step from the mean step, relative to the mean step.
///
/// A thousandth of a step is far below what affects filtering and differentiation, and far above the rounding of a time axis that was
/// written with enough digits.
pub const STEP_TOLERANCE: f64 = 1e-3;

/// The sample rate in Hz of a time axis in seconds: the number of steps divided by their total time.
///
/// `file` and `column` identify the times in error messages.
///
/// # Errors
/// If there are fewer than two times, a time is not finite or not later than the one before it, or a step deviates from
/// the mean step by more than [`STEP_TOLERANCE`].
///
/// ```
/// let rate = thetahat_data::recording::sample_rate_from_time(&[0.0, 0.5, 1.0], "q.csv".as_ref(), "t").unwrap();
/// assert_eq!(rate, 2.0);
/// ```
pub fn sample_rate_from_time(time: &[f64], file: &Path, column: &str) -> Result<f64, RecordingError> {
    let [first, .., last] = time else {
        return Err(RecordingError::TooFewTimes { file: file.into(), column: column.into(), found: time.len() });
    };
    require_finite(time, file, column, MissingValues::Refused)?;
    require_increasing(time, file, column)?;
    let step = (last - first) / (time.len() - 1) as f64;
    require_uniform(time, step, file, column)?;
    Ok(1.0 / step)
}

/// Checks that two signals have the same number of samples.
///
/// `what` and `file` identify the signals in error messages.
///
/// # Errors
/// [`RecordingError::DifferentLengths`] otherwise.
pub fn same_length(
    a: &Series,
    what_a: &str,
    file_a: &Path,
    b: &Series,
    what_b: &str,
    file_b: &Path,
) -> Result<(), RecordingError> {
    if a.len() == b.len() {
        return Ok(());
    }
    Err(RecordingError::DifferentLengths {
        first: what_a.into(),
        first_file: file_a.into(),
        first_samples: a.len(),
        second: what_b.into(),
        second_file: file_b.into(),
        second_samples: b.len(),
    })
}

/// Checks that a signal has one channel.
///
/// # Errors
/// [`RecordingError::NotOneChannel`] if it has several.
pub fn one_channel(series: &Series, what: &str, file: &Path) -> Result<(), RecordingError> {
    match series.channels() {
        1 => Ok(()),
        found => Err(RecordingError::NotOneChannel { file: file.into(), signal: what.into(), found }),
    }
}

/// Checks that a signal is not zero throughout, like a signal that was not recorded.
///
/// # Errors
/// [`RecordingError::AllZero`] if it is.
pub fn not_all_zero(series: &Series, what: &str, file: &Path) -> Result<(), RecordingError> {
    if series.values().iter().any(|v| *v != 0.0) {
        return Ok(());
    }
    Err(RecordingError::AllZero { file: file.into(), signal: what.into() })
}

/// Checks that all values of a named column are finite, or missing where those are kept.
pub(super) fn require_finite(
    values: &[f64],
    file: &Path,
    column: &str,
    missing: MissingValues,
) -> Result<(), RecordingError> {
    let is_kept = |value: f64| value.is_nan() && missing == MissingValues::Kept;
    match values.iter().position(|value| !is_plausible(*value) && !is_kept(*value)) {
        None => Ok(()),
        Some(sample) => Err(RecordingError::NotFiniteSample {
            file: file.into(),
            column: column.into(),
            sample,
            found: values[sample],
        }),
    }
}

pub(super) fn require_increasing(time: &[f64], file: &Path, column: &str) -> Result<(), RecordingError> {
    match time.windows(2).position(|pair| pair[1] <= pair[0]) {
        None => Ok(()),
        Some(k) => {
            let (file, column, sample, previous, found) = (file.into(), column.into(), k + 1, time[k], time[k + 1]);
            Err(match is_restart(time, sample) {
                true => RecordingError::TimeRestarts { file, column, sample, previous, found },
                false => RecordingError::TimeNotIncreasing { file, column, sample, previous, found },
            })
        }
    }
}

/// Steps by which a time goes back at least where a second recording begins, and samples of each of the two.
const RESTART: usize = 50;

/// Whether times go back at a sample by many steps, and rise for as long before and after it.
pub(super) fn is_restart(time: &[f64], sample: usize) -> bool {
    let Some(before) = sample.checked_sub(RESTART) else { return false };
    let rises = |times: &[f64]| times.windows(2).all(|pair| pair[1] > pair[0]);
    let Some(after) = time.get(sample..sample + RESTART) else { return false };
    let length = time[sample - 1] - time[before];
    let back = time[sample - 1] - time[sample];
    // The time after a misplaced sample is near the one before it.
    let goes_on = after[1] - after[0] < 0.5 * back;
    rises(&time[before..sample]) && rises(after) && back >= length && goes_on
}

fn require_uniform(time: &[f64], step: f64, file: &Path, column: &str) -> Result<(), RecordingError> {
    let (mut worst, mut deviation) = (0, 0.0);
    for (k, pair) in time.windows(2).enumerate() {
        let candidate = (pair[1] - pair[0] - step).abs();
        if candidate > deviation {
            (worst, deviation) = (k, candidate);
        }
    }
    if deviation <= STEP_TOLERANCE * step {
        return Ok(());
    }
    Err(RecordingError::TimeNotUniform {
        file: file.into(),
        column: column.into(),
        sample: worst + 1,
        expected: step,
        found: time[worst + 1] - time[worst],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of the times themselves, relative to the rate.
    const ROUNDING: f64 = 1e-12;

    fn rate(time: &[f64]) -> Result<f64, RecordingError> {
        sample_rate_from_time(time, Path::new("q.csv"), "t")
    }

    fn times(steps: usize) -> Vec<f64> {
        (0..=steps).map(|k| 3.0 + 1e-3 * k as f64).collect()
    }

    #[test]
    fn equal_steps_give_the_rate() {
        assert!((rate(&times(1000)).unwrap() / 1000.0 - 1.0).abs() < ROUNDING);
    }

    #[test]
    fn single_time() {
        assert!(matches!(rate(&[1.0]), Err(RecordingError::TooFewTimes { found: 1, .. })));
    }

    #[test]
    fn time_that_is_not_finite() {
        let mut time = times(10);
        time[10] = f64::INFINITY;
        assert!(matches!(rate(&time), Err(RecordingError::NotFiniteSample { sample: 10, .. })));
    }

    #[test]
    fn two_takes_are_no_misplaced_sample() {
        let takes: Vec<f64> = (0..400).map(|k| 1e-3 * f64::from(k % 200)).collect();
        let error = require_increasing(&takes, Path::new("log.csv"), "t").unwrap_err();
        assert!(matches!(error, RecordingError::TimeRestarts { sample: 200, .. }), "{error}");
        let mut misplaced: Vec<f64> = (0..400).map(|k| 1e-3 * f64::from(k)).collect();
        misplaced[200] = 0.01;
        let error = require_increasing(&misplaced, Path::new("log.csv"), "t").unwrap_err();
        assert!(matches!(error, RecordingError::TimeNotIncreasing { sample: 200, .. }), "{error}");
    }

    #[test]
    fn doubled_time() {
        let mut time = times(10);
        time[4] = time[3];
        assert!(matches!(rate(&time), Err(RecordingError::TimeNotIncreasing { sample: 4, .. })));
    }

    #[test]
    fn one_late_sample() {
        let mut time = times(10);
        time[7] += 2e-6;
        assert!(matches!(rate(&time), Err(RecordingError::TimeNotUniform { sample: 7 | 8, .. })));
    }

    #[test]
    fn lost_samples() {
        let mut time = times(1000);
        time.drain(500..503);
        let error = rate(&time).unwrap_err();
        assert!(matches!(error, RecordingError::TimeNotUniform { sample: 500, .. }));
    }

    #[test]
    fn signals_of_the_same_length() {
        let (a, b) = (Series::zeros(5, 2), Series::zeros(5, 3));
        same_length(&a, "position", Path::new("q.csv"), &b, "torque", Path::new("tau.csv")).unwrap();
    }

    #[test]
    fn signals_of_different_lengths() {
        let (a, b) = (Series::zeros(5, 2), Series::zeros(4, 2));
        let error = same_length(&a, "position", Path::new("q.csv"), &b, "torque", Path::new("tau.csv")).unwrap_err();
        assert!(matches!(error, RecordingError::DifferentLengths { first_samples: 5, second_samples: 4, .. }));
    }
}
