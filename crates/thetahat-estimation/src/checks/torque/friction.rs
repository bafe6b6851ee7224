//! Negative friction, and torques that the model does not explain.

use super::{
    described_weight::described_weight,
    gravity_fit::{GravityFit, GravityRows},
};
use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::{affine::Affine, orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
};
use thetahat_ground::linear_algebra::{PivotedQr, dot};

/// Standard deviations below zero at which the power of a joint's friction counts as negative.
pub(in crate::checks) const NEGATIVE_LIMIT: f64 = 10.0;
/// A change of sign counts as the cause of negative friction if it increases the squared residual by at most this factor.
const AS_GOOD: f64 = 1.02;
/// Least part of the described weight with which the torques have the right sign.
const OF_WEIGHT: f64 = 0.5;
const SIGN: &str = "change the sign of the channel's gain, or of the motor's row in [transmission] matrix";
const COMPENSATED: &str = "log the torques without the driver's compensation of friction, or add what it subtracts";
/// Relative error of the whole fit, percent. The clean recordings have at most 6.3, noisy twins 10.
const WHOLE_LIMIT_PERCENT: f64 = 20.0;
/// Rms residual of a joint, percent of the standard deviation of its torque, above which the model explains none of it. The
/// recorded KUKA has 48 at a joint with a torque near zero (clean).
const JOINT_LIMIT_PERCENT: f64 = 90.0;

/// Corrects wrong signs that negative friction reveals.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &mut ThinnedRecording<'_>) {
    let Ok(fit) = recording.fit() else { return };
    let power = power(recording, &fit);
    let negative: Vec<usize> = (0..power.len()).filter(|&j| power[j] < -NEGATIVE_LIMIT).collect();
    let seen = if negative.len() < 2 || power.iter().any(|p| *p >= 0.0) {
        Seen::AtSomeJoints
    } else if has_described_weight(recording) {
        Seen::EverywhereWithWeight
    } else {
        Seen::Everywhere
    };
    for (j, p) in power.iter().enumerate() {
        let value = -p;
        let mut evidence = Evidence {
            code: Code::NegativeFriction,
            coordinate: Some(j),
            value,
            unit: "standard deviations",
            limit: NEGATIVE_LIMIT,
        };
        exam.note_measure(evidence);
        if value <= NEGATIVE_LIMIT {
            continue;
        }
        let SignCause { code, correction, text: cause, remedy } = cause(recording, &fit, j, seen);
        evidence.code = code;
        let message = format!(
            "joint {}: friction is negative (its power by {value:.0} standard deviations); {cause}",
            exam.subject.joint_number(j)
        );
        let text = FindingText::new(message, remedy).about(friction_parameters(recording, j));
        let text = text.with_step(correction.as_ref().and_then(Affine::step));
        exam.raise(evidence, Severity::Problem, text);
        correction.iter().for_each(|correction| recording.correct(correction));
    }
    poor_fit(exam, &recording.with_estimated_parameters());
}

/// Where friction is negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Seen {
    AtSomeJoints,
    Everywhere,
    /// At all joints, of torques that hold the weight of the links with its sign.
    EverywhereWithWeight,
}

/// The cause of negative friction, and its correction if there is one.
struct SignCause {
    code: Code,
    correction: Option<Affine>,
    text: &'static str,
    remedy: &'static str,
}

/// What makes a joint's friction negative: the sign of its torque, the sign of its position, or neither.
fn cause(recording: &ThinnedRecording<'_>, fit: &OrthogonalFit, j: usize, seen: Seen) -> SignCause {
    let flip: Vec<f64> = (0..recording.coordinates()).map(|i| if i == j { -1.0 } else { 1.0 }).collect();
    let torque = Affine::scaled_torques(&flip);
    if seen == Seen::EverywhereWithWeight {
        let text = "all joints have negative friction, and the torques hold the weight of the links: the driver takes more friction \
                    out of them than there is";
        return SignCause { code: Code::NegativeFriction, correction: None, text, remedy: COMPENSATED };
    }
    if seen == Seen::Everywhere {
        let text = "all joints have negative friction: the torques have the opposite sign";
        return SignCause { code: Code::TorqueSign, correction: Some(torque), text, remedy: SIGN };
    }
    let position = Affine::scaled_positions(&flip, recording.subject.robot.transmission.offset());
    let squares = |correction: &Affine| corrected_squares(recording, correction) / fit.squares;
    let (with_torque, with_position) = (squares(&torque), squares(&position));
    if with_torque.min(with_position) > AS_GOOD {
        let text = "no change of sign fits as well";
        return SignCause { code: Code::NegativeFriction, correction: None, text, remedy: SIGN };
    }
    if with_position < with_torque / AS_GOOD {
        let text = "the position has the opposite sign";
        return SignCause { code: Code::PositionSign, correction: Some(position), text, remedy: SIGN };
    }
    let text = "the torque, or the position, has the opposite sign";
    SignCause { code: Code::TorqueSign, correction: Some(torque), text, remedy: SIGN }
}

