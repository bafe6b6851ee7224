//! The errors of predicted torques: all samples, moving, and near rest.

use super::rows::ModelRows;
use crate::run::prepared::PreparedRecording;
use thetahat_report::results::{ModelError, ModelJointError};

/// Velocity below which a joint is near rest where no rule says so, rad/s or m/s.
const NEAR_REST: f64 = 0.04;

/// Velocities over the transition of the friction at which its sign is settled: `tanh(4) = 0.9993`.
const SETTLED: f64 = 4.0;

/// What each row's joint does.
pub(super) struct Speeds {
    near_rest: Vec<bool>,
    /// Whether the sign of its friction is not settled there, or in the row before or after.
    pub(super) turning: Vec<bool>,
}

impl Speeds {
    pub(super) fn new(prepared: &[PreparedRecording], rows: &ModelRows, transition: f64) -> Self {
        let (mut near_rest, mut turning) = (Vec::new(), Vec::new());
        for j in 0..rows.layout.joints() {
            for (p, decimator) in prepared.iter().zip(&rows.decimators) {
                let limit = p.filtered.near_rest.as_ref().map_or(NEAR_REST, |rule| rule.velocity[j]);
                let speeds: Vec<f64> = decimator.kept().map(|k| p.filtered.motion.dq.sample(k)[j].abs()).collect();
                let is_slow = |k: usize| speeds[k] < limit.max(SETTLED * transition);
                near_rest.extend(speeds.iter().map(|speed| *speed < limit));
                let neighbours = |k: usize| k.saturating_sub(1)..(k + 2).min(speeds.len());
                turning.extend((0..speeds.len()).map(|k| neighbours(k).any(is_slow)));
            }
        }
        Self { near_rest, turning }
    }
}

/// The errors of a prediction in the rows that count, all of them if none are named.
pub(super) fn errors(rows: &ModelRows, prediction: &[f64], counts: Option<&[bool]>, speeds: &Speeds) -> ModelError {
    let all = |rows_of: &mut dyn Iterator<Item = usize>| {
        let counted = rows_of.filter(|&k| counts.is_none_or(|counts| counts[k]));
        counted.collect::<Vec<usize>>()
    };
    let joints = (0..rows.layout.joints()).map(|j| {
        let of_joint = all(&mut rows.layout.rows_of_joint(j));
        let (resting, moving): (Vec<usize>, Vec<usize>) = of_joint.iter().partition(|&&k| speeds.near_rest[k]);
        let square = |rows_of: &[usize]| rows_of.iter().map(|&k| (rows.y[k] - prediction[k]).powi(2)).sum::<f64>();
        ModelJointError {
            percent: percent(rows, prediction, &of_joint),
            moving_percent: percent(rows, prediction, &moving),
            near_rest_percent: percent(rows, prediction, &resting),
            near_rest_share_percent: 100.0 * resting.len() as f64 / of_joint.len().max(1) as f64,
            rms: (square(&of_joint) / of_joint.len().max(1) as f64).sqrt(),
        }
    });
    let every = all(&mut (0..rows.y.len()));
    ModelError { percent: percent(rows, prediction, &every).unwrap_or(0.0), joints: joints.collect() }
}

/// `100 |y - prediction| / |y|`; none if y is zero.
fn percent(rows: &ModelRows, prediction: &[f64], of: &[usize]) -> Option<f64> {
    let error: f64 = of.iter().map(|&k| (rows.y[k] - prediction[k]).powi(2)).sum();
    let size: f64 = of.iter().map(|&k| rows.y[k].powi(2)).sum();
    (size > 0.0).then(|| 100.0 * (error / size).sqrt())
}
