//! Torques without the weight of the links: drivers that compensate gravity log what is left.
//!
//! Parameters absorb a missing weight: first moments near zero. Two things contradict it. Without gravity the torques fit better than with
//! any direction of it, as the links' inertia needs the first moments; and where the description has masses, the weight that they would
//! have is not in what a fit without gravity leaves.

use super::{
    fault,
    gravity_fit::{ALIKE, GravityFit, LIMIT, POOR, WRONG_RATIO},
};
use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::thinned_recording::ThinnedRecording,
    remedy_step::RemedyStep,
};
use thetahat_ground::{number::significant, vector::Vec3};

/// Largest part of the described weight that such torques hold.
const LEAST_WEIGHT: f64 = 0.1;

/// Checks whether the torques lack the weight of the links, where `best` is the squared residual with the best direction of gravity;
/// returns whether it raised a finding.
pub(super) fn check(
    exam: &mut Examination<'_>,
    recording: &ThinnedRecording<'_>,
    stated: &GravityFit,
    best: f64,
) -> bool {
    let Some(without) = GravityFit::new(recording, [0.0; 3]) else { return false };
    let is_best = without.squares() <= ALIKE * best && without.fit.relative_error() < POOR;
    let ratio = stated.squares() / without.squares();
    let weight = if is_best { described_weight(recording, stated.gravity, &without) } else { None };
    let lacks_weight = weight.is_some_and(|weight| weight.part.abs() < LEAST_WEIGHT && weight.ratio > WRONG_RATIO);
    let fits_better = is_best && ratio > LIMIT && fault::largest_gain(recording) <= ratio;
    if !lacks_weight && !fits_better {
        return false;
    }
    let value = if lacks_weight { weight.map_or(ratio, |weight| weight.ratio) } else { ratio };
    let evidence = Evidence {
        code: Code::GravityDirection,
        coordinate: None,
        value,
        unit: "times smaller squared residual",
        limit: LIMIT,
    };
    let part = weight.map(|weight| weight.part);
    exam.raise(evidence, Severity::Problem, finding_text(ratio, part.filter(|_| lacks_weight)));
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

/// The weight of the description's links in the torques.
#[derive(Clone, Copy)]
struct DescribedWeight {
    /// Part of it that the torques hold.
    part: f64,
    /// Factor by which all of it would increase the squared residual of the fit without gravity.
    ratio: f64,
}

/// None without masses.
fn described_weight(recording: &ThinnedRecording<'_>, gravity: Vec3, without: &GravityFit) -> Option<DescribedWeight> {
    let subject = recording.subject;
    let theta = subject.robot.a_priori_parameters_for(subject.model.parameter_table());
    let of_columns: Vec<f64> = without.columns.iter().map(|&column| theta[column]).collect();
    let weight = without.fit.unexplained(&without.torque_along(recording, gravity, &of_columns)?);
    let squares: f64 = weight.iter().map(|w| w * w).sum();
    let along: f64 = weight.iter().zip(&without.fit.residual).map(|(w, e)| w * e).sum();
    (squares > 0.0).then(|| DescribedWeight { part: along / squares, ratio: 1.0 + squares / without.squares() })
}
