//! Lag between torque and position.
//!
//! A torque that is late by `d` is `y(t) = y0(t - d)`, so the residual of the fit follows the derivative of the predicted
//! torque. A search over whole steps starts Gauss-Newton, which shifts the torques until that part of the residual is
//! gone. Friction that turns around later than the motion looks like a lag: the columns of [`friction_shapes`] are free
//! beside the parameters, and the rows around its reversals are left out, so that inertia and gravity decide. Their lag must be one delay, of all joints or of a few that
//! agree: joints that each have a lag of their own are an error of the model.

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    friction_shapes::{friction_shapes, rows_of_reversals},
    lag_search::{LONGEST_S, Lags, Search, shifted},
    thinned_record::ThinnedRecord,
};

/// Part of the squared residual that a lag must explain, percent. The clean recordings stay below 18.
const EXPLAINED_LIMIT_PERCENT: f64 = 25.0;
/// Rms torque that it must explain, percent of the torque's deviation.
const EFFECT_LIMIT_PERCENT: f64 = 5.0;
/// Part of the squared residual from which a lag is worth a note, percent.
const NOTE_PERCENT: f64 = 5.0;
/// Standard deviations by which a lag must differ from zero: they come from ten blocks of time.
const SURE: f64 = 6.0;
/// Standard deviations within which lags of joints are the same, and part of the lag.
const SAME_DEVIATIONS: f64 = 4.0;
const SAME_PART: f64 = 0.35;
/// Lag in samples below which it is noted only.
const ONE_SAMPLE: f64 = 1.0;
/// Part of the range of the search beyond which an optimum is no measurement: the search ended there.
const INSIDE: f64 = 0.95;

/// Corrects the record by the lags that are found.
pub(super) fn check(exam: &mut Examination<'_>, record: &mut ThinnedRecord<'_>) {
    let Some(delay) = measured(record) else { return };
    if delay.joints.is_empty() {
        exam.note_measure(delay.evidence(None, 0.0));
        return;
    }
    if delay.raise(exam) {
        let late = |j: usize| if delay.joints.contains(&j) { delay.steps } else { 0.0 };
        let correction: Vec<f64> = (0..record.coordinates()).map(late).collect();
        record.replace_torque(shifted(&record.torque, &correction));
    }
}

/// One delay of torques.
struct Delay {
    /// The joints whose torques are late; empty where there is no delay.
    joints: Vec<usize>,
    of_all: bool,
    /// Steps of the record by which they are late, and the standard deviation.
    steps: f64,
    deviation: f64,
    /// Part of their squared residual that it explains, percent.
    explained: f64,
    /// Rms torque that it explains, percent of their torques' deviation.
    effect: f64,
    samples_per_step: f64,
    rate: f64,
}

/// The delay of all joints, or of those that are late; none where the record does not tell.
fn measured(record: &ThinnedRecord<'_>) -> Option<Delay> {
    let parameters = record.fit().ok()?;
    let beside = record.fit_beside(&friction_shapes(record).ok()?, &rows_of_reversals(record)).ok()?;
    let search = Search { record, parameters: &parameters, beside: &beside };
    let each = search.of_each()?;
    let all = search.of_all()?;
    let longest = INSIDE * LONGEST_S * record.rate_hz;
    let everyone: Vec<usize> = (0..record.coordinates()).collect();
    let of_all = is_certain(&all, 0, longest) && everyone.iter().all(|&j| agrees(&each, j, all.steps[0]));
    let certain: Vec<usize> = everyone.iter().copied().filter(|&j| is_certain(&each, j, longest)).collect();
    let (lags, joints) = if of_all { (&all, everyone) } else { (&each, certain) };
    let before = search.joint_squares(&beside.residual);
    let sum = |squares: &[f64]| joints.iter().map(|&j| squares[j]).sum::<f64>();
    let (was, is) = (sum(&before), sum(&lags.squares));
    let steps = joints.iter().map(|&j| lags.steps[j]).sum::<f64>() / joints.len().max(1) as f64;
    let one = joints.iter().all(|&j| agrees(lags, j, steps));
    let rows = (joints.len() * record.rows()) as f64;
    Some(Delay {
        deviation: joints.iter().map(|&j| lags.deviation[j]).fold(0.0, f64::max),
        explained: 100.0 * (1.0 - is / was),
        effect: 100.0 * ((was - is).max(0.0) / rows).sqrt(),
        samples_per_step: record.subject.sample_rate_hz / record.rate_hz,
        rate: record.subject.sample_rate_hz,
        joints: if one { joints } else { Vec::new() },
        of_all,
        steps,
    })
}

/// Whether a lag differs from zero and is inside the range of the search.
fn is_certain(lags: &Lags, j: usize, longest: f64) -> bool {
    lags.steps[j].abs() > SURE * lags.deviation[j] && lags.steps[j].abs() < longest
}

/// Whether a joint may have this lag.
fn agrees(lags: &Lags, j: usize, steps: f64) -> bool {
    (lags.steps[j] - steps).abs() < (SAME_DEVIATIONS * lags.deviation[j]).max(SAME_PART * steps.abs())
}

impl Delay {
    fn samples(&self) -> f64 {
        self.samples_per_step * self.steps
    }

    fn evidence(&self, coordinate: Option<usize>, value: f64) -> Evidence {
        Evidence { code: Code::Lag, coordinate, value, unit: "times the limits", limit: 1.0 }
    }

    /// Raises it joint by joint, or once for all; whether the record is to be put right.
    fn raise(&self, exam: &mut Examination<'_>) -> bool {
        let strength = (self.explained / EXPLAINED_LIMIT_PERCENT).min(self.effect / EFFECT_LIMIT_PERCENT);
        let matters = strength > 1.0 && self.samples().abs() >= ONE_SAMPLE;
        let severity = if matters { Severity::Warning } else { Severity::Note };
        let whose: Vec<Option<usize>> =
            if self.of_all { vec![None] } else { self.joints.iter().map(|j| Some(*j)).collect() };
        for coordinate in whose {
            let evidence = self.evidence(coordinate, strength);
            exam.note_measure(evidence);
            let worth_telling = if self.of_all { self.explained > NOTE_PERCENT } else { matters };
            if worth_telling {
                let evidence = Evidence { value: self.samples(), unit: "samples", limit: f64::NAN, ..evidence };
                let words = self.words(coordinate.map(|c| exam.subject.joint_number(c)), exam.subject.controller.is_some());
                exam.raise(evidence, severity, words);
            }
        }
        matters
    }

    fn words(&self, joint_number: Option<usize>, controlled: bool) -> Words {
        let ms = |steps: f64| 1e3 * self.samples_per_step * steps / self.rate;
        let (size, order) = (self.samples().abs(), if self.steps > 0.0 { "later" } else { "earlier" });
        let whose = joint_number
            .map_or_else(|| "the torques are".to_owned(), |number| format!("joint {number}: the torque is"));
        let message = format!(
            "{whose} {size:.1} samples ({:.2} ms, +- {:.2}) {order} than the position; without that the squared \
             residual is {:.0} % smaller",
            ms(self.steps.abs()),
            ms(self.deviation),
            self.explained
        );
        let also = if controlled { ", and state the delay of [controller]" } else { "" };
        let remedy = if size < ONE_SAMPLE {
            "nothing to do: a drive signal that is held from sample to sample is half a sample early".to_owned()
        } else {
            format!("shift the torque against the position before the estimate{also}")
        };
        Words::new(message, remedy)
    }
}
