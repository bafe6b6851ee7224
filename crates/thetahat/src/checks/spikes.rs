//! Outliers of single samples.

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    numbers::{NORMAL_PER_MEDIAN, quantile_abs},
};
use crate::series::Series;

/// Distance of a sample from the median of the five around it, in robust standard deviations.
const OUTLYING: f64 = 12.0;
/// The same as part of the signal's span: smaller outliers do not matter.
const VISIBLE: f64 = 0.01;
/// Samples of which the median is taken.
const NEIGHBOURS: usize = 5;

pub(super) fn check(exam: &mut Examination<'_>) {
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
    let evidence = Evidence { code, coordinate: Some(j), value: count as f64, unit: "samples", limit: 0.5 };
    exam.judge(evidence, Severity::Warning, || {
        let first = found.first().map_or(0, |k| k + start);
        Words::new(
            format!(
                "joint {number}: {count} samples of the {what} lie far off their neighbours, the first is sample {first}"
            ),
            "replace them by their neighbours' mean, or find the loose contact or transmission error",
        )
    });
}

fn outliers(x: &[f64]) -> Vec<usize> {
    let off: Vec<f64> =
        x.windows(NEIGHBOURS).map(|w| w[NEIGHBOURS / 2] - median([w[0], w[1], w[2], w[3], w[4]])).collect();
    let scale = NORMAL_PER_MEDIAN * quantile_abs(off.iter().copied().filter(|d| *d != 0.0), 0.5);
    // The span without the outliers themselves.
    let (low, high) = (quantile(x, 0.005), quantile(x, 0.995));
    let limit = (OUTLYING * scale).max(VISIBLE * (high - low));
    let outlying = |(_, d): &(usize, &f64)| d.abs() > limit && limit > 0.0;
    off.iter().enumerate().filter(outlying).map(|(k, _)| k + NEIGHBOURS / 2).collect()
}

fn median(mut window: [f64; NEIGHBOURS]) -> f64 {
    window.sort_unstable_by(f64::total_cmp);
    window[NEIGHBOURS / 2]
}

fn quantile(x: &[f64], part: f64) -> f64 {
    let mut sorted = x.to_vec();
    let place = ((sorted.len().saturating_sub(1)) as f64 * part).round() as usize;
    if sorted.is_empty() { 0.0 } else { *sorted.select_nth_unstable_by(place, f64::total_cmp).1 }
}
