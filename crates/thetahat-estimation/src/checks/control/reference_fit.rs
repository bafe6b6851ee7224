//! The delay, scale and offset between a reference and the motion: `q(k) = scale r(k - delay) + offset`.

use crate::{
    checks::{
        numbers::{delay, deviation, mean, rms},
        remedy_step::RemedyStep,
    },
    signal::{central_difference, delayed},
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
};

/// The longest delay of the search is the length of the recording divided by this.
const LONGEST_PART: usize = 20;
/// Steps of Gauss-Newton.
const ITERATIONS: usize = 12;
/// A simpler correction is chosen if it leaves at most this times the rms difference of the full one.
const AS_GOOD: f64 = 1.25;
/// So is one that leaves at most this part of the motion's standard deviation: clean recordings have up to 0.8 %.
const CLEAN: f64 = 0.01;
/// Largest part of the rms difference that an explanation may leave.
const EXPLAINED: f64 = 0.5;
/// Delays of joints that differ by less, in samples or relatively, are one delay of the recording.
const SAME: f64 = 0.25;

/// Which of delay, scale and offset are free, the simplest first.
const FREE: [[bool; 3]; 7] = [
    [true, false, false],
    [false, true, false],
    [false, false, true],
    [true, true, false],
    [true, false, true],
    [false, true, true],
    [true, true, true],
];

/// The correction of the reference of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
struct JointCorrection {
    /// Delay of the motion, samples.
    samples: f64,
    scale: f64,
    offset: f64,
}

const NONE: JointCorrection = JointCorrection { samples: 0.0, scale: 1.0, offset: 0.0 };

/// The correction of the references of all joints.
pub(in crate::checks) struct Correction {
    joints: Vec<JointCorrection>,
}

/// The correction that brings the joints `off` their references within `limit_percent` of their motion; `None` if there is
/// none.
pub(in crate::checks) fn proposed(
    position: &Series,
    reference: &Series,
    off: &[usize],
    limit_percent: f64,
) -> Option<Correction> {
    let mut joints = vec![NONE; position.channels()];
    for &j in off {
        let (q, r) = (position.channel(j), reference.channel(j));
        let (found, left) = simplest(&q, &r)?;
        if 100.0 * left > limit_percent * deviation(&q) {
            return None;
        }
        joints[j] = found;
    }
    let delays: Vec<f64> = off.iter().map(|&j| joints[j].samples).collect();
    if let Some(common) = common(&delays) {
        joints.iter_mut().for_each(|joint| joint.samples = common);
    }
    (!off.is_empty()).then_some(Correction { joints })
}

/// The mean of delays that are equal and not zero.
fn common(delays: &[f64]) -> Option<f64> {
    let mean = mean(delays);
    let same = |d: &f64| *d != 0.0 && (d - mean).abs() < SAME * mean.abs().max(1.0);
    (!delays.is_empty() && delays.iter().all(same)).then_some(mean)
}

/// The simplest correction that is nearly as good as all three together, with the rms difference that it leaves.
fn simplest(q: &[f64], r: &[f64]) -> Option<(JointCorrection, f64)> {
    let fits: Vec<_> = FREE.iter().filter_map(|free| fit(q, r, *free)).collect();
    let best = fits.iter().map(|f| f.1).fold(f64::INFINITY, f64::min);
    fits.into_iter().find(|f| f.1 <= (AS_GOOD * best).max(CLEAN * deviation(q)))
}

/// The cause of most of the difference of two signals: the simplest delay, scale and offset that leave less than half of its
/// rms; `None` if there is none.
pub(in crate::checks) fn explanation(q: &[f64], r: &[f64], sample_rate_hz: f64) -> Option<String> {
    let difference: Vec<f64> = q.iter().zip(r).map(|(q, r)| q - r).collect();
    let (found, _) = simplest(q, r).filter(|(_, left)| *left < EXPLAINED * rms(&difference))?;
    let JointCorrection { samples, scale, offset } = found;
    let ms = 1e3 * samples.abs() / sample_rate_hz;
    let order = if samples > 0.0 { "late" } else { "early" };
    let late = (samples != 0.0).then(|| format!("{:.1} samples ({ms:.1} ms) {order}", samples.abs()));
    let scaled = (scale != 1.0).then(|| format!("{scale:.4} times as large"));
    let shifted = (offset != 0.0).then(|| format!("off by {offset:.4}"));
    let parts: Vec<String> = [late, scaled, shifted].into_iter().flatten().collect();
    Some(format!("it is {}", parts.join(", ")))
}

/// Least squares for the free quantities, by Gauss-Newton from the best whole delay.
fn fit(q: &[f64], r: &[f64], free: [bool; 3]) -> Option<(JointCorrection, f64)> {
    let reach = (q.len() / LONGEST_PART).max(1);
    let mut found = NONE;
    if free[0] {
        found.samples = delay(&standardised(q), &standardised(r), reach)?;
    }
    for _ in 0..ITERATIONS {
        let (rest, columns) = linearised(q, r, found, free, reach);
        if columns.columns() == 0 {
            break;
        }
        let qr = PivotedQr::new(&columns);
        if qr.rank(1e-12) < columns.columns() {
            return None;
        }
        let mut step = qr.solve(&rest).into_iter();
        let mut change = |is_free: bool| if is_free { step.next().unwrap_or_default() } else { 0.0 };
        found.samples += change(free[0]).clamp(-1.0, 1.0);
        found.scale += change(free[1]);
        found.offset += change(free[2]);
    }
    let left = rms(&linearised(q, r, found, free, reach).0);
    (left.is_finite() && found.samples.abs() < reach as f64).then_some((found, left))
}

