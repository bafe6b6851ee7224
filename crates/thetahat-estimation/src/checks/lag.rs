//! Lag between torque and position.
//!
//! A torque that is late by `d` is `y(t) = y0(t - d)`, so the residual of the fit follows the derivative of the predicted
//! torque. A search over whole steps starts Gauss-Newton, which shifts the torques until that part of the residual is
//! gone. Friction that turns around later than the motion looks like a lag: the columns of
//! [`friction_shapes`](super::friction_shapes) are free
//! beside the parameters, and the rows around its reversals are left out, so that inertia and gravity decide. Their lag
//! must be one delay, of all joints or of a few that agree, and make the residual of the fit itself smaller: joints that
//! each have a lag of their own are an error of the model.

use super::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    friction_shapes::rows_of_reversals,
    lag_search::{LONGEST_S, LagSearch, Lags, shifted},
    orthogonal_fit::OrthogonalFit,
    subject::Subject,
    thinned_recording::ThinnedRecording,
};
use thetahat_ground::linear_algebra::Matrix;

/// Part of the squared residual that a lag must explain, percent. The clean recordings stay below 18.
const EXPLAINED_LIMIT_PERCENT: f64 = 25.0;
/// Rms torque that it must explain, percent of the torque's deviation.
const EFFECT_LIMIT_PERCENT: f64 = 5.0;
/// Part of the squared residual from which a lag matters however small the torque is, percent: it is most of what the model
/// leaves, and estimates are off by several of their deviations.
const MOST_OF_RESIDUAL_PERCENT: f64 = 50.0;
/// Part of the squared residual from which a common lag is worth a note, percent.
const NOTE_PERCENT: f64 = 5.0;
/// Relative error of the fit beside the friction shapes, percent, from which something else than friction and a lag is wrong.
const POOR_PERCENT: f64 = 20.0;
/// Standard deviations by which a lag must differ from zero: they come from ten blocks of time.
const SURE: f64 = 6.0;
/// Standard deviations within which lags of joints are the same, and part of the lag.
const SAME_DEVIATIONS: f64 = 4.0;
const SAME_PART: f64 = 0.35;
/// Lag in samples below which it is noted only.
const ONE_SAMPLE: f64 = 1.0;
/// Lag in samples of torques that hold until the next sample, and what of it is measured: on twins whose delay is known,
/// friction without a column makes up to 0.2 samples, on the EMPS 0.3.
const HELD: f64 = -0.5;
const MEASURED_HELD: std::ops::RangeInclusive<f64> = -0.85..=-0.25;
/// Samples by which the lag of a joint may differ: it is nearer to half a sample than to none.
const JOINT_HELD_WITHIN: f64 = 0.25;
/// Part of the information of a common lag that joints with another lag may hold.
const DISAGREEING: f64 = 0.2;
/// Deviation of a joint's friction, relative to that of the rest of its torque, from which a lag of the joint alone is one of
/// friction.
const MOST_FRICTION: f64 = 1.3;
/// How many times more the lag of a joint must be, for the friction that it has, than that of any joint with more friction.
const STANDS_OUT: f64 = 2.0;
/// Part of the range of the search beyond which an optimum is no measurement: the search ended there.
const INSIDE: f64 = 0.95;

