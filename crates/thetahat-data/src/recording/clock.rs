//! The time steps of a recording, and equal steps if it has none.

use std::{ops::Range, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    RecordingError, STEP_TOLERANCE,
    checks::{require_finite, require_increasing},
    stretches::Stretches,
    table::MissingValues,
};
use thetahat_ground::{interpolation::lagrange_weights, series::Series};

/// Fraction of the steps that may deviate by more than the largest jitter: if more do, there is no usual step.
const MOST_IRREGULAR: f64 = 0.3;
/// Largest ratio of a recording's duration with gaps to that of its samples: longer gaps separate two recordings.
const LONGEST: usize = 20;

/// Part of the times that equal the one before from which a clock is coarser than the sampling, and not a sample written twice.
const COARSE: f64 = 0.15;
/// Ticks of a coarse clock by which a time may deviate from equal steps.
const TICKS: f64 = 1.5;

/// The sampling instants of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    sample_rate_hz: f64,
    stamps: Option<Vec<f64>>,
    resampling: Option<Resampling>,
    gaps: Vec<Range<usize>>,
    samples: usize,
    coarse: Option<CoarseTimes>,
}

/// Times of a clock whose ticks are longer than the steps of the sampling: the steps are equal, by the number of samples over the
/// time from the first to the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CoarseTimes {
    /// The tick of the clock, in the unit of the times.
    pub(super) tick: f64,
    /// The step of the sampling.
    pub(super) step: f64,
}

impl CoarseTimes {
    /// None of times that are not coarse, that fall, or that are far from equal steps.
    pub(super) fn of(times: &[f64]) -> Option<Self> {
        let [first, .., last] = times else { return None };
        let steps = || times.windows(2).map(|pair| pair[1] - pair[0]);
        let repeated = steps().filter(|step| *step == 0.0).count();
        if (repeated as f64) < COARSE * times.len() as f64 || steps().any(|step| step < 0.0 || !step.is_finite()) {
            return None;
        }
        let tick = steps().filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
        let step = (last - first) / (times.len() - 1) as f64;
        let is_near = |(k, time): (usize, &f64)| (time - first - step * k as f64).abs() <= TICKS * tick;
        (step > 0.0 && times.iter().enumerate().all(is_near)).then_some(Self { tick, step })
    }
}

/// How far the recorded time steps deviate from the usual one, in steps, if a recording is resampled to equal steps.
///
/// The value at each new instant comes from the cubic through the four nearest stamps, two on each side. A longer step is a gap and does
/// not count as a deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Resampling {
    /// Largest deviation of a step.
    pub largest_deviation: f64,
    /// Rms deviation.
    pub rms_deviation: f64,
    /// Number of gaps between samples.
    #[serde(default)]
    pub gaps: usize,
    /// Number of samples missing in the gaps.
    #[serde(default)]
    pub missing: usize,
}

impl Clock {
    /// Equal steps at a stated rate.
    #[must_use]
    pub fn uniform(sample_rate_hz: f64) -> Self {
        Self { sample_rate_hz, stamps: None, resampling: None, gaps: Vec::new(), samples: 0, coarse: None }
    }

