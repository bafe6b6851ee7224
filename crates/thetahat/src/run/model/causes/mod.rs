//! What the model can be wrong in, tested together.
//!
//! The column of a cause is the derivative of the predicted torque by it. What the regressor explains is projected out; the sum
//! of squares that the rest explains, of rows whitened by the long-run deviations of the residual without the cause, is chi-squared where
//! there is no such cause. The strongest cause is put in, and the others are tested again.

mod cause;
mod derivatives;
mod residual;
mod ripple;
mod signal_rows;
mod tested_rows;
mod torques;

use super::rows::ModelRows;
use crate::{
    preparation::{EstimatedSize, Problem},
    run::{identification::Identification, prepared::PreparedRecording},
};
use cause::Cause;
use residual::{Evidence, Residual};
use tested_rows::TestedRows;
use thetahat_ground::pool::in_parallel;
use thetahat_model::dynamics::{FrictionTransition, Sign};
use thetahat_report::results::{CauseKind, ModelCause, MovedParameter, SmallestShown};
use torques::Torques;

/// log10 of the probability below which a cause is named: some 40 causes are tested.
const NAMED: f64 = -5.0;
/// The same of errors of the description: encoder zeros, gear ratios and lengths. Their columns are smooth functions of the motion, of which
/// filters leave little: clean arms at 30 to 500 Hz have the evidence that chance gives of some 30 columns.
const NAMED_OF_DESCRIPTION: f64 = -4.0;
/// Rows of a joint of those arms: in more rows the limit is as much lower.
const ROWS_OF_DESCRIPTION: f64 = 500.0;
/// The same where the cut-off is next to half of the sample rate: what the samples do to a motion that they hardly resolve
/// is in the residual too. A clean arm at 30 Hz has evidence of -10 in one of ten recordings.
const NAMED_AT_LOW_RATE: f64 = -12.0;
/// Cut-off over sample rate from which that holds.
const LOW_RATE: f64 = 0.35;
/// The same of elastic joints, and of laws of friction for which no torque term helps: their columns are second differences and signs of
/// the motion, whose errors the filters leave in step with the residual. Rigid arms with linear friction have shown -5.4 and -6.2.
const NAMED_BY_FILTERED: f64 = -8.0;
/// Rows of a joint of the recordings on which these limits were measured. What filters leave is the same in every row, so that its evidence
/// grows with their number as that of a true cause does: a clean arm has -38 for friction over speed in 1829 rows.
const ROWS: f64 = 300.0;
/// log10 of the probability above which a cause no longer shows once another is put in.
const GONE: f64 = -3.0;
/// Least part of the torques, percent, that a cause explains: numerical derivatives and filters leave as much. Clean arms at 2000 Hz, whose
/// fits err by 0.14 %, have shown 0.025 to 0.028 %.
const LEAST_ERROR_PERCENT: f64 = 0.035;
/// The least log10 of a probability that is written.
const LEAST: f64 = -300.0;
/// Part of the strongest cause's evidence from which another counts as its rival.
const RIVAL: f64 = 0.6;
/// Part of the squares that errors of several places explain together, from which that of one place is named instead.
const ONE_PLACE: f64 = 0.8;
/// Causes that are put in at most.
const MOST: usize = 4;
/// Largest angle, length or change of a ratio that is named, rad, m or 1.
const LARGEST: f64 = 0.3;
/// Largest part of a recorded torque that is too much: the torque of the model follows a larger one too little.
const LARGEST_GAIN: f64 = 0.5;
/// Deviations of a parameter's shift from which a cause has moved it.
const MOVED: f64 = 1.0;

/// Evidence from which laws of friction are named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FrictionEvidence {
    /// That of all causes: torque terms for them are tried next.
    BeforeTerms,
    /// That of columns which the filters blur: no term for them predicts better, or none was tried.
    AfterTerms,
}

/// What the residual says.
#[derive(Default)]
pub(super) struct FoundCauses {
    /// The causes that the rows show, the strongest first.
    pub(super) causes: Vec<ModelCause>,
    pub(super) smallest_shown: Vec<SmallestShown>,
    /// Derivatives of the rows by what is estimated with the parameters: the delay of the torques, where late torques are among the
    /// causes, and sizes in the description that are from these recordings.
    pub(super) estimated: Vec<Vec<f64>>,
}

