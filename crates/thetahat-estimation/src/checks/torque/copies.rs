//! Two joints whose torques are the same column.
//!
//! Measured torques of two joints have noise of their own: that one is a multiple of the other at every sample has no other reason.

use thetahat_ground::number::significant;

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    numbers::{quantile_abs, span},
};

/// Difference from a multiple of the other torque, relative to the span, up to which it is one: conversions of units round.
const SAME: f64 = 1e-7;
/// Factor that is one.
const ONE: f64 = 1e-6;

pub(in crate::checks) fn check(exam: &mut Examination<'_>) {
    let Some(window) = exam.subject.torque_in_window() else { return };
    let torques: Vec<Vec<f64>> = (0..window.channels()).map(|j| window.channel(j)).collect();
    for (second, of_second) in torques.iter().enumerate() {
        let copied = torques[..second].iter().enumerate().find_map(|(j, first)| Some((j, factor(first, of_second)?)));
        if let Some((first, factor)) = copied {
            raise(exam, [first, second], factor);
        }
    }
}

/// The number that makes one torque the other at all samples; none if they differ, or one of them is constant.
fn factor(first: &[f64], second: &[f64]) -> Option<f64> {
    let largest = quantile_abs(first.iter().copied(), 1.0);
    let at_largest = first.iter().position(|v| v.abs() == largest)?;
    let factor = second[at_largest] / first[at_largest];
    let tolerance = SAME * span(second);
    let is_copy = tolerance > 0.0 && span(first) > 0.0;
    let differs = |(a, b): (&f64, &f64)| (b - factor * a).abs() > tolerance;
    (is_copy && factor.is_finite() && !first.iter().zip(second).any(differs)).then_some(factor)
}

fn raise(exam: &mut Examination<'_>, joints: [usize; 2], factor: f64) {
    let [first, second] = joints.map(|j| exam.subject.joint_number(j).to_string());
    let times = match (factor - 1.0).abs() < ONE {
        true => String::new(),
        false => format!(" times {}", significant(factor, 3)),
    };
    let message =
        format!("joint {second}: its torque is that of joint {first}{times} at every sample: one column is read twice");
    let remedy = format!(
        "check the torque columns of joints {first} and {second} in the experiment file, and in what wrote the log"
    );
    let (code, unit) = (Code::TorqueCopied, "times the torque of the other joint");
    let evidence = Evidence { code, coordinate: Some(joints[1]), value: factor, unit, limit: f64::NAN };
    exam.raise(evidence, Severity::Problem, FindingText::new(message, remedy));
}

#[cfg(test)]
mod tests {
    use super::factor;

    #[test]
    fn a_torque_is_a_copy_only_where_every_sample_is_the_same_multiple() {
        let torque: Vec<f64> = (0..500).map(|k| 3.0 + (0.1 * f64::from(k)).sin()).collect();
        let scaled: Vec<f64> = torque.iter().map(|t| -2.0 * t).collect();
        assert_eq!(factor(&torque, &torque), Some(1.0));
        assert_eq!(factor(&torque, &scaled), Some(-2.0));
        let mut other = torque.clone();
        other[250] += 1e-4;
        assert_eq!(factor(&torque, &other), None);
        assert_eq!(factor(&torque, &vec![0.0; 500]), None);
        assert_eq!(factor(&vec![1.0; 500], &vec![1.0; 500]), None);
    }
}
