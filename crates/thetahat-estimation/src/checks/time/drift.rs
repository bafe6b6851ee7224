//! Torques whose scale or friction drifts over the recording.
//!
//! The fit explains the mean over the recording. The drift is the coefficient of a joint's predicted torque, or its predicted
//! friction, times a ramp of time, in a regression of the residual.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::{orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
};
use thetahat_ground::linear_algebra::{Matrix, dot};

/// Drift of a torque's scale over the recording that counts, percent.
const GAIN_LIMIT_PERCENT: f64 = 5.0;
/// Drift of a joint's friction over the recording that counts, percent.
const FRICTION_LIMIT_PERCENT: f64 = 12.0;
/// Standard deviations, from blocks of time, by which the drift of a scale must differ from zero. Clean: the recorded TX40 has 4
/// at its first joint (-7 %), all others 3 or less.
const SIGNIFICANT_GAIN: f64 = 5.0;
/// The same for friction: the clean recordings have at most 3.
const SIGNIFICANT_FRICTION: f64 = 4.0;
/// Largest drift, percent: larger ones are physically impossible and occur where the torque has little information.
const PLAUSIBLE_PERCENT: f64 = 70.0;

/// What may drift.
struct Quantity {
    code: Code,
    name: &'static str,
    /// Limit of the drift over the recording, percent.
    limit_percent: f64,
    /// Standard deviations, from blocks of time, by which the drift must differ from zero.
    significant: f64,
    remedy: &'static str,
}

const GAIN: Quantity = Quantity {
    code: Code::GainDrift,
    name: "scale of the torque",
    limit_percent: GAIN_LIMIT_PERCENT,
    significant: SIGNIFICANT_GAIN,
    remedy: "check whether the drive's gain depends on temperature, and whether a payload was picked up or put down; cut the \
             recording into shorter ones ([signal] window_start_s, window_end_s) and compare their estimates",
};

const FRICTION: Quantity = Quantity {
    code: Code::FrictionDrift,
    name: "friction",
    limit_percent: FRICTION_LIMIT_PERCENT,
    significant: SIGNIFICANT_FRICTION,
    remedy: "warm the joint up before recording, or start later by [signal] window_start_s: the model has one friction for \
             the whole recording",
};

/// Blocks of time, and fewest in which a joint must have information: from fewer no deviation can be estimated, and its ramp is one of a
/// part of the recording (joints that move one after the other).
const BLOCKS: usize = 20;
const FEWEST_BLOCKS: f64 = 5.0;

/// A drift with its standard deviation, both relative.
#[derive(Debug, Clone, Copy)]
struct Drift {
    change: f64,
    deviation: f64,
}

pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) {
    let Ok(fit) = recording.fit() else { return };
    for j in 0..recording.coordinates() {
        let Some([gain, friction]) = drifts(recording, &fit, j) else { continue };
        judge(exam, j, &GAIN, gain);
        judge(exam, j, &FRICTION, friction);
    }
}

fn judge(exam: &mut Examination<'_>, j: usize, quantity: &Quantity, drift: Drift) {
    let Quantity { code, name, limit_percent, significant, remedy } = *quantity;
    let percent = 100.0 * drift.change;
    let is_significant = percent.abs() > significant * 100.0 * drift.deviation && percent.abs() < PLAUSIBLE_PERCENT;
    let value = if is_significant { percent.abs() } else { 0.0 };
    let (unit, limit) = ("% over the recording", limit_percent);
    let number = exam.subject.joint_number(j);
    exam.judge(Evidence { code, coordinate: Some(j), value, unit, limit }, Severity::Warning, || {
        let message = format!(
            "joint {number}: the {name} changes by {percent:+.1} % (± {:.1}) from the start to the end of the recording",
            100.0 * drift.deviation
        );
        FindingText::new(message, remedy)
    });
}