/// Corrects the record by the lags that are found beside the shapes of friction.
pub(super) fn check(exam: &mut Examination<'_>, recording: &mut ThinnedRecording<'_>, shapes: &Matrix) {
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

/// The delay of all joints, or those of the joints that are late; none where the record does not tell.
fn measured(recording: &ThinnedRecording<'_>, shapes: &Matrix) -> Option<Vec<Delay>> {
    let parameters = recording.fit().ok()?;
    let beside = recording.fit_beside(shapes, &rows_of_reversals(recording)).ok()?;
    if 100.0 * beside.relative_error() > POOR_PERCENT {
        return None;
    }
    let search = LagSearch { recording, parameters: &parameters, beside: &beside };
    let (each, all) = (search.of_each()?, search.of_all()?);
    let is_certain = |lags: &Lags, j: usize| {
        let size = lags.steps[j].abs();
        size > SURE * lags.deviation[j] && size < INSIDE * LONGEST_S * recording.rate_hz
    };
    let joints = 0..recording.coordinates();
    let friction = recording.friction_share(&parameters.theta());
    let common = Delay::new(&search, joints.clone().collect(), &all);
    let is_one = |j: usize| same(each.steps[j], each.deviation[j], all.steps[0]);
    let is_half = |j: usize| {
        let from_half = (each.steps[j] * common.samples_per_step - HELD).abs();
        from_half < (SAME_DEVIATIONS * each.deviation[j] * common.samples_per_step).max(JOINT_HELD_WITHIN)
    };
    let may_hold = common.is_held(recording.subject) && agree(&each, &friction, is_half);
    if is_certain(&all, 0) && (may_hold || agree(&each, &friction, is_one)) {
        return Some(vec![common]);
    }
    let certain = joints.filter(|&j| is_certain(&each, j) && stands_out(&each, &friction, j));
    let certain = certain.map(|j| Delay::new(&search, vec![j], &each));
    let late: Vec<Delay> = certain.filter(|delay| delay.explained.strength() > 1.0).collect();
    let is_one = late.iter().all(|delay| same(delay.steps, delay.deviation, late[0].steps));
    Some(if is_one { late } else { Vec::new() })
}

/// Whether the joints that tell something of the lag have the one that is asked for. What a joint tells is less by its
/// friction, relative to the rest of its torque: friction of a law that no column has looks like a lag.
fn agree(each: &Lags, friction: &[f64], has_it: impl Fn(usize) -> bool) -> bool {
    let information = |j: usize| 1.0 / (each.deviation[j].powi(2) * (1.0 + friction[j].powi(2))).max(f64::MIN_POSITIVE);
    let joints = 0..each.steps.len();
    let others = joints.clone().filter(|&j| !has_it(j)).map(information).sum::<f64>();
    others <= DISAGREEING * joints.map(information).sum::<f64>()
}

/// Whether the lag of a joint is more than its friction can be thought to make, by what it makes of joints that have more.
fn stands_out(each: &Lags, friction: &[f64], j: usize) -> bool {
    let others = (0..friction.len()).filter(|&i| friction[i] > friction[j] && each.deviation[i].is_finite());
    let by_friction = others.map(|i| each.steps[i].abs() / friction[i]).fold(0.0, f64::max);
    friction[j] < MOST_FRICTION && each.steps[j].abs() > STANDS_OUT * friction[j] * by_friction
}

/// Whether a lag may be this one.
fn same(lag: f64, deviation: f64, steps: f64) -> bool {
    (lag - steps).abs() < (SAME_DEVIATIONS * deviation).max(SAME_PART * steps.abs())
}

fn evidence(coordinate: Option<usize>, value: f64) -> Evidence {
    Evidence { code: Code::Lag, coordinate, value, unit: "times the limits", limit: 1.0 }
}

/// What a delay explains.
#[derive(Debug, Clone, Copy)]
struct Explained {
    /// Part of the squared residual, percent.
    residual: f64,
    /// Rms torque, percent of the torques' deviation.
    torque: f64,
}

impl Explained {
    /// The smaller of its two parts of their limits, or the part of the residual's own limit if that is larger.
    fn strength(self) -> f64 {
        let both = (self.residual / EXPLAINED_LIMIT_PERCENT).min(self.torque / EFFECT_LIMIT_PERCENT);
        both.max(self.residual / MOST_OF_RESIDUAL_PERCENT)
    }
}

/// The delay of one torque or of all.
struct Delay {
    joints: Vec<usize>,
    /// Steps of the record by which they are late, and the standard deviation.
    steps: f64,
    deviation: f64,
    explained: Explained,
    of_all: bool,
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
        let of_all = joints.len() == recording.coordinates();
        let evidence = |fit: &OrthogonalFit| {
            let (was, is) = (squares(&fit.residual), squares(&fit.unexplained(&corrected)));
            Explained { residual: 100.0 * (1.0 - is / was), torque: 100.0 * ((was - is).max(0.0) / rows).sqrt() }
        };
        // Friction that the model does not have can hide a delay of all joints from the plain fit.
        let (plain, beside) = (evidence(search.parameters), evidence(search.beside));
        let explained = if of_all && beside.strength() > plain.strength() { beside } else { plain };
        Self {
            steps,
            deviation: lags.deviation[joints[0]],
            explained,
            of_all,
            samples_per_step: recording.subject.sample_rate_hz / recording.rate_hz,
            rate: recording.subject.sample_rate_hz,
            joints,
        }
    }

    fn samples(&self) -> f64 {
        self.samples_per_step * self.steps
    }

    /// Raises it; whether the record is to be put right.
    fn raise(&self, exam: &mut Examination<'_>) -> bool {
        let matters = self.explained.strength() > 1.0 && self.samples().abs() >= ONE_SAMPLE;
        let is_held = self.is_held(exam.subject);
        let coordinate = (!self.of_all).then_some(self.joints[0]);
        let evidence = evidence(coordinate, self.explained.strength());
        exam.note_measure(evidence);
        if matters || is_held || self.explained.residual > NOTE_PERCENT {
            let severity = if matters || is_held { Severity::Warning } else { Severity::Note };
            let evidence = Evidence { value: self.samples(), unit: "samples", limit: f64::NAN, ..evidence };
            let number = coordinate.map(|c| exam.subject.joint_number(c));
            let words = self.words(number, exam.subject);
            exam.raise(evidence, severity, words);
        }
        matters
    }

    /// Whether it is that of torques that hold until the next sample, and nothing says that they do.
    fn is_held(&self, subject: &Subject<'_>) -> bool {
        self.of_all && subject.held_part_of_step == 0.0 && MEASURED_HELD.contains(&self.samples())
    }

    fn words(&self, joint_number: Option<usize>, subject: &Subject<'_>) -> FindingText {
        let ms = |steps: f64| 1e3 * self.samples_per_step * steps / self.rate;
        let (size, order) = (self.samples().abs(), if self.steps > 0.0 { "later" } else { "earlier" });
        let whose = joint_number
            .map_or_else(|| "the torques are".to_owned(), |number| format!("joint {number}: the torque is"));
        let message = format!(
            "{whose} {size:.1} samples ({:.2} ± {:.2} ms) {order} than the position; without that the squared \
             residual is {:.0} % smaller",
            ms(self.steps.abs()),
            ms(self.deviation),
            self.explained.residual
        );
        let also = if subject.controller.is_some() { ", and state the delay of [controller]" } else { "" };
        let remedy = if self.is_held(subject) {
            "if the torque is a drive signal that the controller holds until its next sample, say so by held = true \
             beside its columns, which takes half a sample off"
                .to_owned()
        } else if size < ONE_SAMPLE {
            "nothing to do: it is less than a sample".to_owned()
        } else {
            let delay_s = self.samples() / self.rate;
            format!("say how late the torque is: delay_s = {delay_s:.5} beside its columns{also}")
        };
        FindingText::new(message, remedy)
    }
}
