//! Joints that only vibrate in place.

use crate::{
    checks::{
        examination::{Evidence, Examination, FindingText},
        finding::{Code, Severity},
        numbers::quantile_abs,
        signals::Signals,
    },
    statistics::median,
};
use thetahat_model::robot::JointKind;

/// Spans below which a joint only vibrates in place, rad and m: gravity and coupling do not change over them. The
/// clean recordings span at least 1.2 rad or 0.12 m.
const SMALLEST_RAD: f64 = 0.01;
const SMALLEST_M: f64 = 1e-3;
/// Part of the samples within the span: single outliers do not count as motion.
const HELD: f64 = 0.99;

/// Finds joints with the velocity of a moving joint and a constant position.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    for j in (0..signals.coordinates()).filter(|&j| signals.moves(j)) {
        let (smallest, unit) = match exam.subject.joint(j).kind {
            JointKind::Revolute => (SMALLEST_RAD, "rad"),
            JointKind::Prismatic => (SMALLEST_M, "m"),
        };
        let position = signals.raw.channel(j);
        let middle = median(&position);
        let span = 2.0 * quantile_abs(position.iter().map(|q| q - middle), HELD);
        let value = smallest / span.max(f64::MIN_POSITIVE);
        let evidence =
            Evidence { code: Code::JointDither, coordinate: Some(j), value, unit: "times too small", limit: 1.0 };
        let parameters = exam.subject.parameter_names_of(j);
        let number = exam.subject.joint_number(j);
        let severity = if parameters.is_empty() { Severity::Note } else { Severity::Problem };
        exam.judge(evidence, severity, || {
            let message = format!(
                "joint {number} only vibrates in place: it spans {span:.1e} {unit} at velocities of up to {:.1e} {unit}/s, \
                 which are dither or noise",
                signals.peak[j]
            );
            let remedy = "move it, or exclude its parameters from the estimate by exclude = [...] in [parameters]";
            FindingText::new(message, remedy).about(parameters)
        });
    }
}