    /// The clock of recorded times in s. Steps that deviate from the usual one by more than [`STEP_TOLERANCE`] of it are
    /// made equal by [`Clock::to_equal_steps`]; a step that is longer by more than `largest_jitter` of it is a gap. Where the clock's
    /// ticks are longer than the steps, many times are doubled: then the steps are equal, by the number of samples.
    ///
    /// `file` and `column` identify the times in error messages.
    ///
    /// # Errors
    /// If there are fewer than two times, a time is not finite or not later than the one before it, no step is the usual
    /// one, or the gaps are far longer than the recording.
    pub fn from_stamps(
        stamps: Vec<f64>,
        largest_jitter: f64,
        file: &Path,
        column: &str,
    ) -> Result<Self, RecordingError> {
        let [first, .., last] = stamps[..] else {
            return Err(RecordingError::TooFewTimes { file: file.into(), column: column.into(), found: stamps.len() });
        };
        require_finite(&stamps, file, column, MissingValues::Refused)?;
        if let Some(coarse) = CoarseTimes::of(&stamps) {
            let equal = (0..stamps.len()).map(|k| first + coarse.step * k as f64).collect();
            let clock = Self::uniform(1.0 / coarse.step);
            return Ok(Self { stamps: Some(equal), samples: stamps.len(), coarse: Some(coarse), ..clock });
        }
        require_increasing(&stamps, file, column)?;
        let steps: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let stretches = Stretches::of(&steps, largest_jitter.max(STEP_TOLERANCE));
        if stretches.steps > LONGEST * stamps.len() {
            let (sample, found) = largest(&steps);
            let (file, column) = (file.into(), column.into());
            return Err(RecordingError::GapTooLong { file, column, sample: sample + 1, found });
        }
        let step = (last - first) / stretches.steps as f64;
        let deviations: Vec<f64> = steps.iter().map(|s| (s / step - 1.0).abs()).collect();
        let regular: Vec<f64> = stretches.regular(&deviations);
        let (worst, _) = largest(&deviations);
        let irregular = deviations.iter().filter(|d| **d > largest_jitter.max(STEP_TOLERANCE)).count();
        if irregular as f64 > MOST_IRREGULAR * steps.len() as f64 {
            return Err(RecordingError::TooMuchJitter {
                file: file.into(),
                column: column.into(),
                sample: worst + 1,
                irregular,
                steps: steps.len(),
                expected: step,
                found: steps[worst],
                largest: largest_jitter,
            });
        }
        let samples = stretches.steps + 1;
        let gaps = stretches.missing_samples(&stamps, step);
        let resampling = Resampling {
            largest_deviation: largest(&regular).1,
            rms_deviation: (regular.iter().map(|d| d * d).sum::<f64>() / regular.len().max(1) as f64).sqrt(),
            gaps: gaps.len(),
            missing: gaps.iter().map(Range::len).sum(),
        };
        let is_uneven = resampling.largest_deviation > STEP_TOLERANCE || samples != stamps.len();
        let resampling = is_uneven.then_some(resampling);
        Ok(Self { sample_rate_hz: 1.0 / step, stamps: Some(stamps), resampling, gaps, samples, coarse: None })
    }

    /// Whether times are those of a clock that is coarser than the sampling.
    #[doc(hidden)]
    #[must_use]
    pub fn is_coarse(times: &[f64]) -> bool {
        CoarseTimes::of(times).is_some()
    }

    /// The tick of a clock that is coarser than the sampling, s.
    #[must_use]
    pub fn coarse_tick_s(&self) -> Option<f64> {
        self.coarse.map(|coarse| coarse.tick)
    }

    /// Samples per second: one divided by the usual step.
    #[must_use]
    pub fn sample_rate_hz(&self) -> f64 {
        self.sample_rate_hz
    }

    /// The recorded times, if there are any.
    #[must_use]
    pub fn stamps(&self) -> Option<&[f64]> {
        self.stamps.as_deref()
    }

    /// The deviation of the steps, if they are to be made equal.
    #[must_use]
    pub fn resampling(&self) -> Option<Resampling> {
        self.resampling
    }

    /// The samples at equal steps without a stamp nearby: they lie in gaps.
    #[must_use]
    pub fn gaps(&self) -> &[Range<usize>] {
        &self.gaps
    }

    /// The series at equal steps from the first stamp to the last; unchanged if its steps are equal. A gap is filled by a cubic.
    ///
    /// # Panics
    /// If the series has not one sample for each stamp.
    #[must_use]
    pub fn to_equal_steps(&self, series: Series) -> Series {
        match (&self.resampling, &self.stamps) {
            (Some(_), Some(stamps)) => self.interpolate(&series, stamps),
            _ => series,
        }
    }

    fn interpolate(&self, series: &Series, stamps: &[f64]) -> Series {
        assert_eq!(series.len(), stamps.len(), "one sample for each stamp");
        let (first, last) = (stamps[0], stamps[stamps.len() - 1]);
        let mut even = Series::zeros(self.samples, series.channels());
        let mut left = 0;
        for k in 0..self.samples {
            let t = first + (last - first) * k as f64 / (self.samples - 1) as f64;
            while left + 2 < stamps.len() && stamps[left + 1] <= t {
                left += 1;
            }
            let nodes = self.nodes(left, stamps);
            let times: Vec<f64> = nodes.iter().map(|&n| stamps[n]).collect();
            for (&node, weight) in nodes.iter().zip(lagrange_weights(&times, t)) {
                even.sample_mut(k).iter_mut().zip(series.sample(node)).for_each(|(e, v)| *e += weight * v);
            }
        }
        even
    }

