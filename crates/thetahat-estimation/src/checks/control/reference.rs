//! Whether the motion follows the reference.

use super::reference_fit::{Correction, explanation, proposed};
use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::{correlation, deviation, rms},
    remedy_step::RemedyStep,
    subject::Subject,
};
use thetahat_ground::series::Series;

/// Rms deviation of the motion from the reference, percent of the motion's standard deviation. The clean
/// recordings have at most 0.8.
const LIMIT_PERCENT: f64 = 5.0;
/// Standard deviation of a position, rad or m, below which a joint does not move.
const STILL: f64 = 1e-4;
/// Correlation with the reference of another joint above which the references are exchanged, if the own one is below it.
const OTHER: f64 = 0.95;

/// The remedy if no correction of the reference helps.
const CHECK_CHANNEL: &str = "check the reference's column, unit and side; IDIM-IV and DIDIM simulate the loop with it";

pub(in crate::checks) fn check(exam: &mut Examination<'_>) {
    let window = exam.subject.signal.window.clone();
    let position = exam.subject.position.window(window.clone());
    let moves = |j: &usize| deviation(&position.channel(*j)) > STILL;
    let moving = (0..position.channels()).filter(moves);
    if let Some(reference) = exam.subject.reference {
        let reference = reference.window(window);
        let off: Vec<usize> =
            moving.clone().filter(|&j| percent_off(&position, &reference, j) > LIMIT_PERCENT).collect();
        let correction = proposed(&position, &reference, &off, LIMIT_PERCENT);
        let rate = exam.subject.sample_rate_hz;
        let step = correction.as_ref().map(|c| c.step(rate));
        let remedy = correction.map_or_else(|| CHECK_CHANNEL.to_owned(), |c| remedy(&c, rate));
        return moving.for_each(|j| recorded(exam, (&position, &reference), j, (&remedy, &step)));
    }
    let Some(deviations) = exam.subject.reconstructed_deviation else { return };
    for j in moving.filter(|&j| j < deviations.len()) {
        reconstructed(exam, &position.channel(j), deviations[j], j);
    }
}

fn evidence(j: usize, value: f64) -> Evidence {
    Evidence {
        code: Code::ReferenceMismatch,
        coordinate: Some(j),
        value,
        unit: "% of the motion",
        limit: LIMIT_PERCENT,
    }
}

/// Position minus reference of a coordinate.
fn difference(position: &Series, reference: &Series, j: usize) -> Vec<f64> {
    position.channel(j).iter().zip(&reference.channel(j)).map(|(q, r)| q - r).collect()
}

/// Its rms, percent of the motion's standard deviation.
fn percent_off(position: &Series, reference: &Series, j: usize) -> f64 {
    100.0 * rms(&difference(position, reference, j)) / deviation(&position.channel(j))
}

/// The remedy if a correction of the reference helps.
fn remedy(correction: &Correction, sample_rate_hz: f64) -> String {
    format!(
        "if the recording is wrong, and not the tracking of the controller, correct the reference under [recording]: {}; \
         otherwise {CHECK_CHANNEL}",
        correction.text(sample_rate_hz)
    )
}

fn recorded(
    exam: &mut Examination<'_>,
    (position, reference): (&Series, &Series),
    j: usize,
    (remedy, step): (&str, &Option<RemedyStep>),
) {
    let off = rms(&difference(position, reference, j));
    let subject = exam.subject;
    let number = subject.joint_number(j);
    exam.judge(evidence(j, percent_off(position, reference, j)), Severity::Warning, || {
        let cause = cause(subject, &position.channel(j), reference, j);
        FindingText::new(
            format!("joint {number}: the motion differs from its reference by {off:.3e} rad or m rms: {cause}"),
            remedy,
        )
        .with_step(step.clone())
    });
}

/// The text of the most likely cause.
fn cause(subject: &Subject<'_>, q: &[f64], reference: &Series, j: usize) -> String {
    let own = correlation(q, &reference.channel(j));
    let others = (0..reference.channels()).filter(|&i| i != j).map(|i| (i, correlation(q, &reference.channel(i))));
    if let Some((i, r)) = others.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|o| o.1 > OTHER && own < OTHER) {
        return format!("it follows the reference of joint {} (correlation {r:.3})", subject.joint_number(i));
    }
    let r = reference.channel(j);
    let unexplained = || format!("no delay, scale, offset or other joint explains it (correlation {own:.4})");
    explanation(q, &r, subject.sample_rate_hz).unwrap_or_else(unexplained)
}

fn reconstructed(exam: &mut Examination<'_>, q: &[f64], rms_deviation: f64, j: usize) {
    let number = exam.subject.joint_number(j);
    exam.judge(evidence(j, 100.0 * rms_deviation / deviation(q)), Severity::Warning, || {
        FindingText::new(
            format!("joint {number}: the motion differs from the reconstructed reference by {rms_deviation:.3e} rad or m rms"),
            "the motion does not consist of synchronised moves: record the reference and name it in [recording]",
        )
    });
}
