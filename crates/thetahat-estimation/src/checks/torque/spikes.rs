//! Outliers of single samples.

use crate::{
    checks::{
        examination::{Evidence, Examination, FindingText},
        finding::{Code, Severity},
        numbers::{NORMAL_PER_MEDIAN, quantile_abs},
    },
    statistics::quantile,
};
use thetahat_ground::series::Series;

/// Distance of a sample from the median of the five around it, in robust standard deviations.
const OUTLYING: f64 = 12.0;
/// The same as part of the signal's span: smaller outliers are harmless.
const VISIBLE: f64 = 0.01;
/// The same in steps between the other samples around: a swing, a kink or a slip moves as much in one step.
const STEPS: f64 = 3.0;
/// Samples to each side whose steps are compared.
const AROUND: usize = 8;
/// Part of the samples above which outliers of equal size come from the drive, and the largest ratio of the upper to the lower
/// decile of equal sizes. A velocity loop answers each step of a coarse encoder with the same torque.
const OFTEN: f64 = 0.01;
const EQUAL_SIZE: f64 = 1.25;
/// Samples of the running median.
const NEIGHBOURS: usize = 5;

pub(in crate::checks) fn check(exam: &mut Examination<'_>) {
    let position = exam.subject.position.window(exam.subject.signal.window.clone());
    (0..position.channels()).for_each(|j| spikes(exam, Code::PositionSpikes, &position, j));
    // A signal added to the drives jumps on purpose.
    if let Some(torque) = exam.subject.torque_in_window().filter(|_| !exam.subject.added_signal) {
        (0..torque.channels()).for_each(|j| spikes(exam, Code::TorqueSpikes, &torque, j));
    }
}

fn spikes(exam: &mut Examination<'_>, code: Code, series: &Series, j: usize) {
    let what = if code == Code::PositionSpikes { "position" } else { "torque" };
    let number = exam.subject.joint_number(j);
    let x = series.channel(j);
    let found = outliers(&x);
    let (count, start) = (found.len(), exam.subject.signal.window.start);
    let first = found.first().map_or(0, |outlier| outlier.sample + start);
    let evidence = Evidence { code, coordinate: Some(j), value: count as f64, unit: "samples", limit: 0.5 };
    let seen = format!("joint {number}: {count} samples of the {what} differ much from their neighbours");
    if let Some(size) = steps_of_a_drive(&found, x.len()) {
        exam.judge(evidence, Severity::Note, || {
            FindingText::new(
                format!("{seen}, by {size:.3} each; the first is sample {first}"),
                "nothing to do if the drive's velocity loop reacts to single steps of its encoder: these torques are real, and \
                 decimation averages them",
            )
        });
        return;
    }
    exam.judge(evidence, Severity::Warning, || {
        FindingText::new(
            format!("{seen}; the first is sample {first}"),
            "replace them by their neighbours' mean, or look for a loose contact or a transmission error",
        )
    });
}

/// A sample that differs much from its neighbours.
struct Outlier {
    sample: usize,
    /// Distance from the median of the samples around.
    size: f64,
}

/// The size of outliers that come from a drive: they are many and of equal size.
fn steps_of_a_drive(found: &[Outlier], samples: usize) -> Option<f64> {
    let sizes: Vec<f64> = found.iter().map(|outlier| outlier.size).collect();
    let are_many = sizes.len() as f64 > OFTEN * samples as f64;
    let are_equal = are_many && quantile(&sizes, 0.9) < EQUAL_SIZE * quantile(&sizes, 0.1);
    are_equal.then(|| quantile(&sizes, 0.5))
}

