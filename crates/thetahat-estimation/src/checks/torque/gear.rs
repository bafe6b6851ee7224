//! Gear ratios, and scales of positions and torques, that are wrong by some percent.
//!
//! A wrong scale of a joint's motion changes the coupling with the other joints and gravity, which the parameters cannot
//! compensate. Nothing is checked if the joints are recorded directly, without gears: modelling errors change the estimated
//! scales as much as errors of the recording do.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::{
        affine::Affine,
        orthogonal_fit::OrthogonalFit,
        thinned_recording::{ThinnedRecording, motion_at},
    },
    numbers::block_score,
};
use thetahat_ground::linear_algebra::dot;

/// Standard deviations by which a scale must differ from one.
const SIGNIFICANT: f64 = 6.0;
/// The same with standard deviations from blocks of time, which are valid for residuals that are not white noise.
const SIGNIFICANT_IN_BLOCKS: f64 = 4.0;
/// Smallest error of a scale that counts: modelling errors change the scales of the recorded TX40 by up to 0.13.
const SMALLEST: f64 = 0.05;
/// Rms torque that the right scale must explain, percent of the torques' standard deviation, with the parameters estimated
/// again. Friction that differs from a sign of the velocity gives up to 1.2 on the clean twins.
const EFFECT_LIMIT_PERCENT: f64 = 1.5;
/// Relative step of the difference quotient.
const STEP: f64 = 0.02;
/// Steps of Gauss-Newton.
const ITERATIONS: usize = 4;
/// Range of scales.
const RANGE: std::ops::RangeInclusive<f64> = 0.2..=5.0;
/// Most scales that are corrected one after the other.
const MOST_FAULTS: usize = 3;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Ratio,
    Position,
    Torque,
}

/// A scale of one motor or coordinate.
#[derive(Debug, Clone, Copy)]
struct Scale {
    coordinate: usize,
    kind: Kind,
}

/// The difference of a scale from one, by one step of Gauss-Newton.
struct Estimate {
    change: f64,
    /// The change in standard deviations, for white noise and from blocks of time.
    significance: f64,
    significance_in_blocks: f64,
}

/// A scale and the squared residual with it.
struct GearRatioFit {
    scale: Scale,
    factor: f64,
    squares: f64,
    /// Rms torque that it explains, percent of the torques' standard deviation.
    effect: f64,
}

pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &mut ThinnedRecording<'_>) {
    let geared: Vec<usize> = (0..recording.coordinates()).filter(|&j| ratio(recording, j).abs() != 1.0).collect();
    if recording.coordinates() == 1 || !exam.subject.geared {
        return;
    }
    for round in 0..MOST_FAULTS {
        let Ok(fit) = recording.fit() else { return };
        let theta = fit.theta();
        let found: Vec<GearRatioFit> =
            geared.iter().filter_map(|&j| best_of_coordinate(recording, &fit, &theta, j)).collect();
        if round == 0 {
            note_measures(exam, &geared, &found);
        }
        let best = found.into_iter().min_by(|a, b| a.squares.total_cmp(&b.squares));
        let Some(best) = best.filter(|b| b.effect > EFFECT_LIMIT_PERCENT) else { return };
        raise(exam, recording, &best, best.squares / fit.squares);
        let Some(correction) = best.scale.correction(recording, best.factor) else { return };
        recording.correct(&correction);
    }
}

fn note_measures(exam: &mut Examination<'_>, geared: &[usize], found: &[GearRatioFit]) {
    for &j in geared {
        let own = found.iter().find(|f| f.scale.coordinate == j);
        exam.note_measure(evidence(j, own.map_or(0.0, |f| f.effect)));
    }
}

/// The scale of a coordinate or its motor that explains most, among those that are significant and large enough.
fn best_of_coordinate(
    recording: &ThinnedRecording<'_>,
    fit: &OrthogonalFit,
    theta: &[f64],
    coordinate: usize,
) -> Option<GearRatioFit> {
    let kinds = [Kind::Ratio, Kind::Position, Kind::Torque].into_iter();
    let found = kinds.filter_map(|kind| {
        let scale = Scale { coordinate, kind };
        let estimate = estimate(recording, fit, theta, scale).filter(Estimate::is_significant)?;
        let (factor, squares) = refined(recording, scale, 1.0 + estimate.change);
        let effect = 100.0 * ((fit.squares - squares).max(0.0) / fit.y.len() as f64).sqrt();
        ((factor - 1.0).abs() > SMALLEST).then_some(GearRatioFit { scale, factor, squares, effect })
    });
    found.min_by(|a, b| a.squares.total_cmp(&b.squares))
}

fn ratio(recording: &ThinnedRecording<'_>, j: usize) -> f64 {
    recording.subject.robot.transmission.matrix().at(j, j)
}

fn evidence(coordinate: usize, value: f64) -> Evidence {
    let (unit, limit) = ("% of the torques", EFFECT_LIMIT_PERCENT);
    Evidence { code: Code::GearRatio, coordinate: Some(coordinate), value, unit, limit }
}

