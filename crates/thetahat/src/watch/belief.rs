//! What is believed before a robot is watched: how large changes are, and how wrong its model may be.

use super::{
    layout::{CURVE, PAYLOAD},
    step::Step,
    subject::WatchedRobot,
};
use thetahat_ground::linear_algebra::Matrix;

/// Prior deviation of a change of friction, over friction.
const FRICTION: f64 = 0.3;
/// The least of it, over the deviation of a block's residual.
const LEAST: f64 = 2.0;
/// Prior deviation of a payload, kg, and of its distance, m.
const PAYLOAD_PRIOR: [f64; 2] = [1.0, 0.15];
/// Prior deviations of the baseline, over those of a change.
const BASELINE: f64 = 1.0;
/// Prior deviation of the curve of friction, over friction.
const OF_CURVE: f64 = 0.15;
/// Prior deviation of the torque's delay, samples, and the least of it, s.
const OF_DELAY: [f64; 2] = [0.5, 1e-3];
/// The deviation of the model's parameters, over that of the identification, which knows noise and not that friction is another.
const OF_MODEL: f64 = 2.0;

/// What is believed of changes and of the model's errors.
pub(super) struct Belief {
    /// Deviations of the changes that are said.
    pub(super) changes: Vec<f64>,
    /// Deviation of the torque's delay, s.
    pub(super) delay_s: f64,
    /// Identified viscous and Coulomb friction of each joint.
    pub(super) friction: Vec<[f64; 2]>,
    /// Precision of the changes from the identified robot when watching begins.
    pub(super) baseline: Matrix,
}

impl Belief {
    /// For a robot that moves in some blocks.
    pub(super) fn of(robot: &WatchedRobot, sample_s: f64, blocks: &[Step]) -> Self {
        let layout = robot.layout();
        let sizes: Vec<Size> = (0..layout.joints).map(|j| Size::of(robot, blocks, j)).collect();
        let [mass, centre] = PAYLOAD_PRIOR;
        let mut changes: Vec<f64> =
            sizes.iter().flat_map(|Size { viscous, coulomb }| [*viscous, *coulomb, *coulomb]).collect();
        changes.extend([mass, mass * centre, mass * centre, mass * centre]);
        changes.extend([mass * centre * centre; PAYLOAD.len() - 4]);
        let [samples, least_s] = OF_DELAY;
        let delay_s = (samples * sample_s).max(least_s);
        let curve = |Size { viscous, coulomb }: &Size| -> [f64; CURVE] {
            let [coulomb, viscous] = [coulomb, viscous].map(|size| OF_CURVE / FRICTION * size);
            [coulomb, coulomb, coulomb, viscous, delay_s]
        };
        let value = |of: Option<[f64; 2]>| of.map_or(0.0, |[value, _]| value);
        let friction = |j| [value(robot.friction(j).viscous), value(robot.friction(j).coulomb)];
        let friction = (0..layout.joints).map(friction).collect();
        let deviations: Vec<f64> =
            changes.iter().map(|size| BASELINE * size).chain(sizes.iter().flat_map(curve)).collect();
        Self { changes, delay_s, friction, baseline: precision(&deviations, robot.covariance()) }
    }
}

/// The size of a joint's changes.
struct Size {
    viscous: f64,
    coulomb: f64,
}

impl Size {
    fn of(robot: &WatchedRobot, blocks: &[Step], joint: usize) -> Self {
        let moving = blocks.iter().filter(|block| !block.rest[joint]).map(|block| &block.rows[joint]);
        let [squares, speeds, count] =
            moving.fold([0.0, 0.0, 1e-9], |[y, v, n], row| [y + row.y.powi(2), v + row.x[0].powi(2), n + 1.0]);
        let least = LEAST * (squares / count).sqrt() + f64::MIN_POSITIVE;
        let speed = (speeds / count).sqrt().max(1e-6);
        let friction = robot.friction(joint);
        let part = |of: Option<[f64; 2]>| FRICTION * of.map_or(0.0, |[value, _]| value.abs());
        Self { viscous: part(friction.viscous).max(least / speed), coulomb: part(friction.coulomb).max(least) }
    }
}

/// The precision of changes with some deviations, then of the model's parameters.
fn precision(deviations: &[f64], covariance: &Matrix) -> Matrix {
    let first = deviations.len();
    let mut precision = Matrix::zeros(first + covariance.rows(), first + covariance.rows());
    deviations.iter().enumerate().for_each(|(i, deviation)| *precision.at_mut(i, i) = deviation.powi(-2));
    let of_model = inverse(covariance);
    for i in 0..covariance.rows() {
        (0..covariance.rows())
            .for_each(|k| *precision.at_mut(first + i, first + k) = OF_MODEL.powi(-2) * of_model.at(i, k));
    }
    precision
}

/// The inverse of a covariance, whose parameters have units of their own; of the variances alone where it has none.
fn inverse(covariance: &Matrix) -> Matrix {
    let size = covariance.rows();
    let deviation: Vec<f64> = (0..size).map(|i| covariance.at(i, i).sqrt()).collect();
    let correlation = Matrix::from_fn(size, size, |i, k| covariance.at(i, k) / (deviation[i] * deviation[k]));
    let factor = correlation.cholesky().map(|factor| factor.solve_matrix(&Matrix::identity(size)));
    let precision = factor.unwrap_or_else(|| Matrix::identity(size));
    Matrix::from_fn(size, size, |i, k| precision.at(i, k) / (deviation[i] * deviation[k]))
}
