//! Gross faults of the recording. Every correction of a known fault is tried; if one improves the fit much, that fault is
//! reported.

use super::{
    alike, friction,
    hypotheses::{Hypothesis, hypotheses},
};
use crate::{
    checks::{
        examination::{Evidence, Examination, FindingText},
        finding::{Code, Severity},
        fit::{
            affine::Affine,
            orthogonal_fit::squared_residual,
            thinned_recording::{ThinnedRecording, at, motion_at},
        },
        numbers::span,
    },
    signal::Motion,
};
use thetahat_ground::series::Series;
use thetahat_model::robot::JointKind;

/// Plausible spans of a joint's motion, rad: corrections that lead to others are not considered.
const SPANS_RAD: std::ops::RangeInclusive<f64> = 0.1..=25.0;
/// The same for prismatic joints, m.
const SPANS_M: std::ops::RangeInclusive<f64> = 1e-3..=20.0;
/// Factor by which a later hypothesis of the list must be better than an earlier one.
const BETTER: f64 = 0.9;
/// Rows of all joints per parameter in the screening.
const ROWS_PER_PARAMETER: usize = 8;
/// The same of an exchange that the errors of all torques hardly show.
const HARDLY_CHANGES: f64 = 0.8;
/// Most work for trying all corrections: for larger robots, corrections of single joints and pairs are not tried. Twelve joints
/// with 108 parameters need a fifth of it.
const MOST_WORK: f64 = 2e10;
/// Most faults that are corrected one after the other.
const MOST_FAULTS: usize = 4;

/// Corrects every fault that is found in the recording.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &mut ThinnedRecording<'_>) {
    let all = affordable(recording);
    for round in 0..MOST_FAULTS {
        let Some(gains) = gains(recording, &all) else { return };
        if round == 0 {
            note_measures(exam, &all, &gains);
        }
        let Some(best) = best(&all, &gains) else {
            if round == 0 {
                let hardly_change = all.iter().zip(&gains).filter(|(_, gain)| **gain > HARDLY_CHANGES).map(|(h, _)| h);
                alike::check(exam, recording, hardly_change);
            }
            return;
        };
        raise(exam, &all[best], gains[best]);
        recording.correct(&all[best].correction);
    }
}

/// Factor by which the best correction reduces the squared residual; one if no fault is found.
pub(in crate::checks) fn largest_gain(recording: &ThinnedRecording<'_>) -> f64 {
    let all = affordable(recording);
    let gains = gains(recording, &all).unwrap_or_default();
    best(&all, &gains).map_or(1.0, |best| gains[best])
}

/// The hypotheses that are cheap enough to try.
fn affordable(recording: &ThinnedRecording<'_>) -> Vec<Hypothesis> {
    let mut all = hypotheses(recording.subject.robot);
    let work = (ROWS_PER_PARAMETER * recording.parameters().pow(3)) as f64;
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
    let message = format!("the torques fit {:.1} times better if {}", gain.sqrt(), hypothesis.text);
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

/// The index of the hypothesis with the largest gain above its limit; the first of nearly equal ones.
fn best(hypotheses: &[Hypothesis], gains: &[f64]) -> Option<usize> {
    let mut best: Option<usize> = None;
    for (h, &gain) in gains.iter().enumerate().filter(|(h, g)| **g > hypotheses[*h].limit) {
        if best.is_none_or(|best| BETTER * gain > gains[best]) {
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

/// A few rows of the recording, unfiltered.
struct Screening {
    /// Span of each coordinate, rad or m.
    spans: Vec<f64>,
    motion: Motion,
    torque: Series,
}

impl Screening {
    fn new(recording: &ThinnedRecording<'_>) -> Self {
        let rows = ROWS_PER_PARAMETER * recording.parameters() / recording.coordinates() + 1;
        let step = (recording.rows() / rows).max(1);
        let samples: Vec<usize> = recording.kept.iter().step_by(step).copied().collect();
        let motion = motion_at(&recording.motion, &samples);
        let spans = (0..recording.coordinates()).map(|j| span(&recording.motion.q.channel(j))).collect();
        Self { spans, motion, torque: at(&recording.torque, &samples) }
    }

    /// Squared residual, relative to the corrected torques; `None` if it is not finite.
    fn squares(&self, recording: &ThinnedRecording<'_>, correction: &Affine) -> Option<f64> {
        let (motion, torque) = (correction.motion(&self.motion), correction.torque(&self.torque));
        let squares = squared_residual(&recording.unfiltered_regression(&motion, &torque));
        squares.is_finite().then_some(squares)
    }
}
