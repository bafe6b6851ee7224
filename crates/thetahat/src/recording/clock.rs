//! The time steps of a record, and equal ones where it has none.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{
    RecordingError, STEP_TOLERANCE,
    checks::{require_finite, require_increasing},
};
use crate::series::Series;

/// The sampling instants of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    sample_rate_hz: f64,
    stamps: Option<Vec<f64>>,
    resampling: Option<Resampling>,
}

/// How far the recorded time steps deviate from the mean one, in steps, where a record is brought to equal steps.
///
/// The value at each new instant comes from the cubic through the four nearest stamps, two on each side.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Resampling {
    /// Largest deviation of a step.
    pub largest_deviation: f64,
    /// Rms deviation.
    pub rms_deviation: f64,
}

impl Clock {
    /// Equal steps at a stated rate.
    #[must_use]
    pub fn uniform(sample_rate_hz: f64) -> Self {
        Self { sample_rate_hz, stamps: None, resampling: None }
    }

    /// The clock of recorded times in s. Steps that deviate from their mean by more than [`STEP_TOLERANCE`] of it are made
    /// equal by [`Clock::to_equal_steps`], unless one deviates by more than `largest_jitter` of it.
    ///
    /// `file` and `column` say in an error where the times come from.
    ///
    /// # Errors
    /// If there are fewer than two times, a time is not finite or not later than the one before it, or the jitter is too
    /// large.
    pub fn from_stamps(
        stamps: Vec<f64>,
        largest_jitter: f64,
        file: &Path,
        column: &str,
    ) -> Result<Self, RecordingError> {
        let [first, .., last] = stamps[..] else {
            return Err(RecordingError::TooFewTimes { file: file.into(), column: column.into(), found: stamps.len() });
        };
        require_finite(&stamps, file, column)?;
        require_increasing(&stamps, file, column)?;
        let step = (last - first) / (stamps.len() - 1) as f64;
        let deviations: Vec<f64> = stamps.windows(2).map(|pair| ((pair[1] - pair[0]) / step - 1.0).abs()).collect();
        let (worst, largest) = largest(&deviations);
        if largest > largest_jitter.max(STEP_TOLERANCE) {
            return Err(RecordingError::TooMuchJitter {
                file: file.into(),
                column: column.into(),
                sample: worst + 1,
                expected: step,
                found: stamps[worst + 1] - stamps[worst],
                largest: largest_jitter,
            });
        }
        let rms = (deviations.iter().map(|d| d * d).sum::<f64>() / deviations.len() as f64).sqrt();
        let resampling = Resampling { largest_deviation: largest, rms_deviation: rms };
        let resampling = (largest > STEP_TOLERANCE).then_some(resampling);
        Ok(Self { sample_rate_hz: 1.0 / step, stamps: Some(stamps), resampling })
    }

    /// Samples per second: the number of steps divided by the time they take.
    #[must_use]
    pub fn sample_rate_hz(&self) -> f64 {
        self.sample_rate_hz
    }

    /// The recorded times, where there are any.
    #[must_use]
    pub fn stamps(&self) -> Option<&[f64]> {
        self.stamps.as_deref()
    }

    /// The deviation of the steps, where they are to be made equal.
    #[must_use]
    pub fn resampling(&self) -> Option<Resampling> {
        self.resampling
    }

    /// The series at equal steps from the first stamp to the last, as many as it had; itself where its steps are equal.
    ///
    /// # Panics
    /// If the series has not one sample for each stamp.
    #[must_use]
    pub fn to_equal_steps(&self, series: Series) -> Series {
        match (&self.resampling, &self.stamps) {
            (Some(_), Some(stamps)) => interpolate(&series, stamps),
            _ => series,
        }
    }
}

fn largest(deviations: &[f64]) -> (usize, f64) {
    let worst = deviations.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    worst.map_or((0, 0.0), |(k, d)| (k, *d))
}

