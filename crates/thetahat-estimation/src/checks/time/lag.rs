//! Lag between torque and position.
//!
//! A torque that is late by `d` is `y(t) = y0(t - d)`, so the residual of the fit follows the derivative of the predicted
//! torque. A search over whole steps starts Gauss-Newton, which shifts the torques until that part of the residual is
//! gone. Friction that reverses later than the motion looks like a lag. The fit therefore has the columns of
//! [`friction_shapes`](crate::checks::fit::friction_shapes) in addition to the parameters and leaves out the rows around reversals, so that
//! inertia and gravity decide. Their lag must be one delay, of all joints or of a few that agree, and reduce the residual of
//! the fit of the parameters alone: different lags of different joints are an error of the model.

use super::lag_search::{LONGEST_S, LagSearch, Lags, shifted};
use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::{friction_shapes::rows_of_reversals, orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
    remedy_step::RemedyStep,
    subject::Subject,
};
use thetahat_ground::linear_algebra::Matrix;

/// Part of the squared residual that a lag must explain, percent. The clean recordings stay below 18.
const EXPLAINED_LIMIT_PERCENT: f64 = 25.0;
/// Rms torque that it must explain, percent of the torque's standard deviation.
const EFFECT_LIMIT_PERCENT: f64 = 5.0;
/// Part of the squared residual above which a lag matters even if its torque is small, percent: it is most of the residual,
/// and estimates are off by several standard deviations.
const MOST_OF_RESIDUAL_PERCENT: f64 = 50.0;
/// Part of the squared residual above which a common lag is noted, percent.
const NOTE_PERCENT: f64 = 5.0;
/// Relative error of the fit with the friction shapes, percent, above which more than friction and a lag is wrong.
const POOR_PERCENT: f64 = 20.0;
/// Standard deviations, from ten blocks of time, by which a lag must differ from zero.
const SIGNIFICANT: f64 = 6.0;
/// Standard deviations, and part of the lag, within which lags of joints count as equal.
const SAME_DEVIATIONS: f64 = 4.0;
const SAME_PART: f64 = 0.35;
/// Lag in samples below which it is only noted.
const ONE_SAMPLE: f64 = 1.0;
/// Lag in samples of torques that are held until the next sample, and the range in which its estimate lies: friction without a
/// column changes the estimate by up to 0.2 samples on twins with a known delay, by 0.3 on the EMPS.
const HELD: f64 = -0.5;
const MEASURED_HELD: std::ops::RangeInclusive<f64> = -0.85..=-0.25;
/// Samples by which the lag of a joint may differ from that, so that it is nearer to half a sample than to zero.
const JOINT_HELD_WITHIN: f64 = 0.25;
/// Largest part of the information on a common lag that joints with another lag may have.
const DISAGREEING: f64 = 0.2;
/// Standard deviation of a joint's friction, relative to that of the rest of its torque, above which friction explains a lag of
/// this joint alone.
const MOST_FRICTION: f64 = 1.3;
/// Factor by which the lag of a joint, per friction, must exceed that of every joint with more friction.
const STANDS_OUT: f64 = 2.0;
/// Part of the search range beyond which an optimum is ignored: the search ended at its limit.
const INSIDE: f64 = 0.95;

/// Corrects the lags that the fit with the friction shapes finds in the recording.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &mut ThinnedRecording<'_>, shapes: &Matrix) {
    let Some(delays) = measured(recording, shapes) else { return };
    if delays.is_empty() {
        exam.note_measure(evidence(None, 0.0));
    }
    let mut correction = vec![0.0; recording.coordinates()];
    for delay in &delays {
        if delay.raise(exam) {
            delay.joints.iter().for_each(|&j| correction[j] = delay.steps);
        }
    }
    if correction.iter().any(|s| *s != 0.0) {
        recording.replace_torque(shifted(&recording.torque, &correction));
    }
}