/// The causes that the rows show.
pub(super) fn causes(
    identification: &Identification,
    problem: &Problem,
    rows: &ModelRows,
    turning: &[bool],
    (standard, deviations, transition): (&[f64], &[f64], FrictionTransition),
    friction: FrictionEvidence,
) -> FoundCauses {
    let sign = Sign::Smooth(transition);
    let tested = TestedRows::new(rows);
    let Some(torques) = Torques::new(identification, problem, &tested, standard, sign) else {
        return FoundCauses::default();
    };
    let candidates = torques.causes(identification.threads);
    let late = candidates.iter().position(|c| c.kind == CauseKind::LateTorque && c.subject.is_empty());
    // A delay shows where the torque changes: at reversals, which all others leave out. Its size is too small where the position
    // filter rings at rests: the check of lags measures it better.
    let of_delay = late.and_then(|late| {
        let residual = Residual::new(&tested.rows, deviations, &[])?;
        Some(residual.with(vec![candidates[late].clone()]))
    });
    let Some(residual) = Residual::new(&tested.rows, deviations, &tested.select(turning.to_vec())) else {
        return FoundCauses::default();
    };
    let ripples = torques.ripples(&residual, identification.threads);
    let residual = residual.with(candidates).with(ripples);
    let threads = identification.threads;
    let limits = Limits::new(identification, tested.rows.rows_of_joint(), friction);
    let sizes = &identification.setup().settings.model.estimated;
    let mut search = Search {
        residual,
        problem,
        finer: (tested.step as f64).sqrt(),
        threads,
        limits,
        is_filter_estimated: sizes.contains(&EstimatedSize::TorqueFilter),
        put_in: Vec::new(),
        named: Vec::new(),
    };
    let is_late = late.zip(of_delay).is_some_and(|(late, of_delay)| search.put_in_delay(late, &of_delay));
    search.leave_out_filters(&identification.main);
    let late = Some(EstimatedSize::Lag(None)).filter(|late| is_late && !sizes.contains(late));
    let estimated = sizes.iter().copied().chain(late).flat_map(|size| torques.of_estimated(size)).collect();
    while search.named.len() < MOST && search.put_in_strongest() {}
    let Search { residual, mut named, put_in, .. } = search;
    named.sort_by(|a, b| a.log10_probability.total_cmp(&b.log10_probability));
    let hidden = (0..residual.candidates.len()).filter(|k| !put_in.contains(k));
    let smallest_shown = hidden.filter_map(|k| smallest_shown(&residual, k, &limits)).collect();
    FoundCauses { causes: named, smallest_shown, estimated }
}

/// The causes that were put in, one after the other.
struct Search<'a> {
    residual: Residual,
    problem: &'a Problem,
    /// Deviations in the tested rows over those in all of them.
    finer: f64,
    threads: usize,
    limits: Limits,
    /// Whether the recordings gave the filter that is stated: there may be less of it.
    is_filter_estimated: bool,
    put_in: Vec<usize>,
    named: Vec<ModelCause>,
}

