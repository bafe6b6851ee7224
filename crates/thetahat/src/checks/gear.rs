//! Gear ratios, and scales of positions and torques, that are wrong by some percent.
//!
//! A scale of a joint's motion changes the coupling with the other joints and gravity, which the parameters cannot make
//! up for. Where a robot's joints are recorded as they are, without gears, nothing is converted and nothing is looked
//! for: errors of the model move such scales as much as errors of the record do.

use super::{
    Code, Severity,
    affine::Affine,
    chain::{Chain, Motion, at},
    examination::{Evidence, Examination},
    regression::Regression,
};
use crate::linear_algebra::dot;

/// Standard deviations by which a scale must differ from one.
const SURE: f64 = 6.0;
/// The same with deviations by blocks of time, which hold for residuals that are no white noise.
const SURE_IN_BLOCKS: f64 = 4.0;
/// Smallest error of a scale that counts: modelling errors move the scales of the recorded TX40 by up to 0.13.
const SMALLEST: f64 = 0.05;
/// Rms torque that the right scale must explain, percent of the torques' deviation, with the parameters estimated again.
/// Friction that is not quite a sign gives up to 1.2 on the clean twins.
const EFFECT_LIMIT_PERCENT: f64 = 1.5;
/// Blocks of time.
const BLOCKS: usize = 10;
/// Relative step of the difference quotient.
const STEP: f64 = 0.02;
/// Steps of Gauss-Newton.
const ITERATIONS: usize = 4;
/// Range of scales.
const RANGE: std::ops::RangeInclusive<f64> = 0.2..=5.0;
/// Scales that are looked for one after the other.
const MOST_FAULTS: usize = 3;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Ratio,
    Position,
    Torque,
}

/// A scale of one motor or joint.
#[derive(Debug, Clone, Copy)]
struct Scale {
    joint: usize,
    kind: Kind,
}

/// How far a scale is from one, by one step of Gauss-Newton.
struct Estimate {
    change: f64,
    sure: f64,
    sure_in_blocks: f64,
}

/// A scale with what it leaves of the squared residual.
struct Found {
    scale: Scale,
    factor: f64,
    squares: f64,
    /// Rms torque that it explains, percent of the torques' deviation.
    effect: f64,
}

pub(super) fn check(exam: &mut Examination<'_>, chain: &mut Chain<'_>) {
    let geared: Vec<usize> = (0..chain.joints()).filter(|&j| ratio(chain, j).abs() != 1.0).collect();
    if chain.joints() == 1 || !exam.subject.geared {
        return;
    }
    for round in 0..MOST_FAULTS {
        let Ok(regression) = chain.regression() else { return };
        let theta = regression.theta();
        let found: Vec<Found> =
            geared.iter().filter_map(|&joint| best_of_joint(chain, &regression, &theta, joint)).collect();
        if round == 0 {
            note_measures(exam, &geared, &found);
        }
        let best = found.into_iter().min_by(|a, b| a.squares.total_cmp(&b.squares));
        let Some(best) = best.filter(|b| b.effect > EFFECT_LIMIT_PERCENT) else { return };
        raise(exam, chain, &best, best.squares / regression.squares);
        let Some(correction) = best.scale.correction(chain, best.factor) else { return };
        chain.correct(&correction);
    }
}

fn note_measures(exam: &mut Examination<'_>, geared: &[usize], found: &[Found]) {
    for &joint in geared {
        let own = found.iter().find(|f| f.scale.joint == joint);
        exam.note_measure(evidence(joint, own.map_or(0.0, |f| f.effect)));
    }
}

/// The scale of a joint or its motor that explains most, of those that are certain and large enough to matter.
fn best_of_joint(chain: &Chain<'_>, regression: &Regression, theta: &[f64], joint: usize) -> Option<Found> {
    let kinds = [Kind::Ratio, Kind::Position, Kind::Torque].into_iter();
    let found = kinds.filter_map(|kind| {
        let scale = Scale { joint, kind };
        let estimate = estimate(chain, regression, theta, scale).filter(Estimate::is_certain)?;
        let (factor, squares) = refined(chain, scale, 1.0 + estimate.change);
        let effect = 100.0 * ((regression.squares - squares).max(0.0) / regression.y.len() as f64).sqrt();
        ((factor - 1.0).abs() > SMALLEST).then_some(Found { scale, factor, squares, effect })
    });
    found.min_by(|a, b| a.squares.total_cmp(&b.squares))
}

fn ratio(chain: &Chain<'_>, j: usize) -> f64 {
    chain.subject.robot.transmission.matrix().at(j, j)
}

fn evidence(joint: usize, value: f64) -> Evidence {
    let (unit, limit) = ("% of the torques", EFFECT_LIMIT_PERCENT);
    Evidence { code: Code::GearRatio, joint: Some(joint), value, unit, limit }
}