/// The delay of all joints, or the delays of single joints; `None` if the recording does not determine them.
fn measured(recording: &ThinnedRecording<'_>, shapes: &Matrix) -> Option<Vec<Delay>> {
    let parameters = recording.fit().ok()?;
    let with_shapes = recording.fit_with_columns(shapes, &rows_of_reversals(recording)).ok()?;
    if 100.0 * with_shapes.relative_error() > POOR_PERCENT {
        return None;
    }
    let search = LagSearch { recording, parameters: &parameters, with_shapes: &with_shapes };
    let (each, all) = (search.lag_of_each_joint()?, search.common_lag()?);
    let is_significant = |lags: &Lags, j: usize| {
        let size = lags.steps[j].abs();
        size > SIGNIFICANT * lags.deviation[j] && size < INSIDE * LONGEST_S * recording.rate_hz
    };
    let joints = 0..recording.coordinates();
    let friction = recording.friction_share(&parameters.theta());
    let common = Delay::new(&search, joints.clone().collect(), &all);
    let is_one = |j: usize| same(each.steps[j], each.deviation[j], all.steps[0]);
    let is_half = |j: usize| {
        let from_half = (each.steps[j] * common.samples_per_step - HELD).abs();
        from_half < (SAME_DEVIATIONS * each.deviation[j] * common.samples_per_step).max(JOINT_HELD_WITHIN)
    };
    let may_be_held = common.is_held(recording.subject) && agree(&each, &friction, is_half);
    if is_significant(&all, 0) && (may_be_held || agree(&each, &friction, is_one)) {
        return Some(vec![common]);
    }
    let significant = joints.filter(|&j| is_significant(&each, j) && stands_out(&each, &friction, j));
    let significant = significant.map(|j| Delay::new(&search, vec![j], &each));
    let late: Vec<Delay> = significant.filter(|delay| delay.explained.strength() > 1.0).collect();
    let is_one = late.iter().all(|delay| same(delay.steps, delay.deviation, late[0].steps));
    Some(if is_one { late } else { Vec::new() })
}

/// Whether the joints with information on the lag have a certain lag. Friction, relative to the rest of the torque, reduces the
/// information of a joint: friction that no column describes looks like a lag.
fn agree(each: &Lags, friction: &[f64], has_it: impl Fn(usize) -> bool) -> bool {
    let information = |j: usize| 1.0 / (each.deviation[j].powi(2) * (1.0 + friction[j].powi(2))).max(f64::MIN_POSITIVE);
    let joints = 0..each.steps.len();
    let others = joints.clone().filter(|&j| !has_it(j)).map(information).sum::<f64>();
    others <= DISAGREEING * joints.map(information).sum::<f64>()
}

/// Whether the lag of a joint is larger than its friction explains, judged by the joints with more friction.
fn stands_out(each: &Lags, friction: &[f64], j: usize) -> bool {
    let others = (0..friction.len()).filter(|&i| friction[i] > friction[j] && each.deviation[i].is_finite());
    let per_friction = others.map(|i| each.steps[i].abs() / friction[i]).fold(0.0, f64::max);
    friction[j] < MOST_FRICTION && each.steps[j].abs() > STANDS_OUT * friction[j] * per_friction
}

/// Whether a lag equals `steps` within its uncertainty.
fn same(lag: f64, deviation: f64, steps: f64) -> bool {
    (lag - steps).abs() < (SAME_DEVIATIONS * deviation).max(SAME_PART * steps.abs())
}

fn evidence(coordinate: Option<usize>, value: f64) -> Evidence {
    Evidence { code: Code::Lag, coordinate, value, unit: "times the limits", limit: 1.0 }
}

/// The part of the torques that a delay explains.
#[derive(Debug, Clone, Copy)]
struct Explained {
    /// Part of the squared residual, percent.
    residual: f64,
    /// Rms torque, percent of the torques' standard deviation.
    torque: f64,
}

impl Explained {
    /// The larger of two: the smaller of both parts relative to their limits, and the residual relative to the limit for it alone.
    fn strength(self) -> f64 {
        let both = (self.residual / EXPLAINED_LIMIT_PERCENT).min(self.torque / EFFECT_LIMIT_PERCENT);
        both.max(self.residual / MOST_OF_RESIDUAL_PERCENT)
    }
}

/// The delay of one torque or of all.
struct Delay {
    joints: Vec<usize>,
    /// Steps of the thinned recording by which they are late, and the standard deviation.
    steps: f64,
    deviation: f64,
    explained: Explained,
    is_common: bool,
    samples_per_step: f64,
    rate: f64,
}