impl Search<'_> {
    /// Puts the delay in if rows of its own show it.
    fn put_in_delay(&mut self, late: usize, of_delay: &Residual) -> bool {
        self.put_in.push(late);
        let found = of_delay.test(0).filter(|found| found.log10_p < self.limits.named_below);
        let Some(found) = found else { return false };
        let moved = self.moved(of_delay, 0, &found);
        let cause = &of_delay.candidates[0].cause;
        self.named.push(ModelCause { moved, ..found.named(cause, Vec::new()) });
        self.residual.put_in(late);
        true
    }

    /// Leaves filters of the torques out, unless a delay of which they may be is stated. A delay of more than a sample that is not has a
    /// second order as a filter has, and so have times that jitter.
    fn leave_out_filters(&mut self, recordings: &[PreparedRecording]) {
        let recordings = || recordings.iter().map(|prepared| &prepared.filtered.recording);
        let slowest = recordings().map(|r| r.sample_rate_hz).fold(f64::INFINITY, f64::min);
        let is_late = |cause: &ModelCause| cause.size.is_some_and(|delay| delay.abs() * slowest > 1.0);
        let is_stated = self.is_filter_estimated || recordings().all(|r| r.torque_delay_s > 0.0);
        if !is_stated || self.named.iter().any(is_late) {
            let filters = (0..self.residual.candidates.len()).filter(|k| self.kind(*k) == CauseKind::TorqueFilter);
            let filters: Vec<usize> = filters.collect();
            self.put_in.extend(filters);
        }
    }

    /// Puts the strongest cause in, with the name of others that it explains away; false if none is left.
    fn put_in_strongest(&mut self) -> bool {
        let found = self.evidence();
        let log10_p = |k: usize| found[k].as_ref().map(|f| f.log10_p).filter(|p| *p < self.limits.of(self.kind(k)));
        let shown = (0..found.len()).filter_map(|k| Some((k, log10_p(k)?)));
        let Some((best, strongest)) = shown.min_by(|a, b| a.1.total_cmp(&b.1)) else { return false };
        let best = self.one_place(best, &found).filter(|k| log10_p(*k).is_some()).unwrap_or(best);
        let is_rival = |k: &usize| self.is_other(*k, best) && log10_p(*k).is_some_and(|p| p < RIVAL * strongest);
        let moved = |k: usize, found: &Evidence| self.moved(&self.residual, k, found);
        let rivals: Vec<(usize, Vec<MovedParameter>)> =
            (0..found.len()).filter(is_rival).filter_map(|k| Some((k, moved(k, found[k].as_ref()?)))).collect();
        let Some(strongest) = &found[best] else { return false };
        let by_strongest = moved(best, strongest);
        self.residual.put_in(best);
        self.put_in.push(best);
        let is_gone = |(k, _): &(usize, _)| self.residual.test(*k).is_none_or(|f| f.log10_p > GONE);
        let rivals: Vec<_> = rivals.into_iter().filter(is_gone).collect();
        let cause = |k: usize| &self.residual.candidates[k].cause;
        let names = rivals.iter().map(|(k, _)| cause(*k).kind.with_subject(&cause(*k).subject)).collect();
        let moved = rivals.into_iter().fold(by_strongest, |all, (_, moved)| furthest(all, moved));
        let named = ModelCause { moved, ..strongest.named(cause(best), names) };
        self.named.push(named);
        true
    }

    /// The one of several places whose error explains nearly as much as those of all.
    fn one_place(&self, several: usize, found: &[Option<Evidence>]) -> Option<usize> {
        let squares = |k: usize| found[k].as_ref().map(|f| f.error_percent.powi(2));
        let members = self.residual.candidates[several].cause.members.iter();
        let (place, own) = members.filter_map(|&k| Some((k, squares(k)?))).max_by(|a, b| a.1.total_cmp(&b.1))?;
        (own > ONE_PLACE * squares(several)?).then_some(place)
    }

    /// What each cause that is not put in explains of the rest.
    fn evidence(&self) -> Vec<Option<Evidence>> {
        let test = |k: usize| {
            let found = if self.put_in.contains(&k) { None } else { self.residual.test(k) };
            found.filter(|f| f.error_percent > LEAST_ERROR_PERCENT && self.is_plausible(k, f))
        };
        in_parallel(self.residual.candidates.len(), self.threads, test)
    }

    fn is_plausible(&self, k: usize, found: &Evidence) -> bool {
        let is_less_filter = self.is_filter_estimated && self.kind(k) == CauseKind::TorqueFilter;
        is_less_filter || self.residual.candidates[k].cause.is_plausible(found)
    }

    /// The base parameters that a cause moved, in their deviations of all rows.
    fn moved(&self, residual: &Residual, candidate: usize, found: &Evidence) -> Vec<MovedParameter> {
        let shifts = residual.shifts(candidate, found).into_iter().map(|deviations| self.finer * deviations);
        let parameters = self.problem.base.parameters().iter().zip(shifts);
        let mut moved: Vec<MovedParameter> = parameters
            .filter(|(_, deviations)| deviations.abs() > MOVED)
            .map(|(p, deviations)| MovedParameter { parameter: p.name.clone(), deviations })
            .collect();
        sort_by_distance(&mut moved);
        moved
    }

    fn kind(&self, k: usize) -> CauseKind {
        self.residual.candidates[k].cause.kind
    }

    /// Whether two causes are different errors.
    fn is_other(&self, k: usize, best: usize) -> bool {
        k != best && !self.residual.candidates[k].cause.is_part_of(&self.residual.candidates[best].cause)
    }
}