/// A signal minus its mean, divided by its standard deviation.
fn standardised(x: &[f64]) -> Vec<f64> {
    let (mean, deviation) = (mean(x), deviation(x));
    x.iter().map(|v| (v - mean) / deviation).collect()
}

/// The residual of a correction and its derivatives by the free quantities, without the ends of the recording.
fn linearised(q: &[f64], r: &[f64], at: JointCorrection, free: [bool; 3], reach: usize) -> (Vec<f64>, Matrix) {
    let late = delayed(&Series::side_by_side(&[r.to_vec()]), &[at.samples]);
    let slope = central_difference(&late, 1.0);
    let inside = reach..q.len() - reach;
    let value = |k: usize| late.sample(k)[0];
    let rest = inside.clone().map(|k| q[k] - at.scale * value(k) - at.offset).collect();
    let by = |k: usize, i: usize| [-at.scale * slope.sample(k)[0], value(k), 1.0][i];
    let free: Vec<usize> = (0..3).filter(|i| free[*i]).collect();
    (rest, Matrix::from_fn(inside.len(), free.len(), |k, i| by(k + inside.start, free[i])))
}

impl Correction {
    /// The line for `[recording]` that applies it.
    pub(in crate::checks) fn text(&self, sample_rate_hz: f64) -> String {
        let list = |value: fn(&JointCorrection) -> f64, unit: f64| {
            let numbers: Vec<String> = self.rounded(value, unit).iter().map(|v| format!("{v:?}")).collect();
            let all_same = numbers.iter().all(|n| *n == numbers[0]);
            if all_same { numbers[0].clone() } else { format!("[{}]", numbers.join(", ")) }
        };
        format!(
            "reference_correction = {{ delay_s = {}, scale = {}, offset = {} }}",
            list(|j| j.samples, 1.0 / sample_rate_hz),
            list(|j| j.scale, 1.0),
            list(|j| j.offset, 1.0)
        )
    }

    /// The same as a change of the settings.
    pub(in crate::checks) fn step(&self, sample_rate_hz: f64) -> RemedyStep {
        RemedyStep::CorrectReference {
            delay_s: self.rounded(|j| j.samples, 1.0 / sample_rate_hz),
            scale: self.rounded(|j| j.scale, 1.0),
            offset: self.rounded(|j| j.offset, 1.0),
        }
    }

    /// A number of each joint, times a unit.
    fn rounded(&self, value: fn(&JointCorrection) -> f64, unit: f64) -> Vec<f64> {
        self.joints.iter().map(|j| (1e7 * unit * value(j)).round() / 1e7 + 0.0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(t: f64, j: usize) -> f64 {
        (0.02 * t + j as f64).sin() + 0.4 * (0.051 * t).cos()
    }

    fn series(of: impl Fn(f64, usize) -> f64) -> Series {
        Series::shaped(2, (0..2000).flat_map(|k| [of(f64::from(k), 0), of(f64::from(k), 1)]).collect())
    }

    fn text_of(position: &Series, reference: &Series, off: &[usize]) -> Option<String> {
        proposed(position, reference, off, 5.0).map(|c| c.text(1000.0))
    }

    #[test]
    fn each_fault_is_named_by_the_simplest_correction() {
        let position = series(wave);
        let late = series(|t, j| wave(t - 7.4, j));
        let expected = "reference_correction = { delay_s = -0.0074, scale = 1.0, offset = 0.0 }";
        assert_eq!(text_of(&position, &late, &[0, 1]).unwrap(), expected);
        let scaled = series(|t, j| if j == 1 { wave(t, j) / 1.25 } else { wave(t, j) });
        let expected = "reference_correction = { delay_s = 0.0, scale = [1.0, 1.25], offset = 0.0 }";
        assert_eq!(text_of(&position, &scaled, &[1]).unwrap(), expected);
        let shifted = series(|t, j| wave(t, j) - 0.3);
        let expected = "reference_correction = { delay_s = 0.0, scale = 1.0, offset = 0.3 }";
        assert_eq!(text_of(&position, &shifted, &[0, 1]).unwrap(), expected);
    }

    #[test]
    fn the_three_together_are_distinguished() {
        let position = series(wave);
        let wrong = series(|t, j| (wave(t + 12.6, j) - 0.3) / 0.8);
        let found = proposed(&position, &wrong, &[0, 1], 5.0).unwrap();
        for joint in found.joints {
            assert!((joint.samples - 12.6).abs() < 1e-3, "{joint:?}");
            assert!((joint.scale - 0.8).abs() < 1e-5 && (joint.offset - 0.3).abs() < 1e-5, "{joint:?}");
        }
    }

    #[test]
    fn another_motion_has_no_correction() {
        let other = series(|t, _| (0.033 * t).sin());
        assert_eq!(text_of(&series(wave), &other, &[0, 1]), None);
    }

    /// A fit would end at the limit of the search, 205 samples, with the scale of noise, 44.
    #[test]
    fn the_end_of_the_search_is_no_explanation() {
        let far = series(|t, j| 0.02 * wave(t - 205.0, j));
        assert_eq!(explanation(&series(wave).channel(0), &far.channel(0), 1000.0), None);
        let near = series(|t, j| wave(t + 12.0, j));
        let found = explanation(&series(wave).channel(0), &near.channel(0), 1000.0);
        assert_eq!(found.as_deref(), Some("it is 12.0 samples (12.0 ms) late"));
    }
}
