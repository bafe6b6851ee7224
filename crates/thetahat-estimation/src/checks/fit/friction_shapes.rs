//! Columns for friction that the model does not have: friction other than viscous and Coulomb friction.
//!
//! A joint's friction reverses later than its motion, since its teeth and bearings bend first; it is larger at low velocity,
//! and not proportional at high velocity. In the regression each of these looks like a lag of the torque. A fit with these
//! columns in addition to the parameters shows only the lag of inertia and gravity.

use super::thinned_recording::ThinnedRecording;
use crate::checks::numbers::span;
use thetahat_ground::{linear_algebra::Matrix, series::Series};

/// Travels over which friction reverses, part of the joint's span.
const PRESLIDING: [f64; 4] = [0.002, 0.008, 0.03, 0.12];
/// Velocities over which friction decreases, part of the peak velocity.
const STRIBECK: [f64; 3] = [0.02, 0.07, 0.25];

/// Part of its peak velocity below which a joint is slow.
const SLOW: f64 = 0.03;
/// Rows around a slow sample that its friction affects through the filter.
const REACH: f64 = 1.5;

/// The columns of all joints that move, filtered like the rows, with one row for each row of the recording. `None` if the
/// recording has too few rows for these and the parameters.
pub(in crate::checks) fn friction_shapes(recording: &ThinnedRecording<'_>) -> Option<Matrix> {
    let rows = recording.rows();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for FrictionSource { travel, acts_on } in friction_sources(recording) {
        let filtered = recording.decimator.filter(&Series::side_by_side(&shapes(&travel))).ok()?;
        for shape in recording.stack(&filtered).chunks(rows) {
            let torques = acts_on.iter().flat_map(|n| shape.iter().map(move |s| n * s));
            columns.push(torques.collect());
        }
    }
    let all = Matrix::from_fn(rows * recording.coordinates(), columns.len(), |i, c| columns[c][i]);
    recording.has_rows_for(recording.parameters() + all.columns()).then_some(all)
}

/// The rows in which a joint, or a motor that acts on it, reverses or hardly moves: no model of friction is reliable there.
pub(in crate::checks) fn rows_of_reversals(recording: &ThinnedRecording<'_>) -> Vec<bool> {
    let reach = (REACH * recording.steps_per_row() as f64).ceil() as usize;
    let slow = slow_samples(recording);
    let near = |j: usize, k: usize| {
        let last = slow[j].len() - 1;
        slow[j][k.saturating_sub(reach)..=(k + reach).min(last)].iter().any(|s| *s)
    };
    let of_joint = |j: usize| recording.kept.iter().map(move |&k| near(j, k)).collect::<Vec<_>>();
    (0..recording.coordinates()).flat_map(of_joint).collect()
}

/// The samples at which each joint, or a motor that acts on it, is slow.
fn slow_samples(recording: &ThinnedRecording<'_>) -> Vec<Vec<bool>> {
    let sources = friction_sources(recording);
    let slow: Vec<Vec<bool>> = sources.iter().map(|source| source.travel.is_slow()).collect();
    let of_joint = |j: usize| {
        let own: Vec<&Vec<bool>> =
            sources.iter().zip(&slow).filter(|(source, _)| source.acts_on[j] != 0.0).map(|(_, slow)| slow).collect();
        (0..recording.motion.dq.len()).map(|k| own.iter().any(|slow| slow[k])).collect()
    };
    (0..recording.coordinates()).map(of_joint).collect()
}

/// Positions and velocities of a joint or motor.
struct Travel {
    q: Vec<f64>,
    dq: Vec<f64>,
}

impl Travel {
    /// The travel of the motor that turns with the joints by `row`.
    fn new(recording: &ThinnedRecording<'_>, row: &[f64]) -> Self {
        let along = |series: &Series, k: usize| -> f64 { row.iter().zip(series.sample(k)).map(|(n, v)| n * v).sum() };
        let [q, dq] = [&recording.motion.q, &recording.motion.dq]
            .map(|series| (0..series.len()).map(|k| along(series, k)).collect());
        Self { q, dq }
    }

    fn peak_velocity(&self) -> f64 {
        self.dq.iter().fold(0.0_f64, |peak, v| peak.max(v.abs()))
    }

    /// Whether it is slow, sample by sample.
    fn is_slow(&self) -> Vec<bool> {
        let peak = self.peak_velocity();
        self.dq.iter().map(|v| v.abs() < SLOW * peak).collect()
    }
}

/// A joint, or a motor that several joints share.
struct FrictionSource {
    travel: Travel,
    /// The torque on each joint per torque of friction.
    acts_on: Vec<f64>,
}

/// All joints, and the motors that several joints share.
fn friction_sources(recording: &ThinnedRecording<'_>) -> Vec<FrictionSource> {
    let motors = recording.subject.robot.transmission.motor_in_joint_units();
    let n = recording.coordinates();
    let of_joint = |j: usize| (0..n).map(|i| if i == j { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
    let of_motor = |m: usize| (0..n).map(|j| motors.at(m, j)).collect::<Vec<f64>>();
    let coupled = (0..n).map(of_motor).filter(|row| row.iter().filter(|entry| **entry != 0.0).count() > 1);
    let source = |acts_on: Vec<f64>| FrictionSource { travel: Travel::new(recording, &acts_on), acts_on };
    (0..n).map(of_joint).chain(coupled).map(source).collect()
}

/// The shapes of friction along a travel.
fn shapes(travel: &Travel) -> Vec<Vec<f64>> {
    let Travel { q, dq } = travel;
    let (reach, peak) = (span(q), travel.peak_velocity());
    let delayed = PRESLIDING.iter().map(|part| presliding(q, part * reach));
    let decreasing = STRIBECK.iter().map(|part| dq.iter().map(|v| stribeck(*v, part * peak)).collect());
    let growing = std::iter::once(dq.iter().map(|v| v * v.abs()).collect());
    delayed.chain(decreasing).chain(growing).collect()
}

/// Friction that reverses over a travel (Dahl's law): from -1 to 1, initially zero.
fn presliding(q: &[f64], travel: f64) -> Vec<f64> {
    let mut friction = 0.0;
    let mut last = q.first().copied().unwrap_or_default();
    let mut next = |q: f64| {
        let step = q - std::mem::replace(&mut last, q);
        if travel > 0.0 && step != 0.0 {
            friction = step.signum() - (step.signum() - friction) * (-step.abs() / travel).exp();
        }
        friction
    };
    q.iter().map(|q| next(*q)).collect()
}

/// The part of friction that decreases with velocity, over a range of velocities.
fn stribeck(velocity: f64, range: f64) -> f64 {
    if range > 0.0 && velocity != 0.0 { velocity.signum() * (-(velocity / range).powi(2)).exp() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_reverses_over_the_travel() {
        let q: Vec<f64> =
            (0..=100).map(|k| 0.01 * f64::from(k)).chain((0..100).rev().map(|k| 0.01 * f64::from(k))).collect();
        let friction = presliding(&q, 0.1);
        assert!((friction[100] - 1.0).abs() < 1e-4, "{}", friction[100]);
        // After the reversal: -1 + 2 exp(-travelled / 0.1).
        assert!((friction[110] - (2.0 * (-1.0_f64).exp() - 1.0)).abs() < 1e-4, "{}", friction[110]);
        assert!(presliding(&[1.0; 5], 0.1).iter().all(|b| *b == 0.0));
    }
}
