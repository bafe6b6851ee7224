//! Defects of the torque itself: constant, at its limit, in coarse steps.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::{deviation, quantile_abs, span, step_of},
};

/// Span of a torque, relative to the largest torque of all, below which it counts as constant.
const CONSTANT: f64 = 1e-9;
/// Samples at the limit of a drive, percent of the window: the clean recordings have one sample at each extreme.
const SATURATED_LIMIT_PERCENT: f64 = 0.05;
/// A limit has this many times as many samples as the next level, unlike a coarse step.
const PILE: usize = 5;
/// Fewest samples at a limit.
const FEWEST_AT_LIMIT: usize = 10;
/// Values this close, relative to the span, are the same: the conversion to the motor side rounds.
const SAME: f64 = 1e-7;
/// Effect of the torque's steps, percent of its standard deviation; the clean recordings have less than 0.001.
const STEP_LIMIT_PERCENT: f64 = 3.0;

pub(in crate::checks) fn check(exam: &mut Examination<'_>) {
    let Some(window) = exam.subject.torque_in_window() else { return };
    let largest = quantile_abs(window.values().iter().copied(), 1.0);
    let drives = exam.subject.robot.transmission.drive_signals(&window);
    for j in 0..window.channels() {
        let tau = window.channel(j);
        if span(&tau) <= CONSTANT * largest {
            constant(exam, j, tau.first().copied().unwrap_or(0.0));
            continue;
        }
        saturation(exam, j, &drives.channel(j));
        quantisation(exam, j, &tau);
    }
}

fn constant(exam: &mut Examination<'_>, j: usize, value: f64) {
    let evidence =
        Evidence { code: Code::TorqueConstant, coordinate: Some(j), value, unit: "N m or N", limit: f64::NAN };
    let words = FindingText::new(
        format!("joint {}: the torque is {value} throughout", exam.subject.joint_number(j)),
        "check the channel's column: the drive was not recorded, or the experiment names another column",
    );
    let severity = if exam.subject.parameter_names_of(j).is_empty() { Severity::Note } else { Severity::Problem };
    exam.raise(evidence, severity, words);
}

fn saturation(exam: &mut Examination<'_>, j: usize, drive: &[f64]) {
    let count = at_limit(drive);
    let value = 100.0 * count as f64 / drive.len() as f64;
    let evidence = Evidence {
        code: Code::TorqueSaturated,
        coordinate: Some(j),
        value,
        unit: "% of the window",
        limit: SATURATED_LIMIT_PERCENT,
    };
    let number = exam.subject.joint_number(j);
    exam.judge(evidence, Severity::Warning, || {
        FindingText::new(
            format!("joint {number}: the drive stays at its extreme value for {count} samples ({value:.2} %)"),
            "the recorded torque is clipped: move more slowly, or widen the range of the drive or recorder",
        )
    });
}

/// Samples at the upper and lower limit, if any.
fn at_limit(drive: &[f64]) -> usize {
    let tolerance = SAME * span(drive);
    let negated: Vec<f64> = drive.iter().map(|v| -v).collect();
    samples_at_maximum(drive, tolerance) + samples_at_maximum(&negated, tolerance)
}

/// Samples at the largest value, if there are many more of them than of the next value below.
fn samples_at_maximum(values: &[f64], tolerance: f64) -> usize {
    let largest = |below: f64| values.iter().copied().filter(|v| *v < below).fold(f64::NEG_INFINITY, f64::max);
    let count = |level: f64| values.iter().filter(|v| (**v - level).abs() <= tolerance).count();
    let extreme = largest(f64::INFINITY);
    let at_extreme = count(extreme);
    if at_extreme < FEWEST_AT_LIMIT || at_extreme < PILE * count(largest(extreme - tolerance)) {
        return 0;
    }
    at_extreme
}

fn quantisation(exam: &mut Examination<'_>, j: usize, tau: &[f64]) {
    let Some(step) = step_of(tau) else { return };
    let value = 100.0 * step / 12.0_f64.sqrt() / deviation(tau);
    let evidence = Evidence {
        code: Code::TorqueQuantised,
        coordinate: Some(j),
        value,
        unit: "% of the torque",
        limit: STEP_LIMIT_PERCENT,
    };
    let number = exam.subject.joint_number(j);
    exam.judge(evidence, Severity::Warning, || {
        FindingText::new(
            format!(
                "joint {number}: the torque has steps of {step:.3e}, an error of {value:.1} % of its standard deviation"
            ),
            "record more digits, or a finer current range",
        )
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_top_counts_and_a_coarse_step_does_not() {
        let wave: Vec<f64> = (0..1000).map(|k| (0.02 * f64::from(k)).sin()).collect();
        let clipped: Vec<f64> = wave.iter().map(|v| v.min(0.8)).collect();
        let coarse: Vec<f64> = wave.iter().map(|v| (v * 5.0).round() / 5.0).collect();
        assert_eq!(at_limit(&wave), 0);
        assert!((180..230).contains(&at_limit(&clipped)), "{}", at_limit(&clipped));
        assert_eq!(at_limit(&coarse), 0);
    }
}