    /// The stamps of the cubic after a stamp: the nearest four, or across a gap its two ends and one stamp half a gap before and one half a
    /// gap after, so that noise does not grow with the gap.
    fn nodes(&self, stamp: usize, stamps: &[f64]) -> Vec<usize> {
        let (before, after) = (stamps[stamp], stamps[(stamp + 1).min(stamps.len() - 1)]);
        let half = 0.5 * (after - before);
        if half * self.sample_rate_hz < 1.0 {
            let start = stamp.saturating_sub(1).min(stamps.len().saturating_sub(4));
            return (start..stamps.len().min(start + 4)).collect();
        }
        let outer = stamps.partition_point(|&t| t <= before - half).checked_sub(1).filter(|&n| n < stamp);
        let beyond = stamps.partition_point(|&t| t < after + half);
        let inner = [stamp, stamp + 1].into_iter();
        outer.into_iter().chain(inner).chain((beyond < stamps.len() && beyond > stamp + 1).then_some(beyond)).collect()
    }
}

/// The largest of some values, and its place.
fn largest(values: &[f64]) -> (usize, f64) {
    let worst = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    worst.map_or((0, 0.0), |(k, d)| (k, *d))
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
        let series = Series::shaped(1, (0..100).map(f64::from).collect());
        assert_eq!(clock.to_equal_steps(series.clone()), series);
    }

    /// The interpolation reproduces a cubic.
    #[test]
    fn a_cubic_is_met_exactly() {
        let stamps = jittered(200);
        let cubic = |t: f64| 1.0 + (t - 5.0) * (2.0 - 30.0 * (t - 5.0) * (1.0 - 4.0 * (t - 5.0)));
        let series = Series::shaped(1, stamps.iter().map(|&t| cubic(t)).collect());
        let (first, last) = (stamps[0], stamps[199]);
        let even = clock(stamps).unwrap().to_equal_steps(series);
        for k in 0..200 {
            let t = first + (last - first) * k as f64 / 199.0;
            assert!((even.sample(k)[0] - cubic(t)).abs() < 1e-12, "{k}");
        }
    }

    /// For a sine with 100 samples a period the cubic leaves an error of 3/128 h^4 omega^4, 4e-7 of its amplitude with equal
    /// steps.
    #[test]
    fn a_motion_is_recovered() {
        let stamps = jittered(2000);
        let motion = |t: f64| (2.0 * std::f64::consts::PI * 10.0 * t).sin();
        let series = Series::shaped(1, stamps.iter().map(|&t| motion(t)).collect());
        let (first, last) = (stamps[0], stamps[1999]);
        let even = clock(stamps).unwrap().to_equal_steps(series);
        let error = |k: usize| even.sample(k)[0] - motion(first + (last - first) * k as f64 / 1999.0);
        assert!((2..1997).all(|k| error(k).abs() < 2e-6));
    }

    /// The rate is that of the usual step, and the samples keep their positions.
    #[test]
    fn lost_samples_are_a_gap_and_the_others_keep_their_places() {
        for lost in [1, 3, 40, 700] {
            let kept = |k: &usize| *k < 500 || *k >= 500 + lost;
            let stamps: Vec<f64> = (0..2000).filter(kept).map(|k| 3.0 + 1e-3 * k as f64).collect();
            let motion = |t: f64| (2.0 * std::f64::consts::PI * 0.7 * t).sin();
            let series = Series::shaped(1, stamps.iter().map(|&t| motion(t)).collect());
            let clock = clock(stamps).unwrap();
            assert!((clock.sample_rate_hz() - 1000.0).abs() < 1e-6, "{lost}");
            assert_eq!((clock.gaps().len(), clock.gaps()[0].clone()), (1, 500..500 + lost), "{lost}");
            let even = clock.to_equal_steps(series);
            assert_eq!(even.len(), 2000);
            let error = |k: usize| (even.sample(k)[0] - motion(3.0 + 1e-3 * k as f64)).abs();
            assert!((0..2000).filter(kept).all(|k| error(k) < 1e-9), "{lost}");
            assert!((0..2000).all(|k| error(k) < if lost < 100 { 1e-4 } else { 1.0 }), "{lost}");
        }
    }

    /// Gaps and jitter together, with gaps that are not a whole number of steps.
    #[test]
    fn gaps_in_a_recording_with_jitter() {
        let late = |k: usize| if k >= 300 { 0.4e-3 } else { 0.0 };
        let stamps: Vec<f64> = jittered(1000)
            .iter()
            .enumerate()
            .filter(|(k, _)| !(300..305).contains(k))
            .map(|(k, t)| t + late(k))
            .collect();
        let series = Series::shaped(1, stamps.clone());
        let clock = clock(stamps).unwrap();
        let resampling = clock.resampling().unwrap();
        assert!(resampling.gaps == 1 && (5..=6).contains(&resampling.missing), "{resampling:?}");
        assert!((clock.sample_rate_hz() - 1000.0).abs() < 1.0 && resampling.largest_deviation < 0.5);
        let even = clock.to_equal_steps(series);
        let steps = even.values().windows(2).map(|w| w[1] - w[0]);
        assert!(steps.into_iter().all(|s| (s - 1.0 / clock.sample_rate_hz()).abs() < 1e-9));
    }

    /// Noise does not grow with the gap.
    #[test]
    fn noise_is_not_raised_in_a_gap() {
        let stamps: Vec<f64> = (0..1000).filter(|k| !(400..500).contains(k)).map(|k| 1e-3 * f64::from(k)).collect();
        let values = stamps.iter().enumerate().map(|(k, _)| (7.3 * k as f64).sin()).collect();
        let even = clock(stamps).unwrap().to_equal_steps(Series::shaped(1, values));
        assert!(even.values().iter().all(|v| v.abs() < 2.0));
    }

    #[test]
    fn steps_of_which_none_is_the_usual_are_refused_with_the_worst() {
        let stamps: Vec<f64> = (0..100)
            .scan(0.0, |t, k| {
                *t += 1e-3 * f64::from(1 + k * k % 7);
                Some(*t)
            })
            .collect();
        let error = clock(stamps).unwrap_err();
        assert!(matches!(error, RecordingError::TooMuchJitter { .. }), "{error}");
    }

    #[test]
    fn a_gap_far_longer_than_the_recording_is_refused() {
        let stamps: Vec<f64> = (0..100).map(|k| 1e-3 * f64::from(k) + if k < 50 { 0.0 } else { 1e6 }).collect();
        assert!(matches!(clock(stamps), Err(RecordingError::GapTooLong { sample: 50, .. })));
    }

    #[test]
    fn few_samples_are_interpolated_with_what_there_is() {
        let clock = clock(vec![0.0, 1.0, 2.3]).unwrap();
        let even = clock.to_equal_steps(Series::shaped(1, vec![0.0, 2.0, 4.6]));
        assert!((even.sample(1)[0] - 2.3).abs() < 1e-12);
    }

    /// A clock of 8 ms on samples of 4 ms, and one of 10 ms on samples of 4 ms.
    #[test]
    fn a_coarse_clock_has_the_rate_of_its_samples() {
        for tick in [8.0, 10.0] {
            let stamps = (0..1000).map(|k| 1e-3 * tick * (4.0 * f64::from(k) / tick).floor()).collect();
            let clock = clock(stamps).unwrap();
            assert!((clock.sample_rate_hz() / 250.0 - 1.0).abs() < 3e-3, "{}", clock.sample_rate_hz());
            assert!(clock.resampling().is_none() && clock.gaps().is_empty());
            assert!((clock.coarse_tick_s().unwrap() - 1e-3 * tick).abs() < 1e-9);
        }
    }

    #[test]
    fn a_coarse_clock_with_a_gap_is_refused() {
        let place = |k: u32| f64::from(if k < 500 { k } else { k + 400 });
        let stamps = (0..1000).map(|k| 8e-3 * (0.5 * place(k)).floor()).collect();
        assert!(matches!(clock(stamps), Err(RecordingError::TimeNotIncreasing { .. })));
    }

    #[test]
    fn a_time_that_goes_back_is_refused() {
        assert!(matches!(clock(vec![0.0, 1.0, 0.5]), Err(RecordingError::TimeNotIncreasing { sample: 2, .. })));
    }
}
