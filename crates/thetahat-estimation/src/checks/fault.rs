//! Gross faults of the record: every correction of a known fault is tried, and the one that makes the fit much better
//! names the fault.

use super::{
    affine::Affine,
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    friction,
    hypotheses::{Hypothesis, hypotheses},
    numbers::span,
    orthogonal_fit::squared_residual,
    thinned_record::{ThinnedRecord, at, motion_at},
};
use crate::signal::Motion;
use thetahat_ground::series::Series;
use thetahat_model::robot::JointKind;

/// Spans that a joint's motion has, rad: other corrections are not considered.
const SPANS_RAD: std::ops::RangeInclusive<f64> = 0.1..=25.0;
/// The same for prismatic joints, m.
const SPANS_M: std::ops::RangeInclusive<f64> = 1e-3..=20.0;
/// A later hypothesis of the list must be better than an earlier one by this factor.
const BETTER: f64 = 0.9;
/// Rows of all joints per parameter in the screening.
const ROWS_PER_PARAMETER: usize = 8;
/// Most work of trying all corrections: beyond, those of single joints and pairs are not tried. Twelve joints with 108
/// parameters take a fifth of it.
const MOST_WORK: f64 = 2e10;
/// Faults that are looked for one after the other.
const MOST_FAULTS: usize = 4;

/// Corrects the record by every fault that is found.
pub(super) fn check(exam: &mut Examination<'_>, record: &mut ThinnedRecord<'_>) {
    let all = affordable(record);
    for round in 0..MOST_FAULTS {
        let Some(gains) = gains(record, &all) else { return };
        if round == 0 {
            note_measures(exam, &all, &gains);
        }
        let Some(best) = best(&all, &gains) else { return };
        raise(exam, &all[best], gains[best]);
        record.correct(&all[best].correction);
    }
}

/// How many times smaller the correction of one fault makes the squared residual; one where none is found.
pub(super) fn largest_gain(record: &ThinnedRecord<'_>) -> f64 {
    let all = affordable(record);
    let gains = gains(record, &all).unwrap_or_default();
    best(&all, &gains).map_or(1.0, |best| gains[best])
}

/// The hypotheses that there is time to try.
fn affordable(record: &ThinnedRecord<'_>) -> Vec<Hypothesis> {
    let mut all = hypotheses(record.subject.robot);
    let work = (ROWS_PER_PARAMETER * record.parameters().pow(3)) as f64;
    if all.len() as f64 * work > MOST_WORK {
        all.retain(|hypothesis| hypothesis.coordinate.is_none());
    }
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

fn raise(exam: &mut Examination<'_>, hypothesis: &Hypothesis, gain: f64) {
    let message = format!("the torques fit {:.1} times better if {}", gain.sqrt(), hypothesis.words);
    exam.raise(evidence(hypothesis, gain), Severity::Problem, Words::new(message, &hypothesis.remedy));
}

fn evidence(hypothesis: &Hypothesis, gain: f64) -> Evidence {
    let Hypothesis { code, coordinate, limit, .. } = *hypothesis;
    Evidence { code, coordinate, value: gain, unit: "times the squared residual", limit }
}

/// How many times smaller each correction makes the squared residual; NaN for those that are not considered.
fn gains(record: &ThinnedRecord<'_>, hypotheses: &[Hypothesis]) -> Option<Vec<f64>> {
    let screening = Screening::new(record);
    let as_it_is = screening.squares(record, &Affine::identity(record.coordinates()))?;
    let power = friction::power(record, &*record.fit().ok()?);
    let gain = |h: &Hypothesis| {
        if !is_plausible(h, record, &screening.spans) || !agrees_with_friction(h, record, &power) {
            return f64::NAN;
        }
        screening.squares(record, &h.correction).map_or(f64::NAN, |squares| as_it_is / squares)
    };
    Some(hypotheses.iter().map(gain).collect())
}

/// The hypothesis, by its index, with the largest gain of those above their limits. Of nearly equal ones the first.
fn best(hypotheses: &[Hypothesis], gains: &[f64]) -> Option<usize> {
    let mut best: Option<usize> = None;
    for (h, &gain) in gains.iter().enumerate().filter(|(h, g)| **g > hypotheses[*h].limit) {
        if best.is_none_or(|best| BETTER * gain > gains[best]) {
            best = Some(h);
        }
    }
    best
}

/// Whether the corrected positions would span what joints do.
fn is_plausible(hypothesis: &Hypothesis, record: &ThinnedRecord<'_>, spans: &[f64]) -> bool {
    if hypothesis.code != Code::PositionScale {
        return true;
    }
    let sizes =
        |i: usize| spans.iter().enumerate().map(move |(j, s)| (hypothesis.correction.position.at(i, j) * s).abs());
    let plausible = |i: usize| match record.subject.joint(i).kind {
        JointKind::Revolute => SPANS_RAD.contains(&sizes(i).sum::<f64>()),
        JointKind::Prismatic => SPANS_M.contains(&sizes(i).sum::<f64>()),
    };
    hypothesis.coordinate.map_or_else(|| (0..spans.len()).all(plausible), plausible)
}

/// A single sign that is wrong makes friction negative.
fn agrees_with_friction(hypothesis: &Hypothesis, record: &ThinnedRecord<'_>, power: &[f64]) -> bool {
    let has_friction = (0..record.parameters()).any(|c| record.is_friction(c));
    let flipped = hypothesis.coordinate.filter(|_| hypothesis.flips_power && has_friction);
    flipped.is_none_or(|j| power[j] < -friction::NEGATIVE_LIMIT)
}

/// A few rows of the record, unfiltered.
struct Screening {
    /// What each coordinate spans, rad or m.
    spans: Vec<f64>,
    motion: Motion,
    torque: Series,
}

impl Screening {
    fn new(record: &ThinnedRecord<'_>) -> Self {
        let wanted = ROWS_PER_PARAMETER * record.parameters() / record.coordinates() + 1;
        let step = (record.rows() / wanted).max(1);
        let samples: Vec<usize> = record.kept.iter().step_by(step).copied().collect();
        let motion = motion_at(&record.motion, &samples);
        let spans = (0..record.coordinates()).map(|j| span(&record.motion.q.channel(j))).collect();
        Self { spans, motion, torque: at(&record.torque, &samples) }
    }

    /// Squared residual, relative to the torques as corrected; none where it is not finite.
    fn squares(&self, record: &ThinnedRecord<'_>, correction: &Affine) -> Option<f64> {
        let (motion, torque) = (correction.motion(&self.motion), correction.torque(&self.torque));
        let squares = squared_residual(&record.unfiltered_regression(&motion, &torque));
        squares.is_finite().then_some(squares)
    }
}
