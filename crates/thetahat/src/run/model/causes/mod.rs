//! What the model can be wrong in, tested together.
//!
//! The column of a cause is the derivative of the predicted torque by it. What the regressor explains is projected out; the sum
//! of squares that the rest explains, of rows whitened by the long-run deviations of the residual, is chi-squared where
//! there is no such cause. The strongest cause is put in, and the others are tested again.

mod cause;
mod residual;
mod torques;

use super::{errors::Speeds, rows::ModelRows};
use crate::{preparation::Problem, run::identification::Identification};
use cause::Cause;
use residual::{Evidence, Residual};
use thetahat_ground::pool::in_parallel;
use thetahat_model::dynamics::Sign;
use thetahat_report::results::{CauseKind, ModelCause, MovedParameter, SmallestShown};
use torques::Torques;

/// log10 of the probability below which a cause is named: some 40 causes are tested.
const NAMED: f64 = -5.0;
/// The same where the cut-off is next to half of the sample rate: what the samples do to a motion that they hardly resolve
/// is in the residual too. A clean arm at 30 Hz has evidence of -10 in one of ten recordings.
const NAMED_AT_LOW_RATE: f64 = -12.0;
/// Cut-off over sample rate from which that holds.
const LOW_RATE: f64 = 0.35;
/// log10 of the probability above which a cause no longer shows once another is put in.
const GONE: f64 = -3.0;
/// Part of the strongest cause's evidence from which another counts as its rival.
const RIVAL: f64 = 0.6;
/// Causes that are put in at most.
const MOST: usize = 4;
/// Largest angle, length or change of a ratio that is named, rad, m or 1.
const LARGEST: f64 = 0.3;
/// Deviations of a parameter's shift from which a cause has moved it.
const MOVED: f64 = 1.0;

/// What the residual says.
#[derive(Default)]
pub(super) struct FoundCauses {
    /// The causes that the rows show, the strongest first.
    pub(super) causes: Vec<ModelCause>,
    pub(super) smallest_shown: Vec<SmallestShown>,
    /// The derivative of the rows by the delay of the torques, where late torques are among the causes.
    pub(super) delay: Option<Vec<f64>>,
}

/// The causes that the rows show.
pub(super) fn causes(
    identification: &Identification,
    problem: &Problem,
    rows: &ModelRows,
    speeds: &Speeds,
    (standard, deviations, transition): (&[f64], &[f64], f64),
) -> FoundCauses {
    let sign = Sign::Smooth { scale: transition };
    let Some(torques) = Torques::new(identification, problem, rows, standard, sign) else {
        return FoundCauses::default();
    };
    let candidates = torques.causes(identification.threads);
    let named_below = named_below(identification);
    let late = candidates.iter().position(|c| c.kind == CauseKind::LateTorque);
    // A delay shows where the torque changes: at reversals, which all others leave out. Its size is too small where the position
    // filter rings at rests: the check of lags measures it better.
    let of_delay = late.and_then(|late| Residual::new(rows, deviations, &[], vec![candidates[late].clone()]));
    let Some(mut residual) = Residual::new(rows, deviations, &speeds.turning, candidates) else {
        return FoundCauses::default();
    };
    let count = residual.candidates.len();
    let mut named: Vec<ModelCause> = Vec::new();
    let mut put_in: Vec<usize> = Vec::new();
    let mut delay = None;
    if let Some((late, of_delay)) = late.zip(of_delay) {
        put_in.push(late);
        if let Some(found) = of_delay.test(0).filter(|found| found.log10_p < named_below) {
            let moved = moved(&of_delay, problem, 0, &found);
            named.push(ModelCause { moved, ..found.named(&of_delay.candidates[0].cause, Vec::new()) });
            delay = of_delay.candidates[0].cause.columns.first().cloned();
            residual.put_in(late);
        }
    }
    while named.len() < MOST {
        let test = |k: usize| {
            let found = if put_in.contains(&k) { None } else { residual.test(k) };
            found.filter(|f| residual.candidates[k].cause.is_plausible(f))
        };
        let found: Vec<Option<Evidence>> = in_parallel(count, identification.threads, test);
        let evidence = |k: usize| found[k].as_ref().map(|f| f.log10_p);
        let shown = (0..count).filter_map(|k| Some((k, evidence(k)?))).filter(|(_, log10_p)| *log10_p < named_below);
        let Some((best, log10_p)) = shown.min_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        let is_other =
            |k: usize| k != best && !residual.candidates[k].cause.is_part_of(&residual.candidates[best].cause);
        let is_rival = |k: &usize| is_other(*k) && evidence(*k).is_some_and(|p| p < named_below && p < RIVAL * log10_p);
        let rivals: Vec<usize> = (0..count).filter(is_rival).collect();
        let Some(strongest) = &found[best] else { break };
        let moved = moved(&residual, problem, best, strongest);
        residual.put_in(best);
        put_in.push(best);
        let is_gone = |k: &&usize| residual.test(**k).is_none_or(|f| f.log10_p > GONE);
        let cause = |k: usize| &residual.candidates[k].cause;
        let name = |k: &usize| cause(*k).kind.with_subject(&cause(*k).subject);
        let rivals = rivals.iter().filter(is_gone).map(name).collect();
        named.push(ModelCause { moved, ..strongest.named(cause(best), rivals) });
    }
    named.sort_by(|a, b| a.log10_probability.total_cmp(&b.log10_probability));
    let hidden = (0..count).filter(|k| !put_in.contains(k)).filter_map(|k| smallest_shown(&residual, k, named_below));
    FoundCauses { causes: named, smallest_shown: hidden.collect(), delay }
}

