//! Joints that only tremble.

use super::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::quantile_abs,
    signals::Signals,
};
use crate::statistics::median;
use thetahat_model::robot::JointKind;

/// Spans of a motion below which a joint is held and trembles, rad and m: gravity and coupling do not change over it. The
/// clean records span at least 1.2 rad or 0.12 m.
const SMALLEST_RAD: f64 = 0.01;
const SMALLEST_M: f64 = 1e-3;
/// Part of the samples that the span holds: single outliers do not make a motion.
const HELD: f64 = 0.99;

/// Joints whose velocity is that of a moving joint and whose position stays where it is.
pub(super) fn check(exam: &mut Examination<'_>, signals: &Signals) {
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
                "joint {number} is held and trembles: it spans {span:.1e} {unit} at velocities of up to {:.1e} {unit}/s, \
                 which are dither or noise",
                signals.peak[j]
            );
            let remedy = "move it, or take its parameters out of the estimate with exclude = [...] in [parameters]";
            FindingText::new(message, remedy).about(parameters)
        });
    }
}