/// The drifts of a joint's gain and friction. The one that explains more is estimated alone, the other together with it.
/// `None` if nothing could drift.
fn drifts(recording: &ThinnedRecording<'_>, fit: &OrthogonalFit, j: usize) -> Option<[Drift; 2]> {
    let theta = fit.theta();
    let friction_alone: Vec<f64> =
        theta.iter().enumerate().map(|(c, v)| if recording.is_friction(c) { *v } else { 0.0 }).collect();
    let directions = [theta, friction_alone].map(|theta| fit.project_out(&ramped(recording, fit, j, &theta)));
    let explained = |d: &Vec<f64>| dot(d, &fit.residual).powi(2) / dot(d, d).max(f64::MIN_POSITIVE);
    let first = usize::from(explained(&directions[1]) > explained(&directions[0]));
    let alone = estimate(recording, &fit.residual, &[&directions[first]])?;
    let both = estimate(recording, &fit.residual, &[&directions[0], &directions[1]]);
    let none = Drift { change: 0.0, deviation: f64::INFINITY };
    let mut drifts = [none; 2];
    drifts[first] = alone[0];
    drifts[1 - first] = both.map_or(none, |both| both[1 - first]);
    for (drift, direction) in drifts.iter_mut().zip(&directions) {
        if informative_blocks(recording.rows(), direction) < FEWEST_BLOCKS {
            *drift = none;
        }
    }
    Some(drifts)
}

/// The changes along directions by least squares, with standard deviations from blocks of time; `None` if the directions are
/// linearly dependent.
fn estimate(recording: &ThinnedRecording<'_>, residual: &[f64], directions: &[&Vec<f64>]) -> Option<Vec<Drift>> {
    let n = directions.len();
    let inverse = Matrix::from_fn(n, n, |a, b| dot(directions[a], directions[b])).inverse()?;
    let change = inverse.times(&directions.iter().map(|d| dot(d, residual)).collect::<Vec<_>>());
    let explained = |i: usize| directions.iter().zip(&change).map(|(d, c)| c * d[i]).sum::<f64>();
    let rest: Vec<f64> = residual.iter().enumerate().map(|(i, r)| r - explained(i)).collect();
    let spread = block_spread(recording, directions, &rest);
    let covariance = inverse.times_matrix(&spread).times_matrix(&inverse);
    let drift = |i: usize| Drift { change: change[i], deviation: covariance.at(i, i).max(0.0).sqrt() };
    change.iter().all(|c| c.is_finite()).then(|| (0..n).map(drift).collect())
}

/// The predicted torque of a joint times a ramp of time from -1/2 to 1/2; zero in the other joints' rows.
fn ramped(recording: &ThinnedRecording<'_>, fit: &OrthogonalFit, j: usize, theta: &[f64]) -> Vec<f64> {
    let rows = recording.rows();
    let mut direction = fit.x.times(theta);
    let ramp = |i: usize| (i % rows) as f64 / (rows - 1).max(1) as f64 - 0.5;
    direction.iter_mut().enumerate().for_each(|(i, v)| *v *= if i / rows == j { ramp(i) } else { 0.0 });
    direction
}

/// Number of blocks of time over which the squares of `direction` are spread: of a block's part p, 1 / sum p^2.
fn informative_blocks(rows: usize, direction: &[f64]) -> f64 {
    let mut squares = [0.0; BLOCKS];
    direction.iter().enumerate().for_each(|(i, d)| squares[(i % rows) * BLOCKS / rows] += d * d);
    squares.iter().sum::<f64>().powi(2) / dot(&squares, &squares)
}

/// The sum over blocks of time of the squared scores.
fn block_spread(recording: &ThinnedRecording<'_>, directions: &[&Vec<f64>], rest: &[f64]) -> Matrix {
    let (rows, n) = (recording.rows(), directions.len());
    let mut scores = vec![vec![0.0; n]; BLOCKS];
    for (i, r) in rest.iter().enumerate() {
        let score = &mut scores[(i % rows) * BLOCKS / rows];
        score.iter_mut().zip(directions).for_each(|(s, d)| *s += d[i] * r);
    }
    Matrix::from_fn(n, n, |a, b| scores.iter().map(|s| s[a] * s[b]).sum())
}

#[cfg(test)]
mod tests {
    use super::{FEWEST_BLOCKS, informative_blocks};

    #[test]
    fn a_joint_that_moves_in_a_sixth_of_the_recording_shows_no_drift() {
        let ramp = |i: usize| i as f64 / 600.0 - 0.5;
        let all: Vec<f64> = (0..600).map(ramp).collect();
        let sixth: Vec<f64> = (0..600).map(|i| if i < 100 { ramp(i) } else { 0.0 }).collect();
        assert!((10.0..12.0).contains(&informative_blocks(600, &all)));
        assert!(informative_blocks(600, &sixth) < FEWEST_BLOCKS);
    }
}
