//! Times on another scale: a sample rate that is not the stated one.
//!
//! Velocities and accelerations are then wrong by a ratio c and its square, which inertias and friction absorb. What is left is the weight:
//! first moments count in it and, squared by c, in the torques of motion. Gravity that is `1 / c^2` as strong has the same effect, and the
//! torques are linear in it.

use super::{
    described_weight::described_weight,
    fault,
    gravity_fit::{GravityFit, GravityRows, POOR, WRONG_RATIO},
    hypotheses::Hypothesis,
};
use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::thinned_recording::ThinnedRecording,
};
use thetahat_ground::{
    number::significant,
    vector::{norm, scale},
};

/// Factor by which another scale must reduce the squared residual.
const LIMIT: f64 = 1.5;
/// Least change of the scale that is reported.
const LEAST: f64 = 0.03;
/// Change of the scale above which all estimates are wrong.
const WRONG: f64 = 0.15;
/// Most steps of Gauss-Newton, and the largest ratio of two strengths from one step to the next.
const STEPS: usize = 8;
const LARGEST_STEP: f64 = 2.0;
/// Part by which a step must reduce the squared residual.
const PROGRESS: f64 = 1e-3;
/// Least part of the described weight that the torques hold: drivers that compensate some of it log the rest.
const LEAST_WEIGHT: f64 = 0.7;

/// Checks the scale of the times; returns whether all estimates are wrong. Another fault of the recording is the better explanation if it
/// reduces the squared residual more.
pub(super) fn check(
    exam: &mut Examination<'_>,
    recording: &ThinnedRecording<'_>,
    hypotheses: &[Hypothesis],
    (rows, stated): (&GravityRows<'_, '_>, &GravityFit),
) -> bool {
    let Some(best) = best_strength(recording, rows, stated) else { return false };
    let ratio = stated.squares() / best.squares();
    let factor = (norm(best.gravity) / norm(stated.gravity)).sqrt();
    let evidence = Evidence {
        code: Code::TimeScale,
        coordinate: None,
        value: ratio,
        unit: "times smaller squared residual",
        limit: LIMIT,
    };
    let is_found = ratio > LIMIT && (factor - 1.0).abs() > LEAST && best.fit.relative_error() < POOR;
    if !is_found || fault::largest_gain(recording, hypotheses) > ratio || !has_weight(recording, rows, stated) {
        exam.note_measure(evidence);
        return false;
    }
    let is_wrong = ratio > WRONG_RATIO || (factor - 1.0).abs() > WRONG;
    let severity = if is_wrong { Severity::Problem } else { Severity::Warning };
    exam.raise(evidence, severity, finding_text(ratio, factor, exam.subject.sample_rate_hz));
    severity == Severity::Problem
}

fn finding_text(ratio: f64, factor: f64, rate_hz: f64) -> FindingText {
    let message = format!(
        "the torques fit {} times better if {} Hz were {} Hz: the weight of the links and their inertia contradict each other",
        significant(ratio.sqrt(), 3),
        significant(rate_hz, 4),
        significant(rate_hz / factor, 4)
    );
    let remedy = "check sample_rate_hz, or the unit and the clock of the times; if they are right, check springs and counterweights that \
                  carry the links, and gravity";
    FindingText::new(message, remedy)
}

/// The fit with the strength of gravity along the stated direction that has the least squared residual; none if none is better.
fn best_strength(
    recording: &ThinnedRecording<'_>,
    rows: &GravityRows<'_, '_>,
    stated: &GravityFit,
) -> Option<GravityFit> {
    let direction = scale(1.0 / norm(stated.gravity), stated.gravity);
    let mut best: Option<GravityFit> = None;
    for _ in 0..STEPS {
        let from = best.as_ref().unwrap_or(stated);
        let strength = norm(from.gravity);
        let change = *from.fit_with_directions(recording, &[direction])?.theta().last()?;
        let next = (strength + change).clamp(strength / LARGEST_STEP, strength * LARGEST_STEP);
        let found = rows.fit(scale(next, direction))?;
        if found.squares() > (1.0 - PROGRESS) * from.squares() {
            break;
        }
        best = Some(found);
    }
    best
}

/// Whether the torques hold the described weight, or the description has none.
fn has_weight(recording: &ThinnedRecording<'_>, rows: &GravityRows<'_, '_>, stated: &GravityFit) -> bool {
    let without = rows.fit([0.0; 3]);
    let weight = without.and_then(|without| described_weight(recording, stated.gravity, &without));
    weight.is_none_or(|weight| weight.part > LEAST_WEIGHT)
}