fn outliers(x: &[f64]) -> Vec<Outlier> {
    let off: Vec<f64> =
        x.windows(NEIGHBOURS).map(|w| w[NEIGHBOURS / 2] - median([w[0], w[1], w[2], w[3], w[4]])).collect();
    let scale = NORMAL_PER_MEDIAN * quantile_abs(off.iter().copied().filter(|d| *d != 0.0), 0.5);
    // The span without the outliers themselves.
    let (low, high) = (quantile(x, 0.005), quantile(x, 0.995));
    let limit = (OUTLYING * scale).max(VISIBLE * (high - low));
    let is_far = |k: usize| limit > 0.0 && off[k].abs() > limit;
    let stands_out = |k: &usize| off[*k].abs() > STEPS * largest_step_around(x, *k, &is_far);
    let outlier = |k: usize| Outlier { sample: k + NEIGHBOURS / 2, size: off[k].abs() };
    (0..off.len()).filter(|k| is_far(*k)).filter(stands_out).map(outlier).collect()
}

/// The largest step between neighbours among the samples around, without those that are far off themselves. `k` is the index
/// in the list of medians.
fn largest_step_around(x: &[f64], k: usize, is_far: &dyn Fn(usize) -> bool) -> f64 {
    let last = x.len() - NEIGHBOURS;
    let around = k.saturating_sub(AROUND)..=(k + AROUND).min(last);
    let near: Vec<f64> = around.filter(|i| !is_far(*i)).map(|i| x[i + NEIGHBOURS / 2]).collect();
    near.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
}

fn median(mut window: [f64; NEIGHBOURS]) -> f64 {
    window.sort_unstable_by(f64::total_cmp);
    window[NEIGHBOURS / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(x: &[f64]) -> Vec<usize> {
        outliers(x).iter().map(|outlier| outlier.sample).collect()
    }

    fn noise(k: usize) -> f64 {
        ((78.233 * k as f64).sin() * 43_758.545_3).fract()
    }

    #[test]
    fn smooth_swings_and_stick_slip_have_no_outliers() {
        let swing: Vec<f64> = (0..2000).map(|k| 50.0 * (1.1 * k as f64).sin().powi(3)).collect();
        assert_eq!(samples(&swing), [0; 0]);
        let slow: Vec<f64> = (0..2000).map(|k| 10.0 * (0.002 * k as f64).sin() + 1e-3 * noise(k)).collect();
        let slip: Vec<f64> = (0..2000).map(|k| slow[k] + 0.2 * (k % 25) as f64).collect();
        assert_eq!(samples(&slip), [0; 0]);
        let reversal = |v: f64| v.signum() * (1.0 + 0.6 * (-(v / 0.05).powi(2)).exp());
        let friction: Vec<f64> = (0..2000).map(|k| reversal((0.05 * k as f64 + 0.3).sin()) + 1e-3 * noise(k)).collect();
        assert_eq!(samples(&friction), [0; 0]);
    }

    #[test]
    fn outliers_are_found_in_noise_and_next_to_each_other() {
        let mut x: Vec<f64> = (0..2000).map(|k| 10.0 * (0.01 * k as f64).sin() + 0.1 * noise(k)).collect();
        x[300] += 4.0;
        x[1000] -= 5.0;
        x[1001] -= 5.0;
        assert_eq!(samples(&x), [300, 1000, 1001]);
        assert!(steps_of_a_drive(&outliers(&x), x.len()).is_none());
    }

    #[test]
    fn many_of_equal_size_come_from_the_drive_and_many_of_any_size_are_faults() {
        let with = |size: fn(usize) -> f64| -> Vec<f64> {
            let chatter = |k: usize| if k.is_multiple_of(17) { size(k) } else { 0.0 };
            (0..4000).map(|k| 10.0 * (0.002 * k as f64).sin() + 1e-3 * noise(k) + chatter(k)).collect()
        };
        let size = |x: &[f64]| steps_of_a_drive(&outliers(x), x.len());
        let step = size(&with(|_| 3.0)).unwrap();
        assert!((step - 3.0).abs() < 0.05, "{step}");
        assert!(size(&with(|k| 5.0 * noise(k))).is_none());
    }
}