fn raise(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>, found: &GearRatioFit, left: f64) {
    let GearRatioFit { scale: Scale { coordinate, kind }, factor, .. } = *found;
    let (motor, joint) = (coordinate + 1, exam.subject.joint_number(coordinate));
    let what = match kind {
        Kind::Ratio => {
            let ratio = ratio(recording, coordinate);
            format!("the gear ratio of motor {motor} is {:.4}, not {ratio:.4}", factor * ratio)
        }
        Kind::Position => format!("the position of joint {joint} is {factor:.4} times the recorded one"),
        Kind::Torque => format!("the torque of joint {joint} is {factor:.4} times the recorded one"),
    };
    let text = FindingText::new(
        format!("the squared residual is {:.0} % smaller if {what}", 100.0 * (1.0 - left)),
        "check the motor's row of [transmission] matrix, its drive gain, and the gains of the channels",
    );
    let value = 100.0 * (factor - 1.0);
    // A simulated loop has the ratio of the description, which no channel changes.
    let is_of_loop = kind == Kind::Ratio && exam.subject.controller.is_some();
    let correction = found.scale.correction(recording, factor).filter(|_| !is_of_loop);
    let text = text.with_step(correction.as_ref().and_then(Affine::step));
    let evidence = Evidence { value, unit: "% of the scale", limit: f64::NAN, ..evidence(coordinate, value) };
    exam.raise(evidence, Severity::Problem, text);
}

impl Scale {
    fn correction(self, recording: &ThinnedRecording<'_>, factor: f64) -> Option<Affine> {
        let robot = recording.subject.robot;
        let factors: Vec<f64> =
            (0..recording.coordinates()).map(|j| if j == self.coordinate { factor } else { 1.0 }).collect();
        match self.kind {
            Kind::Ratio => Affine::geared(robot, &factors),
            Kind::Position => Some(Affine::scaled_positions(&factors, robot.transmission.offset())),
            Kind::Torque => Some(Affine::scaled_torques(&factors)),
        }
    }
}

impl Estimate {
    fn is_significant(&self) -> bool {
        self.significance.abs() > SIGNIFICANT
            && self.significance_in_blocks.abs() > SIGNIFICANT_IN_BLOCKS
            && self.change.abs() > SMALLEST
    }
}

/// One step of Gauss-Newton for a scale; `None` if the parameters compensate every change of it.
fn estimate(recording: &ThinnedRecording<'_>, fit: &OrthogonalFit, theta: &[f64], scale: Scale) -> Option<Estimate> {
    let direction = fit.unexplained(&direction(recording, theta, scale)?);
    let information = dot(&direction, &direction);
    if information <= f64::EPSILON * dot(&fit.y, &fit.y) {
        return None;
    }
    let change = -dot(&direction, &fit.residual) / information;
    let deviation = (fit.variance() / information).sqrt();
    let rest: Vec<f64> = fit.residual.iter().zip(&direction).map(|(r, d)| r + change * d).collect();
    let in_blocks = block_score(&direction, &rest, recording.rows()) / information;
    Some(Estimate { change, significance: change / deviation, significance_in_blocks: change / in_blocks })
}

/// The derivative of `tau' - X' theta` by the scale, with the predicted torque instead of the measured one.
fn direction(recording: &ThinnedRecording<'_>, theta: &[f64], scale: Scale) -> Option<Vec<f64>> {
    let motion = motion_at(&recording.motion, &recording.kept);
    let torque = recording.predict(&motion, theta);
    let error = |factor: f64| {
        let correction = scale.correction(recording, factor)?;
        let predicted = recording.predict(&correction.motion(&motion), theta);
        let torque = correction.torque(&torque);
        let rows = (0..recording.coordinates()).flat_map(|j| torque.channel(j).into_iter().zip(predicted.channel(j)));
        Some(rows.map(|(t, p)| t - p).collect::<Vec<f64>>())
    };
    let (more, less) = (error(1.0 + STEP)?, error(1.0 - STEP)?);
    Some(more.iter().zip(&less).map(|(m, l)| (m - l) / (2.0 * STEP)).collect())
}

/// The scale after further steps of Gauss-Newton, and its squared residual.
fn refined(recording: &ThinnedRecording<'_>, scale: Scale, first: f64) -> (f64, f64) {
    let mut best = (1.0, f64::INFINITY);
    let mut factor = first;
    for _ in 0..ITERATIONS {
        if !RANGE.contains(&factor) {
            break;
        }
        let Some(correction) = scale.correction(recording, factor) else { break };
        let corrected = recording.corrected(&correction);
        let Ok(fit) = corrected.fit() else { break };
        if fit.squares < best.1 {
            best = (factor, fit.squares);
        }
        let Some(next) = estimate(&corrected, &fit, &fit.theta(), scale) else { break };
        factor *= 1.0 + next.change;
    }
    best
}