/// log10 of the probabilities below which causes are named.
#[derive(Clone, Copy)]
struct Limits {
    named_below: f64,
    of_description: f64,
    /// Of columns that the filters blur.
    by_filtered: f64,
    friction: FrictionEvidence,
}

impl Limits {
    fn new(identification: &Identification, rows_of_joint: usize, friction: FrictionEvidence) -> Self {
        let slowest = identification.main.iter().map(|p| p.filtered.recording.sample_rate_hz);
        let slowest = slowest.fold(f64::INFINITY, f64::min);
        let is_low = identification.setup().settings.signal.cutoff_hz > LOW_RATE * slowest;
        let rows_over = |rows: f64| (rows_of_joint as f64 / rows).max(1.0);
        let more_rows = rows_over(ROWS);
        let named_below = if is_low { NAMED_AT_LOW_RATE } else { NAMED } * more_rows.sqrt();
        let of_description = named_below.max(NAMED_OF_DESCRIPTION * rows_over(ROWS_OF_DESCRIPTION));
        let by_filtered = named_below.min(NAMED_BY_FILTERED * more_rows);
        Self { named_below, of_description, by_filtered, friction }
    }

    fn of(&self, kind: CauseKind) -> f64 {
        match kind {
            CauseKind::EncoderZero | CauseKind::GearRatio | CauseKind::Length => self.of_description,
            CauseKind::Elasticity
            | CauseKind::FrictionDrift
            | CauseKind::AsymmetricFriction
            | CauseKind::TorqueRipple
            | CauseKind::LatePosition
            | CauseKind::TorqueFilter => self.by_filtered,
            CauseKind::LoadFriction | CauseKind::SpeedFriction => match self.friction {
                FrictionEvidence::BeforeTerms => self.named_below,
                FrictionEvidence::AfterTerms => self.by_filtered,
            },
            CauseKind::LateTorque
            | CauseKind::DriveGain
            | CauseKind::OffsetDrift
            | CauseKind::Coupling
            | CauseKind::Payload
            | CauseKind::GravityDirection
            | CauseKind::Crosstalk
            | CauseKind::FallingConstant
            | CauseKind::JointSpring
            | CauseKind::GainDrift
            | CauseKind::TimeScale
            | CauseKind::ZeroShift => self.named_below,
        }
    }
}

/// From which size an error of the description would be named, of a cause that is not.
fn smallest_shown(residual: &Residual, candidate: usize, limits: &Limits) -> Option<SmallestShown> {
    let cause = &residual.candidates[candidate].cause;
    match cause.kind {
        CauseKind::EncoderZero
        | CauseKind::GearRatio
        | CauseKind::DriveGain
        | CauseKind::Length
        | CauseKind::GravityDirection => {}
        CauseKind::LateTorque
        | CauseKind::OffsetDrift
        | CauseKind::Elasticity
        | CauseKind::Coupling
        | CauseKind::LoadFriction
        | CauseKind::SpeedFriction
        | CauseKind::FrictionDrift
        | CauseKind::Payload
        | CauseKind::Crosstalk
        | CauseKind::FallingConstant
        | CauseKind::JointSpring
        | CauseKind::AsymmetricFriction
        | CauseKind::GainDrift
        | CauseKind::TorqueRipple
        | CauseKind::ZeroShift
        | CauseKind::LatePosition
        | CauseKind::TorqueFilter
        | CauseKind::TimeScale => return None,
    }
    if !cause.members.is_empty() {
        return None;
    }
    let beyond = |column: &[f64], count: usize| {
        let size = residual.size_beyond(column, limits.of(cause.kind), count);
        size.max(residual.size_explaining(column, LEAST_ERROR_PERCENT))
    };
    let size = residual.test(candidate).map(|_| beyond(residual.column(candidate), 1));
    let with_others = size.and_then(|_| residual.column_with_others(candidate));
    let with_others = with_others.map(|(column, count)| beyond(&column, count));
    let is_gain = cause.kind == CauseKind::DriveGain;
    let largest = if is_gain { LARGEST_GAIN } else { LARGEST };
    let of_cause = |size: f64| if is_gain { of_recorded([size, 0.0])[0] } else { size };
    let sized = |size: Option<f64>| size.filter(|size| *size < largest).map(of_cause);
    Some(SmallestShown {
        kind: cause.kind,
        subject: cause.subject.clone(),
        size: sized(size),
        size_with_others: sized(with_others),
        unit: cause.unit.to_owned(),
    })
}

