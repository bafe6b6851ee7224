//! Gross faults of the record, by the scale of the fit: the record is put right in every way that is known to go wrong,
//! and the correction that makes the fit much better is what was wrong.

use super::{
    Code, Severity,
    affine::Affine,
    chain::{Chain, Motion, at},
    examination::{Evidence, Examination},
    friction,
    hypotheses::{Hypothesis, hypotheses},
    numbers::span,
    regression::squared_residual,
};
use crate::{robot::JointKind, series::Series};

/// Spans that a joint's motion has, rad: other corrections are not considered.
const SPANS_RAD: std::ops::RangeInclusive<f64> = 0.1..=25.0;
/// The same for prismatic joints, m.
const SPANS_M: std::ops::RangeInclusive<f64> = 1e-3..=20.0;
/// A later hypothesis of the list must be better than an earlier one by this factor.
const BETTER: f64 = 0.9;
/// Rows of all joints per parameter in the screening.
const ROWS_PER_PARAMETER: usize = 8;
/// Faults that are looked for one after the other.
const MOST_FAULTS: usize = 4;

/// Corrects the chain by every fault that is found.
pub(super) fn check(exam: &mut Examination<'_>, chain: &mut Chain<'_>) {
    let all = hypotheses(exam.subject.robot);
    for round in 0..MOST_FAULTS {
        let Some(gains) = gains(chain, &all) else { return };
        if round == 0 {
            note_measures(exam, &all, &gains);
        }
        let Some((best, gain)) = best(&all, &gains) else { return };
        raise(exam, &all[best], gain);
        chain.correct(&all[best].correction);
    }
}

/// The strongest evidence of each code and limit.
fn note_measures(exam: &mut Examination<'_>, all: &[Hypothesis], gains: &[f64]) {
    let mut strongest: Vec<(&Hypothesis, f64)> = Vec::new();
    for (hypothesis, &gain) in all.iter().zip(gains).filter(|(_, g)| g.is_finite()) {
        let same = |s: &&mut (&Hypothesis, f64)| s.0.code == hypothesis.code && s.0.limit == hypothesis.limit;
        match strongest.iter_mut().find(same) {
            Some(entry) if entry.1 < gain => *entry = (hypothesis, gain),
            Some(_) => {}
            None => strongest.push((hypothesis, gain)),
        }
    }
    strongest.into_iter().for_each(|(h, gain)| exam.note_measure(evidence(h, gain)));
}

fn raise(exam: &mut Examination<'_>, hypothesis: &Hypothesis, gain: f64) {
    let message = format!("the torques fit {:.1} times better if {}", gain.sqrt(), hypothesis.words);
    let words = (message, hypothesis.remedy.to_owned());
    exam.raise(evidence(hypothesis, gain), Severity::Problem, words, Vec::new());
}

fn evidence(hypothesis: &Hypothesis, gain: f64) -> Evidence {
    let Hypothesis { code, joint, limit, .. } = *hypothesis;
    Evidence { code, joint, value: gain, unit: "times the squared residual", limit }
}

/// How many times smaller each correction makes the squared residual; NaN for those that are not considered.
fn gains(chain: &Chain<'_>, hypotheses: &[Hypothesis]) -> Option<Vec<f64>> {
    let screening = Screening::new(chain);
    let as_it_is = screening.squares(chain, &Affine::identity(chain.joints()))?;
    let power = friction::power(chain, &*chain.regression().ok()?);
    let gain = |h: &Hypothesis| {
        if !is_plausible(h, chain, &screening.spans) || !agrees_with_friction(h, chain, &power) {
            return f64::NAN;
        }
        screening.squares(chain, &h.correction).map_or(f64::NAN, |squares| as_it_is / squares)
    };
    Some(hypotheses.iter().map(gain).collect())
}

/// The hypothesis with the largest gain of those above their limits. Of nearly equal ones the first.
fn best(hypotheses: &[Hypothesis], gains: &[f64]) -> Option<(usize, f64)> {
    let mut best: Option<(usize, f64)> = None;
    for (h, &gain) in gains.iter().enumerate().filter(|(h, g)| **g > hypotheses[*h].limit) {
        if best.is_none_or(|(_, largest)| BETTER * gain > largest) {
            best = Some((h, gain));
        }
    }
    best
}

/// Whether the corrected joints would span what joints do.
fn is_plausible(hypothesis: &Hypothesis, chain: &Chain<'_>, spans: &[f64]) -> bool {
    if hypothesis.code != Code::PositionScale {
        return true;
    }
    let sizes =
        |i: usize| spans.iter().enumerate().map(move |(j, s)| (hypothesis.correction.position.at(i, j) * s).abs());
    let plausible = |i: usize| match chain.subject.robot.joints[i].kind {
        JointKind::Revolute => SPANS_RAD.contains(&sizes(i).sum::<f64>()),
        JointKind::Prismatic => SPANS_M.contains(&sizes(i).sum::<f64>()),
    };
    hypothesis.joint.map_or_else(|| (0..spans.len()).all(plausible), plausible)
}

/// A single sign that is wrong makes friction negative.
fn agrees_with_friction(hypothesis: &Hypothesis, chain: &Chain<'_>, power: &[f64]) -> bool {
    let has_friction = (0..chain.subject.base.len()).any(|c| chain.is_friction(c));
    match (hypothesis.joint, hypothesis.flips_power) {
        (Some(j), true) => !has_friction || power[j] < -friction::NEGATIVE_LIMIT,
        _ => true,
    }
}

/// A few rows of the record, unfiltered.
struct Screening {
    /// What each joint's position spans.
    spans: Vec<f64>,
    motion: Motion,
    torque: Series,
}

impl Screening {
    fn new(chain: &Chain<'_>) -> Self {
        let wanted = ROWS_PER_PARAMETER * chain.subject.base.len() / chain.joints() + 1;
        let step = (chain.rows() / wanted).max(1);
        let samples: Vec<usize> = chain.kept.iter().step_by(step).copied().collect();
        let Motion { q, dq, ddq } = &chain.motion;
        let motion = Motion { q: at(q, &samples), dq: at(dq, &samples), ddq: at(ddq, &samples) };
        let spans = (0..chain.joints()).map(|j| span(&chain.motion.q.channel(j))).collect();
        Self { spans, motion, torque: at(&chain.torque, &samples) }
    }

    /// Squared residual, relative to the torques as corrected; none where it is not finite.
    fn squares(&self, chain: &Chain<'_>, correction: &Affine) -> Option<f64> {
        let x = chain.raw_matrix(&correction.motion(&self.motion));
        let torque = correction.torque(&self.torque);
        let y: Vec<f64> = (0..torque.channels()).flat_map(|j| torque.channel(j)).collect();
        let squares = squared_residual(&x, &y, chain.joints());
        squares.is_finite().then_some(squares)
    }
}