impl Delay {
    fn new(search: &LagSearch<'_, '_>, joints: Vec<usize>, lags: &Lags) -> Self {
        let recording = search.recording;
        let steps = lags.steps[joints[0]];
        let late = |j: usize| if joints.contains(&j) { steps } else { 0.0 };
        let correction: Vec<f64> = (0..recording.coordinates()).map(late).collect();
        let corrected = recording.stack(&shifted(&recording.torque, &correction));
        let squares = |rest: &[f64]| -> f64 {
            let each = search.joint_squares(rest);
            joints.iter().map(|&j| each[j]).sum()
        };
        let rows = (joints.len() * recording.rows()) as f64;
        let is_common = joints.len() == recording.coordinates();
        let evidence = |fit: &OrthogonalFit| {
            let (before, after) = (squares(&fit.residual), squares(&fit.unexplained(&corrected)));
            Explained {
                residual: 100.0 * (1.0 - after / before),
                torque: 100.0 * ((before - after).max(0.0) / rows).sqrt(),
            }
        };
        // Friction that the model does not have can hide a delay of all joints from the plain fit.
        let (plain, with_shapes) = (evidence(search.parameters), evidence(search.with_shapes));
        let explained = if is_common && with_shapes.strength() > plain.strength() { with_shapes } else { plain };
        Self {
            steps,
            deviation: lags.deviation[joints[0]],
            explained,
            is_common,
            samples_per_step: recording.subject.sample_rate_hz / recording.rate_hz,
            rate: recording.subject.sample_rate_hz,
            joints,
        }
    }

    fn samples(&self) -> f64 {
        self.samples_per_step * self.steps
    }

    /// Raises a finding; returns whether the recording needs a correction.
    fn raise(&self, exam: &mut Examination<'_>) -> bool {
        let matters = self.explained.strength() > 1.0 && self.samples().abs() >= ONE_SAMPLE;
        let is_held = self.is_held(exam.subject);
        let coordinate = (!self.is_common).then_some(self.joints[0]);
        let evidence = evidence(coordinate, self.explained.strength());
        exam.note_measure(evidence);
        if matters || is_held || self.explained.residual > NOTE_PERCENT {
            let severity = if matters || is_held { Severity::Warning } else { Severity::Note };
            let evidence = Evidence { value: self.samples(), unit: "samples", limit: f64::NAN, ..evidence };
            let number = coordinate.map(|c| exam.subject.joint_number(c));
            let text = self.finding_text(number, exam.subject);
            exam.raise(evidence, severity, text);
        }
        matters
    }

    /// Whether it is the delay of torques that are held until the next sample, without this being stated.
    fn is_held(&self, subject: &Subject<'_>) -> bool {
        self.is_common && subject.held_part_of_step == 0.0 && MEASURED_HELD.contains(&self.samples())
    }

    /// The delay to state.
    fn step(&self, subject: &Subject<'_>) -> RemedyStep {
        if self.is_held(subject) {
            return RemedyStep::Hold;
        }
        let delay_s = (1e6 * self.samples() / self.rate).round() / 1e6;
        let joints = if self.is_common { Vec::new() } else { self.joints.iter().map(|j| j + 1).collect() };
        RemedyStep::Delay { delay_s, joints }
    }

    fn finding_text(&self, joint_number: Option<usize>, subject: &Subject<'_>) -> FindingText {
        let ms = |steps: f64| 1e3 * self.samples_per_step * steps / self.rate;
        let (size, order) = (self.samples().abs(), if self.steps > 0.0 { "later" } else { "earlier" });
        let whose = joint_number
            .map_or_else(|| "the torques are".to_owned(), |number| format!("joint {number}: the torque is"));
        let message = format!(
            "{whose} {size:.1} samples ({:.2} ± {:.2} ms) {order} than the position; without this lag the squared \
             residual is {:.0} % smaller",
            ms(self.steps.abs()),
            ms(self.deviation),
            self.explained.residual
        );
        let also = if subject.controller.is_some() { ", and state the delay of [controller]" } else { "" };
        let remedy = if self.is_held(subject) {
            "if the torque is a drive signal that the controller holds until its next sample, set held = true next to its \
             columns, which corrects half a sample"
                .to_owned()
        } else if size < ONE_SAMPLE {
            "nothing to do: it is less than a sample".to_owned()
        } else {
            let delay_s = self.samples() / self.rate;
            format!("state the delay of the torque: delay_s = {delay_s:.5} next to its columns{also}")
        };
        FindingText::new(message, remedy).with_step(self.step(subject))
    }
}
