//! Gross faults of the recording. Every correction of a known fault is tried; if one improves the fit much, that fault is
//! reported.

use super::{
    alike, friction,
    hypotheses::{Hypothesis, hypotheses},
    mixed_units, order,
    screening::{SPANS_M, SPANS_RAD, Screening},
};
use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::{affine::Affine, thinned_recording::ThinnedRecording},
};
use thetahat_model::robot::JointKind;

/// Factor by which a later hypothesis of the list must be better than an earlier one of another kind.
const BETTER: f64 = 0.9;
/// The same of an exchange that the errors of all torques hardly show.
const HARDLY_CHANGES: f64 = 0.8;
/// Most work for trying all corrections: for larger robots, corrections of single joints and pairs are not tried. Twelve joints
/// with 108 parameters need a fifth of it.
const MOST_WORK: f64 = 2e10;
/// Most faults that are corrected one after the other.
const MOST_FAULTS: usize = 4;

/// Corrects every fault that is found in the recording.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &mut ThinnedRecording<'_>, all: &[Hypothesis]) {
    for round in 0..MOST_FAULTS {
        let Some(gains) = gains(recording, all) else { return };
        if round == 0 {
            note_measures(exam, all, &gains);
        }
        let Some(best) = best(all, &gains) else {
            if round == 0 {
                let hardly_change = all.iter().zip(&gains).filter(|(_, gain)| **gain > HARDLY_CHANGES).map(|(h, _)| h);
                alike::check(exam, recording, hardly_change);
            }
            return;
        };
        let rivals = rivals(all, &gains, best);
        raise(exam, &all[best], gains[best], &rivals);
        recording.correct(&all[best].correction);
    }
}

/// Factor by which the best correction reduces the squared residual; one if no fault is found.
pub(in crate::checks) fn largest_gain(recording: &ThinnedRecording<'_>, all: &[Hypothesis]) -> f64 {
    let gains = gains(recording, all).unwrap_or_default();
    best(all, &gains).map_or(1.0, |best| gains[best])
}

/// The hypotheses that are cheap enough to try.
pub(in crate::checks) fn affordable(recording: &ThinnedRecording<'_>) -> Vec<Hypothesis> {
    let screening = Screening::new(recording);
    let mut all = hypotheses(recording.subject.robot);
    all.extend(mixed_units::mixed_units(recording.subject.robot, &screening.spans));
    if all.len() as f64 * Screening::work(recording) > MOST_WORK {
        all.retain(|hypothesis| hypothesis.coordinate.is_none());
    }
    all.extend(order::other_order(recording, &screening));
    all
}

/// The strongest evidence of each code and limit.
fn note_measures(exam: &mut Examination<'_>, all: &[Hypothesis], gains: &[f64]) {
    let mut strongest: Vec<Evidence> = Vec::new();
    for (hypothesis, &gain) in all.iter().zip(gains).filter(|(_, g)| g.is_finite()) {
        let evidence = evidence(hypothesis, gain);
        match strongest.iter_mut().find(|s| s.code == evidence.code && s.limit == evidence.limit) {
            Some(entry) if entry.value < gain => *entry = evidence,
            Some(_) => {}
            None => strongest.push(evidence),
        }
    }
    strongest.into_iter().for_each(|evidence| exam.note_measure(evidence));
}

/// The joints of hypotheses of the same kind that explain nearly as much: a mirrored robot has another joint's sign.
fn rivals(hypotheses: &[Hypothesis], gains: &[f64], best: usize) -> Vec<usize> {
    let is_rival =
        |h: &usize| *h != best && hypotheses[*h].is_sign_like(&hypotheses[best]) && gains[*h] > BETTER * gains[best];
    (0..hypotheses.len()).filter(is_rival).filter_map(|h| hypotheses[h].coordinate).collect()
}

fn raise(exam: &mut Examination<'_>, hypothesis: &Hypothesis, gain: f64, rivals: &[usize]) {
    let mut message = format!("the torques fit {:.1} times better if {}", gain.sqrt(), hypothesis.text);
    if !rivals.is_empty() {
        let numbers: Vec<String> = rivals.iter().map(|&j| exam.subject.joint_number(j).to_string()).collect();
        message += &format!("; the same of joint {} explains nearly as much", numbers.join(" or "));
    }
    let text = FindingText::new(message, &hypothesis.remedy).with_step(hypothesis.step());
    exam.raise(evidence(hypothesis, gain), Severity::Problem, text);
}

fn evidence(hypothesis: &Hypothesis, gain: f64) -> Evidence {
    let Hypothesis { code, coordinate, limit, .. } = *hypothesis;
    Evidence { code, coordinate, value: gain, unit: "times the squared residual", limit }
}

/// Factor by which each correction reduces the squared residual; NaN for those that are not considered.
fn gains(recording: &ThinnedRecording<'_>, hypotheses: &[Hypothesis]) -> Option<Vec<f64>> {
    let screening = Screening::new(recording);
    let uncorrected = screening.squares(recording, &Affine::identity(recording.coordinates()))?;
    let power = friction::power(recording, &*recording.fit().ok()?);
    let gain = |h: &Hypothesis| {
        if !is_plausible(h, recording, &screening.spans) || !agrees_with_friction(h, recording, &power) {
            return f64::NAN;
        }
        screening.squares(recording, &h.correction).map_or(f64::NAN, |squares| uncorrected / squares)
    };
    Some(hypotheses.iter().map(gain).collect())
}

/// The index of the hypothesis with the largest gain above its limit; the first of nearly equal ones of several kinds.
fn best(hypotheses: &[Hypothesis], gains: &[f64]) -> Option<usize> {
    let mut best: Option<usize> = None;
    for (h, &gain) in gains.iter().enumerate().filter(|(h, g)| **g > hypotheses[*h].limit) {
        let least = |best: usize| {
            let is_alike = hypotheses[best].is_sign_like(&hypotheses[h]);
            if is_alike { gains[best] } else { gains[best] / BETTER }
        };
        if best.is_none_or(|best| gain > least(best)) {
            best = Some(h);
        }
    }
    best
}

/// Whether the corrected positions have plausible spans.
fn is_plausible(hypothesis: &Hypothesis, recording: &ThinnedRecording<'_>, spans: &[f64]) -> bool {
    if hypothesis.code != Code::PositionScale {
        return true;
    }
    let sizes =
        |i: usize| spans.iter().enumerate().map(move |(j, s)| (hypothesis.correction.position.at(i, j) * s).abs());
    let plausible = |i: usize| match recording.subject.joint(i).kind {
        JointKind::Revolute => SPANS_RAD.contains(&sizes(i).sum::<f64>()),
        JointKind::Prismatic => SPANS_M.contains(&sizes(i).sum::<f64>()),
    };
    hypothesis.coordinate.map_or_else(|| (0..spans.len()).all(plausible), plausible)
}

/// Whether a hypothesis of one wrong sign agrees with friction, which such a sign makes negative.
fn agrees_with_friction(hypothesis: &Hypothesis, recording: &ThinnedRecording<'_>, power: &[f64]) -> bool {
    let has_friction = (0..recording.parameters()).any(|c| recording.is_friction(c));
    let flipped = hypothesis.coordinate.filter(|_| hypothesis.flips_power && has_friction);
    flipped.is_none_or(|j| power[j] < -friction::NEGATIVE_LIMIT)
}