impl Evidence {
    /// The cause with what was found of it.
    fn named(&self, cause: &Cause, rivals: Vec<String>) -> ModelCause {
        let of_cause = |size| {
            if cause.kind == CauseKind::DriveGain {
                of_recorded(size)
            } else if cause.kind == CauseKind::TorqueFilter {
                time_constant(size)
            } else {
                size
            }
        };
        let size = self.size.map(of_cause);
        ModelCause {
            kind: cause.kind,
            subject: cause.subject.clone(),
            log10_probability: self.log10_p.max(LEAST),
            size: size.map(|s| s[0]),
            standard_deviation: size.map(|s| s[1]),
            unit: cause.unit.to_owned(),
            error_percent: self.error_percent,
            rivals,
            moved: Vec::new(),
            in_model: false,
        }
    }
}

/// The error of a gain, with its deviation, from the part `e` of the recorded torque that is too much: `g / (1 + g) = e`.
fn of_recorded([part, deviation]: [f64; 2]) -> [f64; 2] {
    [part / (1.0 - part), deviation / (1.0 - part).powi(2)]
}

/// The time constant, with its deviation, of a filter of first order whose delay is known: `c = T^2 / 2`; below zero where a filter that
/// is stated has too large a one.
fn time_constant([size, deviation]: [f64; 2]) -> [f64; 2] {
    let constant = (2.0 * size.abs()).sqrt();
    [constant.copysign(size), deviation / constant]
}

impl Cause {
    /// Whether it is the same error in other words: another instant of a payload, or one place and several.
    fn is_part_of(&self, other: &Self) -> bool {
        let several = !self.members.is_empty() || !other.members.is_empty();
        let is_of_instants = matches!(self.kind, CauseKind::Payload | CauseKind::OffsetDrift | CauseKind::ZeroShift);
        self.kind == other.kind && (is_of_instants || several)
    }

    /// Whether its size is one for which a derivative says anything.
    fn is_plausible(&self, found: &Evidence) -> bool {
        let Some([size, _]) = found.size else { return true };
        match self.kind {
            CauseKind::EncoderZero
            | CauseKind::GearRatio
            | CauseKind::Length
            | CauseKind::GravityDirection
            | CauseKind::Crosstalk
            | CauseKind::ZeroShift => size.abs() < LARGEST,
            CauseKind::DriveGain | CauseKind::GainDrift => size.abs() < LARGEST_GAIN,
            // A constant does not grow with the current.
            CauseKind::FallingConstant => size > 0.0 && size < LARGEST_GAIN,
            CauseKind::Elasticity | CauseKind::TorqueFilter => size > 0.0,
            CauseKind::LateTorque
            | CauseKind::OffsetDrift
            | CauseKind::Coupling
            | CauseKind::LoadFriction
            | CauseKind::SpeedFriction
            | CauseKind::FrictionDrift
            | CauseKind::Payload
            | CauseKind::JointSpring
            | CauseKind::AsymmetricFriction
            | CauseKind::TorqueRipple
            | CauseKind::TimeScale
            | CauseKind::LatePosition => true,
        }
    }
}

/// Each parameter with the larger of two shifts: the recordings do not say which of two rivals moved it.
fn furthest(mut all: Vec<MovedParameter>, others: Vec<MovedParameter>) -> Vec<MovedParameter> {
    for other in others {
        match all.iter_mut().find(|m| m.parameter == other.parameter) {
            Some(same) if same.deviations.abs() < other.deviations.abs() => *same = other,
            Some(_) => {}
            None => all.push(other),
        }
    }
    sort_by_distance(&mut all);
    all
}

fn sort_by_distance(moved: &mut [MovedParameter]) {
    moved.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
}
