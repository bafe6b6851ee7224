//! Motions beyond the joints' limits: positions of motors, or in another unit.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::span,
    signals::Signals,
};

/// Largest ratio of a joint's motion to its range. Clean recordings stay within the range.
const LIMIT: f64 = 1.5;
const REMEDY: &str =
    "set the unit of position in [recording], or side = \"motor\" with the ratios in [transmission] matrix";

/// Checks the joints with limits in the description.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    for j in 0..signals.coordinates() {
        let limits = &exam.subject.joint(j).limits;
        let Some(range) = limits.lower.zip(limits.upper).map(|(l, u)| u - l).filter(|r| *r > 0.0) else { continue };
        let spanned = span(&signals.raw.channel(j));
        let value = spanned / range;
        let evidence = Evidence {
            code: Code::PositionScale,
            coordinate: Some(j),
            value,
            unit: "times the joint's range",
            limit: LIMIT,
        };
        let number = exam.subject.joint_number(j);
        exam.judge(evidence, Severity::Problem, || {
            let message =
                format!("joint {number}: the position spans {spanned:.1} rad or m, its limits allow {range:.1}");
            FindingText::new(message, REMEDY)
        });
    }
}
