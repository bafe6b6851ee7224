//! Motions beyond the joints' limits: positions of motors, or in another unit, or from another zero.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::span,
    signals::Signals,
};
use std::f64::consts::TAU;
use thetahat_model::robot::JointKind;

/// Largest ratio of a joint's motion to its range. Clean recordings stay within the range.
const LIMIT: f64 = 1.5;
/// Part of a motion's span by which its middle lies outside the limits, from which the zero is another one. Motions of a simulated arm whose
/// description has narrow limits lie outside by up to 0.03.
const BEYOND: f64 = 0.2;
const REMEDY: &str =
    "set the unit of position in [recording], or side = \"motor\" with the ratios in [transmission] matrix";

const REMEDY_OF_ZERO: &str = "check the zero of the position: it is another than the description's, or the limits are wrong. A zero is \
                              offset_deg in [transmission] of the robot's TOML, with side = \"motor\" of position and torque in [recording]";

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
        let is_too_wide = exam.judge(evidence, Severity::Problem, || {
            let message =
                format!("joint {number}: the position spans {spanned:.1} rad or m, its limits allow {range:.1}");
            FindingText::new(message, REMEDY)
        });
        if !is_too_wide {
            check_zero(exam, signals, j);
        }
    }
}

/// Whether the middle of a joint's motion lies within its limits; angles but for whole turns.
fn check_zero(exam: &mut Examination<'_>, signals: &Signals, j: usize) {
    let joint = exam.subject.joint(j);
    let Some((lower, upper)) = joint.limits.lower.zip(joint.limits.upper) else { return };
    let [least, most] = ends(&signals.raw.channel(j));
    let turns = match joint.kind {
        JointKind::Revolute => (0.5 * (lower + upper - least - most) / TAU).round() * TAU,
        JointKind::Prismatic => 0.0,
    };
    let middle = 0.5 * (least + most) + turns;
    let beyond = (middle - upper).max(lower - middle);
    let evidence = Evidence {
        code: Code::PositionZero,
        coordinate: Some(j),
        value: beyond / (most - least).max(f64::MIN_POSITIVE),
        unit: "spans of the motion beyond the joint's limits",
        limit: BEYOND,
    };
    if evidence.value > BEYOND {
        let number = exam.subject.joint_number(j);
        let message = format!(
            "joint {number}: the position goes from {least:.2} to {most:.2} rad or m, its limits are {lower:.2} and {upper:.2}: \
             the middle of the motion lies {beyond:.2} outside of them"
        );
        exam.raise(evidence, Severity::Warning, FindingText::new(message, REMEDY_OF_ZERO));
    }
}

fn ends(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], v| [v.min(least), v.max(most)])
}