/// Whether the torques hold the weight of the description's links with its sign.
fn has_described_weight(recording: &ThinnedRecording<'_>) -> bool {
    let part = |without: GravityFit| described_weight(recording, recording.subject.robot.gravity, &without);
    GravityRows::new(recording)
        .and_then(|rows| rows.fit([0.0; 3]))
        .and_then(part)
        .is_some_and(|weight| weight.part > OF_WEIGHT)
}

fn corrected_squares(recording: &ThinnedRecording<'_>, correction: &Affine) -> f64 {
    recording.corrected(correction).fit().map_or(f64::INFINITY, |r| r.squares)
}

/// Mean power that each joint loses to friction, in standard deviations of its estimate.
pub(in crate::checks) fn power(recording: &ThinnedRecording<'_>, fit: &OrthogonalFit) -> Vec<f64> {
    let theta = fit.theta();
    let independent = &fit.qr.pivots()[..fit.rank];
    let covariance = PivotedQr::new(&fit.x.select_columns(independent)).inverse_gram();
    let in_deviations = |j: usize| {
        let per_parameter = power_per_parameter(recording, fit, j);
        let mean = dot(&per_parameter, &theta);
        let part: Vec<f64> = independent.iter().map(|&c| per_parameter[c]).collect();
        let variance = fit.variance() * dot(&part, &covariance.times(&part));
        if variance > 0.0 { mean / variance.sqrt() } else { 0.0 }
    };
    (0..recording.coordinates()).map(in_deviations).collect()
}

/// Mean power of joint `j`, times its weight, per unit of each friction parameter.
fn power_per_parameter(recording: &ThinnedRecording<'_>, fit: &OrthogonalFit, j: usize) -> Vec<f64> {
    let rows = recording.rows();
    let velocity: Vec<f64> = recording.kept.iter().map(|&k| recording.motion.dq.sample(k)[j]).collect();
    let mean_power = |c: usize| dot(&velocity, &fit.x.column(c)[j * rows..(j + 1) * rows]) / rows as f64;
    (0..fit.x.columns()).map(|c| if recording.is_friction(c) { mean_power(c) } else { 0.0 }).collect()
}

fn friction_parameters(recording: &ThinnedRecording<'_>, j: usize) -> Vec<String> {
    let own = recording.subject.parameters_of(j);
    let kind = |kept: usize| recording.subject.model.parameter_table().get(kept).quantity;
    own.filter(|(_, p)| kind(p.kept).is_friction()).map(|(_, p)| p.name.clone()).collect()
}

fn poor_fit(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) {
    let Ok(fit) = recording.fit() else { return };
    let value = 100.0 * fit.relative_error();
    let evidence =
        Evidence { code: Code::PoorFit, coordinate: None, value, unit: "% of the torques", limit: WHOLE_LIMIT_PERCENT };
    let remedy = "fix the other findings first; if there are none, check the robot's geometry, the order of the joints, and \
                  loads that are not in the model";
    exam.judge(evidence, Severity::Warning, || {
        FindingText::new(
            format!("the model with its best parameters leaves {value:.0} % of the torques unexplained"),
            remedy,
        )
    });
    for j in 0..recording.coordinates() {
        let value = 100.0 * fit.joint_error(j);
        let evidence = Evidence {
            code: Code::PoorFit,
            coordinate: Some(j),
            value,
            unit: "% of the torque's deviation",
            limit: JOINT_LIMIT_PERCENT,
        };
        let number = exam.subject.joint_number(j);
        exam.judge(evidence, Severity::Warning, || {
            let message = format!("joint {number}: the model does not explain the torque (it leaves {value:.0} % of its standard deviation)");
            FindingText::new(message, remedy)
        });
    }
}
