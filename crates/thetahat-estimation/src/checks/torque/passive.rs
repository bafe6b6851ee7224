//! Joints whose torque is zero throughout because nothing drives them, as of an acrobot.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::{orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
    numbers::rms,
};

/// What the model leaves of a torque of zero, percent of its terms, up to which they cancel.
const CANCEL_PERCENT: f64 = 5.0;
/// The least terms, part of the largest driven joint's torque: smaller ones cancel with parameters that no other joint's torque contradicts.
const LEAST_TERMS: f64 = 0.05;
/// Largest error of the driven joints, part of their torques, with which the model is theirs.
const FITS: f64 = 0.2;

/// Makes a note of torques of zero that the motion confirms: the terms of the model cancel, with parameters that fit the other joints.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) {
    let is_zero = |j: &usize| recording.torque.channel(*j).iter().all(|torque| *torque == 0.0);
    let (passive, driven): (Vec<usize>, Vec<usize>) = (0..recording.coordinates()).partition(is_zero);
    let Ok(fit) = recording.fit() else { return };
    if passive.is_empty() || driven.is_empty() || driven.iter().any(|&j| fit.joint_error(j) > FITS) {
        return;
    }
    let torque = driven.iter().map(|&j| rms(&recording.torque.channel(j))).fold(0.0, f64::max);
    let left: Vec<Option<f64>> =
        passive.iter().map(|&j| left_percent(recording, &fit, j, LEAST_TERMS * torque)).collect();
    let left = left.into_iter().collect::<Option<Vec<f64>>>();
    let Some(left) = left.filter(|left| left.iter().all(|left| *left < CANCEL_PERCENT)) else { return };
    for (j, left) in passive.into_iter().zip(left) {
        let number = exam.subject.joint_number(j);
        let evidence = Evidence {
            code: Code::TorqueConstant,
            coordinate: Some(j),
            value: 0.0,
            unit: "N m or N",
            limit: f64::NEG_INFINITY,
        };
        exam.replace(evidence, Severity::Note, || {
            FindingText::new(
                format!("joint {number}: the torque is 0 throughout, and the terms of the model cancel to {left:.1} %: nothing drives it"),
                "if a drive acts there, record its torque",
            )
        });
    }
}

/// What the model leaves of a torque of zero, percent of the root sum square of its terms, if these are so large.
fn left_percent(recording: &ThinnedRecording<'_>, fit: &OrthogonalFit, j: usize, least: f64) -> Option<f64> {
    let (theta, rows) = (fit.theta(), recording.rows());
    let squares = |i: usize| theta.iter().enumerate().map(|(c, theta)| (fit.x.at(i, c) * theta).powi(2)).sum::<f64>();
    let terms: Vec<f64> = (j * rows..(j + 1) * rows).map(|i| squares(i).sqrt()).collect();
    let terms = rms(&terms);
    (terms > least).then(|| 100.0 * rms(&fit.errors(j)) / terms)
}
