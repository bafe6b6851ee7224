//! The delay, scale and offset with which a reference describes the motion: `q(k) = scale r(k - delay) + offset`.

use super::numbers::{delay, deviation, mean, rms};
use crate::signal::{central_difference, delayed};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
};

/// Part of the record in which a delay is looked for.
const LONGEST_PART: usize = 20;
/// Steps of Gauss-Newton.
const ITERATIONS: usize = 12;
/// A simpler correction is taken where it leaves no more than this times the rms deviation of the full one.
const AS_GOOD: f64 = 1.25;
/// So is one that leaves no more than this part of the motion's deviation: clean records have up to 0.8 %.
const CLEAN: f64 = 0.01;
/// Part of the rms difference that an explanation may leave.
const EXPLAINED: f64 = 0.5;
/// Delays of joints that differ by less, in samples or as a part, are one delay of the record.
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

/// What puts the reference of a joint right.
#[derive(Debug, Clone, Copy, PartialEq)]
struct JointCorrection {
    /// Samples by which the motion is later.
    samples: f64,
    scale: f64,
    offset: f64,
}

const NONE: JointCorrection = JointCorrection { samples: 0.0, scale: 1.0, offset: 0.0 };

/// What puts the references of all joints right.
pub(super) struct Correction {
    joints: Vec<JointCorrection>,
}

/// The correction after which the joints that are off their references are within `limit_percent` of their motion; none
/// where there is none.
pub(super) fn proposed(position: &Series, reference: &Series, off: &[usize], limit_percent: f64) -> Option<Correction> {
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

/// The mean of delays that are all the same and not zero.
fn common(delays: &[f64]) -> Option<f64> {
    let mean = mean(delays);
    let same = |d: &f64| *d != 0.0 && (d - mean).abs() < SAME * mean.abs().max(1.0);
    (!delays.is_empty() && delays.iter().all(same)).then_some(mean)
}

/// The simplest correction that does nearly as well as all three together, with the rms deviation it leaves.
fn simplest(q: &[f64], r: &[f64]) -> Option<(JointCorrection, f64)> {
    let fits: Vec<_> = FREE.iter().filter_map(|free| fit(q, r, *free)).collect();
    let best = fits.iter().map(|f| f.1).fold(f64::INFINITY, f64::min);
    fits.into_iter().find(|f| f.1 <= (AS_GOOD * best).max(CLEAN * deviation(q)))
}

/// What makes most of the difference of two signals: the simplest delay, scale and offset that leave less than half of its
/// rms. None where there is none.
pub(super) fn explanation(q: &[f64], r: &[f64], sample_rate_hz: f64) -> Option<String> {
    let difference: Vec<f64> = q.iter().zip(r).map(|(q, r)| q - r).collect();
    let (found, _) = simplest(q, r).filter(|(_, left)| *left < EXPLAINED * rms(&difference))?;
    let JointCorrection { samples, scale, offset } = found;
    let ms = 1e3 * samples.abs() / sample_rate_hz;
    let order = if samples > 0.0 { "late" } else { "early" };
    let late = (samples != 0.0).then(|| format!("{:.1} samples ({ms:.1} ms) {order}", samples.abs()));
    let scaled = (scale != 1.0).then(|| format!("{scale:.4} times as large"));
    let moved = (offset != 0.0).then(|| format!("off by {offset:.4}"));
    let parts: Vec<String> = [late, scaled, moved].into_iter().flatten().collect();
    Some(format!("it is {}", parts.join(", ")))
}

/// Least squares for the free ones, by Gauss-Newton from the best whole delay.
fn fit(q: &[f64], r: &[f64], free: [bool; 3]) -> Option<(JointCorrection, f64)> {
    let reach = (q.len() / LONGEST_PART).max(1);
    let mut found = NONE;
    if free[0] {
        let about = |x: &[f64], size: f64| x.iter().map(|v| (v - mean(x)) / size).collect::<Vec<_>>();
        found.samples = delay(&about(q, deviation(q)), &about(r, deviation(r)), reach)?;
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
        let mut take = |is_free: bool| if is_free { step.next().unwrap_or_default() } else { 0.0 };
        found.samples += take(free[0]).clamp(-1.0, 1.0);
        found.scale += take(free[1]);
        found.offset += take(free[2]);
    }
    let left = rms(&linearised(q, r, found, free, reach).0);
    (left.is_finite() && found.samples.abs() < reach as f64).then_some((found, left))
}

/// What a correction leaves of the motion, and its slopes by what is free, away from the ends.
fn linearised(q: &[f64], r: &[f64], at: JointCorrection, free: [bool; 3], reach: usize) -> (Vec<f64>, Matrix) {
    let late = delayed(&Series::side_by_side(&[r.to_vec()]), &[at.samples]);
    let slope = central_difference(&late, 1.0);
    let inside = reach..q.len() - reach;
    let value = |k: usize| late.sample(k)[0];
    let rest = inside.clone().map(|k| q[k] - at.scale * value(k) - at.offset).collect();
    let by = |k: usize, i: usize| [-at.scale * slope.sample(k)[0], value(k), 1.0][i];
    let wanted: Vec<usize> = (0..3).filter(|i| free[*i]).collect();
    (rest, Matrix::from_fn(inside.len(), wanted.len(), |k, i| by(k + inside.start, wanted[i])))
}

impl Correction {
    /// The key of `[recording]` that asks for it.
    pub(super) fn text(&self, sample_rate_hz: f64) -> String {
        let list = |value: fn(&JointCorrection) -> f64, unit: f64| {
            let numbers: Vec<String> =
                self.joints.iter().map(|j| format!("{:?}", (1e7 * unit * value(j)).round() / 1e7 + 0.0)).collect();
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
        let moved = series(|t, j| wave(t, j) - 0.3);
        let expected = "reference_correction = { delay_s = 0.0, scale = 1.0, offset = 0.3 }";
        assert_eq!(text_of(&position, &moved, &[0, 1]).unwrap(), expected);
    }

    #[test]
    fn the_three_together_are_told_apart() {
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

    /// It said "it is 205.0 samples (205.0 ms) late, scale 44.1213": the end of the range, and a scale of noise.
    #[test]
    fn the_end_of_the_search_is_no_explanation() {
        let far = series(|t, j| 0.02 * wave(t - 205.0, j));
        assert_eq!(explanation(&series(wave).channel(0), &far.channel(0), 1000.0), None);
        let near = series(|t, j| wave(t + 12.0, j));
        let found = explanation(&series(wave).channel(0), &near.channel(0), 1000.0);
        assert_eq!(found.as_deref(), Some("it is 12.0 samples (12.0 ms) late"));
    }
}
