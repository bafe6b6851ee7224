//! Torques without the weight of the links: drivers that compensate gravity log what is left.
//!
//! Parameters absorb a missing weight: first moments near zero. Two things contradict it. Without gravity the torques fit better than with
//! any direction of it, as the links' inertia needs the first moments; and where the description has masses, the weight that they would
//! have is not in what a fit without gravity leaves.

use super::{
    described_weight::described_weight,
    fault,
    gravity_fit::{ALIKE, GravityFit, GravityRows, LIMIT, POOR, WRONG_RATIO, evidence},
    hypotheses::Hypothesis,
};
use crate::checks::{
    examination::{Examination, FindingText},
    finding::Severity,
    fit::thinned_recording::ThinnedRecording,
    remedy_step::RemedyStep,
};
use thetahat_ground::{
    number::significant,
    vector::{norm, scale},
};

/// Largest part of the described weight that such torques hold.
const LEAST_WEIGHT: f64 = 0.1;
/// The same of torques of which the driver subtracts a model of its own, whose masses are wrong.
const PART_OF_WEIGHT: f64 = 0.7;
/// Steps of Gauss-Newton on the strength of gravity.
const STEPS: usize = 3;

/// Checks whether the torques lack the weight of the links, where `best` is the squared residual with the best direction of gravity;
/// returns whether it raised a finding. Other faults are among `hypotheses`.
pub(super) fn check(
    exam: &mut Examination<'_>,
    recording: &ThinnedRecording<'_>,
    hypotheses: &[Hypothesis],
    (rows, stated, best): (&GravityRows<'_, '_>, &GravityFit, f64),
) -> bool {
    let Some(without) = rows.fit([0.0; 3]) else { return false };
    let is_best = without.squares() <= ALIKE * best && without.fit.relative_error() < POOR;
    let ratio = stated.squares() / without.squares();
    let weight = if is_best { described_weight(recording, stated.gravity, &without) } else { None };
    let lacks_weight = weight.is_some_and(|weight| weight.part.abs() < LEAST_WEIGHT && weight.ratio > WRONG_RATIO);
    let fits_better = is_best && ratio > LIMIT && fault::largest_gain(recording, hypotheses) <= ratio;
    if !lacks_weight && !fits_better {
        return !is_best && is_partly_compensated(exam, recording, (rows, stated), without);
    }
    let value = if lacks_weight { weight.map_or(ratio, |weight| weight.ratio) } else { ratio };
    let part = weight.map(|weight| weight.part);
    exam.raise(evidence(value), Severity::Problem, finding_text(ratio, part.filter(|_| lacks_weight)));
    true
}

fn finding_text(ratio: f64, part: Option<f64>) -> FindingText {
    let seen = match part {
        Some(part) => format!("the torques hold {:.0} % of the weight of the description's links", 100.0 * part.abs()),
        None => format!("the torques fit {} times better without gravity", significant(ratio.sqrt(), 3)),
    };
    let message = format!("{seen}: drivers that compensate gravity log torques without it");
    let remedy = "if the driver compensates gravity, state gravity = [0, 0, 0] at the top of the experiment, and add the weight where the \
                  model is used; if springs or counterweights carry the links, correct their masses in the description";
    FindingText::new(message, remedy).with_step(RemedyStep::Gravity { gravity: [0.0; 3] })
}

/// Whether the torques fit much better with less gravity along the stated direction, and raises it: the driver subtracts the weight of a
/// model of its own.
fn is_partly_compensated(
    exam: &mut Examination<'_>,
    recording: &ThinnedRecording<'_>,
    (rows, stated): (&GravityRows<'_, '_>, &GravityFit),
    without: GravityFit,
) -> bool {
    let length = norm(stated.gravity);
    let described = described_weight(recording, stated.gravity, &without);
    if described.is_none_or(|weight| weight.part.abs() > PART_OF_WEIGHT) {
        return false;
    }
    let Some(weaker) = weaker(recording, (rows, stated), without) else { return false };
    let part = norm(weaker.gravity) / length;
    let value = stated.squares() / weaker.squares();
    if part > PART_OF_WEIGHT || value < LIMIT || weaker.fit.relative_error() > POOR {
        return false;
    }
    let message = format!(
        "the torques fit {} times better with {:.0} % of gravity: drivers that compensate gravity by a model of their own log what \
         that model lacks",
        significant(value.sqrt(), 3),
        100.0 * part
    );
    let remedy = "log the torques without the driver's compensation, or add what it subtracts";
    exam.raise(evidence(value), Severity::Problem, FindingText::new(message, remedy));
    true
}

/// The strength of gravity along the stated direction with the least squared residual.
fn weaker(
    recording: &ThinnedRecording<'_>,
    (rows, stated): (&GravityRows<'_, '_>, &GravityFit),
    without: GravityFit,
) -> Option<GravityFit> {
    let direction = scale(1.0 / norm(stated.gravity), stated.gravity);
    let mut best = without;
    for _ in 0..STEPS {
        let theta = best.fit_with_directions(recording, &[direction])?.theta();
        let strength = norm(best.gravity) + theta.last()?;
        best = rows.fit(scale(strength.max(0.0), direction))?;
    }
    Some(best)
}