fn interpolate(series: &Series, stamps: &[f64]) -> Series {
    let samples = stamps.len();
    assert_eq!(series.len(), samples, "one sample for each stamp");
    let (first, last) = (stamps[0], stamps[samples - 1]);
    let mut even = Series::zeros(samples, series.channels());
    let mut behind = 0;
    for k in 0..samples {
        let t = first + (last - first) * k as f64 / (samples - 1) as f64;
        while behind + 2 < samples && stamps[behind + 1] <= t {
            behind += 1;
        }
        let start = behind.saturating_sub(1).min(samples.saturating_sub(4));
        let near = &stamps[start..samples.min(start + 4)];
        for (i, weight) in lagrange_weights(near, t).enumerate() {
            let values = series.sample(start + i);
            even.sample_mut(k).iter_mut().zip(values).for_each(|(e, v)| *e += weight * v);
        }
    }
    even
}

/// Weights of the values at `near` in the polynomial through them, at `t`.
fn lagrange_weights(near: &[f64], t: f64) -> impl Iterator<Item = f64> {
    let factor = move |i: usize, j: usize| (t - near[j]) / (near[i] - near[j]);
    (0..near.len()).map(move |i| (0..near.len()).filter(|&j| j != i).map(|j| factor(i, j)).product())
}

#[cfg(test)]
mod tests {
    use super::*;

    const JITTER: f64 = 0.3;

    /// Times with steps of 1 ms that deviate by up to `JITTER` of it.
    fn jittered(samples: usize) -> Vec<f64> {
        (0..samples).map(|k| 5.0 + 1e-3 * (k as f64 + 0.5 * JITTER * (2.3 * k as f64).sin())).collect()
    }

    fn clock(stamps: Vec<f64>) -> Result<Clock, RecordingError> {
        Clock::from_stamps(stamps, 0.5, Path::new("q.csv"), "t")
    }

    #[test]
    fn equal_steps_are_left_alone() {
        let clock = clock((0..100).map(|k| 1e-3 * f64::from(k)).collect()).unwrap();
        assert!((clock.sample_rate_hz() - 1000.0).abs() < 1e-9 && clock.resampling().is_none());
        let series = Series::from_values(1, (0..100).map(f64::from).collect());
        assert_eq!(clock.to_equal_steps(series.clone()), series);
    }

    /// A cubic is its own interpolation.
    #[test]
    fn a_cubic_is_met_exactly() {
        let stamps = jittered(200);
        let cubic = |t: f64| 1.0 + (t - 5.0) * (2.0 - 30.0 * (t - 5.0) * (1.0 - 4.0 * (t - 5.0)));
        let series = Series::from_values(1, stamps.iter().map(|&t| cubic(t)).collect());
        let (first, last) = (stamps[0], stamps[199]);
        let even = clock(stamps).unwrap().to_equal_steps(series);
        for k in 0..200 {
            let t = first + (last - first) * k as f64 / 199.0;
            assert!((even.sample(k)[0] - cubic(t)).abs() < 1e-12, "{k}");
        }
    }

    /// Of a sine with 100 samples a period the cubic leaves an error of 3/128 h^4 omega^4, 4e-7 of its amplitude with equal
    /// steps.
    #[test]
    fn a_motion_is_recovered() {
        let stamps = jittered(2000);
        let motion = |t: f64| (2.0 * std::f64::consts::PI * 10.0 * t).sin();
        let series = Series::from_values(1, stamps.iter().map(|&t| motion(t)).collect());
        let (first, last) = (stamps[0], stamps[1999]);
        let even = clock(stamps).unwrap().to_equal_steps(series);
        let error = |k: usize| even.sample(k)[0] - motion(first + (last - first) * k as f64 / 1999.0);
        assert!((2..1997).all(|k| error(k).abs() < 2e-6));
    }

    #[test]
    fn jitter_above_the_limit_is_refused_with_its_sample() {
        let mut stamps = jittered(100);
        stamps[40] += 0.9e-3;
        assert!(matches!(clock(stamps), Err(RecordingError::TooMuchJitter { sample: 40 | 41, .. })));
    }

    #[test]
    fn few_samples_are_interpolated_with_what_there_is() {
        let clock = clock(vec![0.0, 1.0, 2.3]).unwrap();
        let even = clock.to_equal_steps(Series::from_values(1, vec![0.0, 2.0, 4.6]));
        assert!((even.sample(1)[0] - 2.3).abs() < 1e-12);
    }

    #[test]
    fn a_time_that_goes_back_is_refused() {
        assert!(matches!(clock(vec![0.0, 1.0, 0.5]), Err(RecordingError::TimeNotIncreasing { sample: 2, .. })));
    }
}