fn raise(exam: &mut Examination<'_>, chain: &Chain<'_>, found: &Found, left: f64) {
    let Found { scale: Scale { joint, kind }, factor, .. } = *found;
    let number = joint + 1;
    let what = match kind {
        Kind::Ratio => {
            format!(
                "the gear ratio of motor {number} is {:.4}, not {:.4}",
                factor * ratio(chain, joint),
                ratio(chain, joint)
            )
        }
        Kind::Position => format!("the position of joint {number} is {factor:.4} times what was recorded"),
        Kind::Torque => format!("the torque of joint {number} is {factor:.4} times what was recorded"),
    };
    let words = (
        format!("the squared residual is {:.0} % smaller if {what}", 100.0 * (1.0 - left)),
        "check the motor's row of [transmission] matrix, its drive gain, and the gains of the channels".to_owned(),
    );
    let value = 100.0 * (factor - 1.0);
    let evidence = Evidence { value, unit: "% of the scale", limit: f64::NAN, ..evidence(joint, value) };
    exam.raise(evidence, Severity::Problem, words, Vec::new());
}

impl Scale {
    fn correction(self, chain: &Chain<'_>, factor: f64) -> Option<Affine> {
        let robot = chain.subject.robot;
        let factors: Vec<f64> = (0..chain.joints()).map(|j| if j == self.joint { factor } else { 1.0 }).collect();
        match self.kind {
            Kind::Ratio => Affine::geared(robot, &factors),
            Kind::Position => Some(Affine::scaled_positions(&factors, robot.transmission.offset())),
            Kind::Torque => Some(Affine::scaled_torques(&factors)),
        }
    }
}

impl Estimate {
    fn is_certain(&self) -> bool {
        self.sure.abs() > SURE && self.sure_in_blocks.abs() > SURE_IN_BLOCKS && self.change.abs() > SMALLEST
    }
}

/// One step of Gauss-Newton for a scale; none where it changes nothing that the parameters do not take up.
fn estimate(chain: &Chain<'_>, regression: &Regression, theta: &[f64], scale: Scale) -> Option<Estimate> {
    let direction = regression.unexplained(&direction(chain, theta, scale)?);
    let information = dot(&direction, &direction);
    if information <= f64::EPSILON * dot(&regression.y, &regression.y) {
        return None;
    }
    let change = -dot(&direction, &regression.residual) / information;
    let deviation = (regression.variance() / information).sqrt();
    let rest: Vec<f64> = regression.residual.iter().zip(&direction).map(|(r, d)| r + change * d).collect();
    let in_blocks = block_deviation(&direction, &rest, chain.rows()) / information;
    Some(Estimate { change, sure: change / deviation, sure_in_blocks: change / in_blocks })
}

/// The derivative of `tau' - X' theta` by the scale, with the predicted torque in the place of the measured one.
fn direction(chain: &Chain<'_>, theta: &[f64], scale: Scale) -> Option<Vec<f64>> {
    let Motion { q, dq, ddq } = &chain.motion;
    let motion = Motion { q: at(q, &chain.kept), dq: at(dq, &chain.kept), ddq: at(ddq, &chain.kept) };
    let torque = chain.predict(&motion, theta);
    let error = |factor: f64| {
        let correction = scale.correction(chain, factor)?;
        let predicted = chain.predict(&correction.motion(&motion), theta);
        let torque = correction.torque(&torque);
        let rows = (0..chain.joints()).flat_map(|j| torque.channel(j).into_iter().zip(predicted.channel(j)));
        Some(rows.map(|(t, p)| t - p).collect::<Vec<f64>>())
    };
    let (more, less) = (error(1.0 + STEP)?, error(1.0 - STEP)?);
    Some(more.iter().zip(&less).map(|(m, l)| (m - l) / (2.0 * STEP)).collect())
}

/// Root of the sum over blocks of time of the squared score.
fn block_deviation(direction: &[f64], rest: &[f64], rows: usize) -> f64 {
    let mut score = [0.0; BLOCKS];
    for (i, (d, r)) in direction.iter().zip(rest).enumerate() {
        score[(i % rows) * BLOCKS / rows] += d * r;
    }
    dot(&score, &score).sqrt()
}

/// The scale by further steps of Gauss-Newton, and the squared residual that it leaves.
fn refined(chain: &Chain<'_>, scale: Scale, first: f64) -> (f64, f64) {
    let mut best = (1.0, f64::INFINITY);
    let mut factor = first;
    for _ in 0..ITERATIONS {
        if !RANGE.contains(&factor) {
            break;
        }
        let Some(correction) = scale.correction(chain, factor) else { break };
        let corrected = chain.corrected(&correction);
        let Ok(regression) = corrected.regression() else { break };
        if regression.squares < best.1 {
            best = (factor, regression.squares);
        }
        let Some(next) = estimate(&corrected, &regression, &regression.theta(), scale) else { break };
        factor *= 1.0 + next.change;
    }
    best
}