/// log10 of the probability below which a cause is named in these recordings.
fn named_below(identification: &Identification) -> f64 {
    let slowest = identification.main.iter().map(|p| p.filtered.recording.sample_rate_hz).fold(f64::INFINITY, f64::min);
    let is_low = identification.setup().settings.signal.cutoff_hz > LOW_RATE * slowest;
    if is_low { NAMED_AT_LOW_RATE } else { NAMED }
}

/// The size of an error of the description that would be named, of a cause that is not.
fn smallest_shown(residual: &Residual, candidate: usize, named_below: f64) -> Option<SmallestShown> {
    let cause = &residual.candidates[candidate].cause;
    match cause.kind {
        CauseKind::EncoderZero | CauseKind::GearRatio | CauseKind::Length => {}
        CauseKind::LateTorque
        | CauseKind::Elasticity
        | CauseKind::Coupling
        | CauseKind::LoadFriction
        | CauseKind::SpeedFriction
        | CauseKind::FrictionDrift
        | CauseKind::Payload => return None,
    }
    let [_, deviation] = residual.test(candidate)?.size?;
    let size = residual::deviations_beyond(named_below, 1) * deviation;
    let with_others = residual.deviation_with_others(candidate);
    let with_others = with_others.map(|(deviation, count)| residual::deviations_beyond(named_below, count) * deviation);
    (size < LARGEST).then(|| SmallestShown {
        kind: cause.kind,
        subject: cause.subject.clone(),
        size,
        size_with_others: with_others.filter(|size| *size < LARGEST),
        unit: cause.unit.to_owned(),
    })
}

impl Evidence {
    /// The cause with what was found of it.
    fn named(&self, cause: &Cause, rivals: Vec<String>) -> ModelCause {
        ModelCause {
            kind: cause.kind,
            subject: cause.subject.clone(),
            log10_probability: self.log10_p,
            size: self.size.map(|s| s[0]),
            standard_deviation: self.size.map(|s| s[1]),
            unit: cause.unit.to_owned(),
            error_percent: self.error_percent,
            rivals,
            moved: Vec::new(),
        }
    }
}

impl Cause {
    /// Whether it is the same error in other words: another instant of a payload, or one place and several.
    fn is_part_of(&self, other: &Self) -> bool {
        let several = !self.members.is_empty() || !other.members.is_empty();
        self.kind == other.kind && (self.kind == CauseKind::Payload || several)
    }

    /// Whether its size is one for which a derivative says anything.
    fn is_plausible(&self, found: &Evidence) -> bool {
        let Some([size, _]) = found.size else { return true };
        match self.kind {
            CauseKind::EncoderZero | CauseKind::GearRatio | CauseKind::Length => size.abs() < LARGEST,
            CauseKind::Elasticity => size > 0.0,
            CauseKind::LateTorque
            | CauseKind::Coupling
            | CauseKind::LoadFriction
            | CauseKind::SpeedFriction
            | CauseKind::FrictionDrift
            | CauseKind::Payload => true,
        }
    }
}

/// The base parameters that a cause moved, in their deviations.
fn moved(residual: &Residual, problem: &Problem, candidate: usize, found: &Evidence) -> Vec<MovedParameter> {
    let shifts = residual.shifts(candidate, found);
    let parameters = problem.base.parameters().iter().zip(shifts);
    let mut moved: Vec<MovedParameter> = parameters
        .filter(|(_, deviations)| deviations.abs() > MOVED)
        .map(|(p, deviations)| MovedParameter { parameter: p.name.clone(), deviations })
        .collect();
    moved.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    moved
}
