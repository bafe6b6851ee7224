//! Torques with few different values: coarse, unequal steps, or one value for most of the time.

use std::ops::Range;

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::span,
    signals::Signals,
};
use crate::statistics::quantile;
use thetahat_ground::stretches::stretches_of_equal;

/// Values this close, relative to the span, are the same: the conversion to the motor side rounds.
const SAME: f64 = 1e-7;
/// Number of values of a drive signal below which its steps matter, and samples per value above which the signal counts as
/// coarse. The torques of the clean recordings have at least one value for every 20 samples.
const FEW_VALUES: f64 = 64.0;
const SAMPLES_PER_VALUE: f64 = 20.0;
/// Part of its peak velocity above which a joint counts as moving.
const MOVING: f64 = 0.05;
/// Percent of the moving samples at one value: the clean recordings have at most 0.2.
const IDLE_LIMIT_PERCENT: f64 = 30.0;
/// Percent of the window in which the signal does not change: drives rest at one value, up to 0.7 % of the recorded TX40.
const FROZEN_LIMIT_PERCENT: f64 = 2.0;
/// Fewest samples of a stretch without a change, and how much longer it is than usual ones: those of a coarse signal.
const FEWEST_FROZEN: usize = 50;
const LONG_RUN: f64 = 10.0;
/// Part of the stretches that are usual.
const USUAL_RUN: f64 = 0.99;
/// Percent above which too little of the torque is left for an estimate.
const LOST_PERCENT: f64 = 60.0;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    let Some(window) = exam.subject.torque_in_window() else { return };
    let drives = exam.subject.robot.transmission.drive_signals(&window);
    for j in (0..drives.channels()).filter(|&j| signals.moves(j)) {
        let drive = drives.channel(j);
        let moving = |k: &usize| signals.dq.sample(*k)[j].abs() > MOVING * signals.peak[j];
        let moving: Vec<f64> = (0..drive.len()).filter(moving).map(|k| drive[k]).collect();
        if span(&drive) > 0.0 && !idle(exam, j, &moving) && !few_values(exam, j, &drive) {
            frozen(exam, signals, j, &drive);
        }
    }
}

/// Checks for one value during much of the motion.
fn idle(exam: &mut Examination<'_>, j: usize, moving: &[f64]) -> bool {
    let (at, count) = levels(moving).into_iter().max_by_key(|l| l.1).unwrap_or((0.0, 0));
    let value = 100.0 * count as f64 / moving.len().max(1) as f64;
    let evidence = Evidence {
        code: Code::TorqueIdle,
        coordinate: Some(j),
        value,
        unit: "% of the moving samples",
        limit: IDLE_LIMIT_PERCENT,
    };
    let severity = if value > LOST_PERCENT { Severity::Problem } else { Severity::Warning };
    let (number, parameters) = (exam.subject.joint_number(j), exam.subject.parameter_names_of(j));
    exam.judge(evidence, severity, || {
        let message =
            format!("joint {number}: the drive signal is {at} for {value:.0} % of the time in which the joint moves");
        let remedy = "record the torque at every sample; likely causes: the driver fills gaps with this value, a dead band, or \
                      a coarse resolution";
        FindingText::new(message, remedy).about(parameters)
    })
}

/// Checks for a stretch of time in which the joint moves and the drive signal does not change.
fn frozen(exam: &mut Examination<'_>, signals: &Signals, j: usize, drive: &[f64]) {
    let runs = stretches_of_equal(drive);
    let lengths: Vec<f64> = runs.iter().map(|run| run.len() as f64).collect();
    let usual = quantile(&lengths, USUAL_RUN);
    let speed = |run: &Range<usize>| {
        run.clone().map(|k| signals.dq.sample(k)[j].abs()).sum::<f64>() / run.len() as f64 / signals.peak[j]
    };
    // A drive at its limit is another finding.
    let extremes = [f64::min, f64::max].map(|of| drive.iter().copied().fold(drive[0], of));
    let is_frozen = |run: &&Range<usize>| {
        !extremes.contains(&drive[run.start])
            && run.len() >= FEWEST_FROZEN
            && run.len() as f64 > LONG_RUN * usual
            && speed(run) > MOVING
    };
    let frozen: Vec<&Range<usize>> = runs.iter().filter(is_frozen).collect();
    let Some(longest) = frozen.iter().max_by_key(|run| run.len()) else { return };
    let value = 100.0 * frozen.iter().map(|run| run.len()).sum::<usize>() as f64 / drive.len() as f64;
    let evidence = Evidence {
        code: Code::TorqueIdle,
        coordinate: Some(j),
        value,
        unit: "% of the window",
        limit: FROZEN_LIMIT_PERCENT,
    };
    let (number, start) = (exam.subject.joint_number(j), exam.subject.signal.window.start);
    let [from_s, to_s] = [longest.start, longest.end].map(|k| (k + start) as f64 / exam.subject.sample_rate_hz);
    let parameters = exam.subject.parameter_names_of(j);
    exam.judge(evidence, Severity::Warning, || {
        let message = format!(
            "joint {number}: the drive signal is {} from {from_s:.3} to {to_s:.3} s, while the joint moves: it was not recorded \
             there",
            drive[longest.start]
        );
        let remedy = format!(
            "identify the part before or after it alone, by window_end_s = {from_s:.3} or window_start_s = {to_s:.3} in [signal]"
        );
        FindingText::new(message, remedy).about(parameters)
    });
}

/// Checks for few values in many samples, in equal steps or not.
fn few_values(exam: &mut Examination<'_>, j: usize, drive: &[f64]) -> bool {
    let values = levels(drive).len() as f64;
    if values * SAMPLES_PER_VALUE > drive.len() as f64 {
        return false;
    }
    let evidence = Evidence {
        code: Code::TorqueQuantised,
        coordinate: Some(j),
        value: FEW_VALUES / values,
        unit: "times too few values",
        limit: 1.0,
    };
    let number = exam.subject.joint_number(j);
    exam.judge(evidence, Severity::Warning, || {
        let message =
            format!("joint {number}: the torque has only {values} different values in {} samples", drive.len());
        FindingText::new(message, "record more digits, or a finer current range")
    })
}

/// The different values with their numbers of samples, ascending.
fn levels(values: &[f64]) -> Vec<(f64, usize)> {
    let tolerance = SAME * span(values);
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let mut levels: Vec<(f64, usize)> = Vec::new();
    for value in sorted {
        match levels.last_mut() {
            Some((level, count)) if value - *level <= tolerance => *count += 1,
            Some(_) | None => levels.push((value, 1)),
        }
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_differ_by_rounding_are_one_level() {
        assert_eq!(levels(&[1.0, 0.0, 1.0 + 1e-12, -3.0, 0.0]), [(-3.0, 1), (0.0, 2), (1.0, 2)]);
        assert!(levels(&[]).is_empty());
    }
}
