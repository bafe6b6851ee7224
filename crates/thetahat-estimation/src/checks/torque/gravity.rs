//! A direction of gravity that differs from the description: a robot on a wall, on a ceiling or on a tilted base.
//!
//! The parameters absorb much of a wrong gravity by other signs and offsets; only the links' inertia contradicts them. Torques
//! are linear in gravity, so the fit gets further columns: the torques of the fitted links in unit gravity along each axis of
//! the base. If these explain much, the best axis is the start of Gauss-Newton on the two angles of gravity. The masses of the
//! description are not needed.

use super::{
    clock, fault,
    gravity_fit::{ALIKE, AXES, GravityFit, GravityRows, LIMIT, POOR, WRONG_RATIO, evidence},
    hypotheses::Hypothesis,
    weight,
};
use crate::checks::{
    examination::{Examination, FindingText},
    finding::Severity,
    fit::thinned_recording::ThinnedRecording,
    remedy_step::RemedyStep,
};
use thetahat_ground::{
    number::{fixed, significant},
    vector::{Vec3, cross, dot, norm, scale},
};

/// Steps of the stated gravity in one m/s^2.
const DIGITS: f64 = 1e4;
/// Smallest change of direction that is reported, degrees.
const LEAST_DEG: f64 = 2.0;
/// Change of direction in degrees above which all estimates are wrong.
const WRONG_DEG: f64 = 10.0;
/// Factor by which a direction that differs by more must reduce the squared residual: the fit has many such directions to choose from.
const WRONG_LIMIT: f64 = 2.0;
/// Change of direction in degrees beyond which parameters of the other sign explain as much: exchanged arms of a torso look like a robot
/// that hangs.
const TURNED_DEG: f64 = 90.0;
/// Relative error of the fit below which a derivative by gravity shows whether another direction explains more: the links of a fit
/// with a very different gravity give no information about it.
const WELL: f64 = 0.05;
/// Most steps of Gauss-Newton.
const STEPS: usize = 6;
/// Part by which a step must reduce the squared residual.
const PROGRESS: f64 = 1e-3;

/// Checks gravity; returns whether it makes all estimates wrong. Another fault of the recording is the better explanation if it
/// reduces the squared residual more.
pub(in crate::checks) fn check(
    exam: &mut Examination<'_>,
    recording: &ThinnedRecording<'_>,
    hypotheses: &[Hypothesis],
) -> bool {
    let stated = exam.subject.robot.gravity;
    let Some(rows) = GravityRows::new(recording).filter(|_| norm(stated) > 0.0) else { return false };
    let Some(Better { squares, gravity: found, stated: stated_fit }) = better(recording, &rows, stated) else {
        return false;
    };
    if weight::check(exam, recording, hypotheses, (&rows, &stated_fit, squares)) {
        return true;
    }
    let ratio = stated_fit.squares() / squares;
    let evidence = evidence(ratio);
    let angle = angle_deg(stated, found);
    let limit = if angle > WRONG_DEG { WRONG_LIMIT } else { LIMIT };
    if angle < LEAST_DEG || ratio <= limit || fault::largest_gain(recording, hypotheses) > ratio {
        exam.note_measure(evidence);
        return clock::check(exam, recording, hypotheses, (&rows, &stated_fit));
    }
    let severity = if angle > WRONG_DEG || ratio > WRONG_RATIO { Severity::Problem } else { Severity::Warning };
    exam.judge(evidence, severity, || finding_text(ratio, found, angle));
    severity == Severity::Problem
}

fn finding_text(ratio: f64, found: Vec3, angle: f64) -> FindingText {
    let gravity = found.map(|component| fixed(component, 2)).join(", ");
    let message = format!(
        "the torques fit {} times better if gravity is [{gravity}] m/s^2 in the base frame, {angle:.0} degrees from the stated one: \
         the robot hangs, is mounted on a wall, or its base is tilted",
        significant(ratio.sqrt(), 3)
    );
    let exact = found.map(|component| (component * DIGITS).round() / DIGITS);
    let remedy = format!(
        "check how the base is mounted; if it is mounted so, state gravity = {exact:?} at the top of the experiment; otherwise check \
         the zeros of the first joints, and whether the description is of this robot"
    );
    let is_sure = angle < TURNED_DEG || ratio > WRONG_RATIO;
    FindingText::new(message, remedy).with_step(is_sure.then_some(RemedyStep::Gravity { gravity: exact }))
}

fn angle_deg(a: Vec3, b: Vec3) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b)).to_degrees()
}

/// The direction of gravity that explains the torques best.
struct Better {
    gravity: Vec3,
    /// The squared residual with it.
    squares: f64,
    /// The fit with the stated one.
    stated: GravityFit,
}

/// The best gravity of the same length; the stated one if no other explains the torques, `None` without links.
fn better(recording: &ThinnedRecording<'_>, rows: &GravityRows<'_, '_>, stated: Vec3) -> Option<Better> {
    let length = norm(stated);
    let stated_fit = rows.fit(stated)?;
    let squares = stated_fit.squares();
    let reach = squares / stated_fit.fit_with_directions(recording, &AXES)?.squares;
    if reach < LIMIT && stated_fit.fit.relative_error() < WELL {
        return Some(Better { gravity: stated, squares: squares / reach, stated: stated_fit });
    }
    let along = |axis: &Vec3| [length, -length].map(|l| scale(l, *axis));
    let others = AXES.iter().flat_map(along).filter(|g| angle_deg(*g, stated) > LEAST_DEG);
    let all = others.filter_map(|gravity| rows.fit(gravity));
    let other = all.min_by(|a, b| a.squares().total_cmp(&b.squares())).filter(|other| other.squares() < squares);
    let other = other.map(|other| refined(rows, &other).unwrap_or(other));
    // A direction of which the torques show no sign keeps the stated one: of a SCARA arm the offset of its slide takes gravity along it.
    let nearest = refined(rows, &stated_fit);
    let nearest = nearest.as_ref().unwrap_or(&stated_fit);
    let best = other.as_ref().filter(|other| nearest.squares() > ALIKE * other.squares()).unwrap_or(nearest);
    let is_poor = best.fit.relative_error() > POOR;
    let (gravity, squares) = if is_poor { (stated, squares) } else { (best.gravity, best.squares()) };
    Some(Better { gravity, squares, stated: stated_fit })
}

/// The best direction near a start; none if none is better.
fn refined(rows: &GravityRows<'_, '_>, start: &GravityFit) -> Option<GravityFit> {
    let mut best: Option<GravityFit> = None;
    for _ in 0..STEPS {
        let from = best.as_ref().unwrap_or(start);
        let squares = from.squares();
        let Some(next) = from.next(rows).filter(|next| next.squares() < (1.0 - PROGRESS) * squares) else { break };
        best = Some(next);
    }
    best
}
