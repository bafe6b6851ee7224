//! Torques of friction that the model does not have, as columns: what friction is beside viscous and Coulomb friction.
//!
//! A joint's friction turns around later than its motion does, since its teeth and bearings bend first; it is larger at low
//! velocity, and not proportional at high velocity. To the regression all of these look like a lag of the torque. Where
//! the columns here are free beside the parameters, what is left of a lag is one of inertia and gravity.

use super::{numbers::span, thinned_record::ThinnedRecord};
use thetahat_ground::{linear_algebra::Matrix, series::Series};

/// Travels over which friction turns around, part of the joint's span.
const PRESLIDING: [f64; 4] = [0.002, 0.008, 0.03, 0.12];
/// Velocities over which friction falls off, part of the peak velocity.
const STRIBECK: [f64; 3] = [0.02, 0.07, 0.25];

/// Part of its peak velocity below which a joint is slow.
const SLOW: f64 = 0.03;
/// Rows around a slow sample that its friction reaches through the filter.
const REACH: f64 = 1.5;

/// The columns of all joints that move, filtered as the rows are; a row for each of the record's. None where the record has too few
/// rows for them beside the parameters.
pub(super) fn friction_shapes(record: &ThinnedRecord<'_>) -> Option<Matrix> {
    let rows = record.rows();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for (motion, acts_on) in rubbing(record) {
        let filtered = record.decimator.filter(&Series::side_by_side(&shapes(&motion))).ok()?;
        for shape in record.stack(&filtered).chunks(rows) {
            let torques = acts_on.iter().flat_map(|n| shape.iter().map(move |s| n * s));
            columns.push(torques.collect());
        }
    }
    let all = Matrix::from_fn(rows * record.coordinates(), columns.len(), |i, c| columns[c][i]);
    record.has_rows_for(record.parameters() + all.columns()).then_some(all)
}

/// The rows in which a joint, or a motor that it shares, turns around or hardly moves: no law says what friction is there.
pub(super) fn rows_of_reversals(record: &ThinnedRecord<'_>) -> Vec<bool> {
    let reach = (REACH * record.steps_per_row() as f64).ceil() as usize;
    let slow = slow_samples(record);
    let near = |j: usize, k: usize| {
        let last = slow[j].len() - 1;
        slow[j][k.saturating_sub(reach)..=(k + reach).min(last)].iter().any(|s| *s)
    };
    (0..record.coordinates()).flat_map(|j| record.kept.iter().map(move |&k| near(j, k)).collect::<Vec<_>>()).collect()
}

/// The samples at which each joint, or a motor that acts on it, is slow.
fn slow_samples(record: &ThinnedRecord<'_>) -> Vec<Vec<bool>> {
    let slow = |(travel, acts_on): (Travel, Vec<f64>)| {
        let fastest = travel.dq.iter().fold(0.0_f64, |f, v| f.max(v.abs()));
        (travel.dq.iter().map(|v| v.abs() < SLOW * fastest).collect::<Vec<bool>>(), acts_on)
    };
    let all: Vec<(Vec<bool>, Vec<f64>)> = rubbing(record).into_iter().map(slow).collect();
    let of_joint = |j: usize| {
        let own: Vec<&Vec<bool>> = all.iter().filter(|(_, acts_on)| acts_on[j] != 0.0).map(|(slow, _)| slow).collect();
        (0..record.motion.dq.len()).map(|k| own.iter().any(|slow| slow[k])).collect()
    };
    (0..record.coordinates()).map(of_joint).collect()
}

/// Positions and velocities of a joint or motor.
struct Travel {
    q: Vec<f64>,
    dq: Vec<f64>,
}

/// What rubs: joints, and the motors that several joints share, with the torque on each joint per torque of friction.
fn rubbing(record: &ThinnedRecord<'_>) -> Vec<(Travel, Vec<f64>)> {
    let motors = record.subject.robot.transmission.motor_in_joint_units();
    let n = record.coordinates();
    let of_joint = |j: usize| (0..n).map(|i| if i == j { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
    let of_motor = |m: usize| (0..n).map(|j| motors.at(m, j)).collect::<Vec<f64>>();
    let coupled = (0..n).map(of_motor).filter(|row| row.iter().filter(|entry| **entry != 0.0).count() > 1);
    (0..n).map(of_joint).chain(coupled).map(|row| (along(record, &row), row)).collect()
}

/// The travel of a motor with the joints.
fn along(record: &ThinnedRecord<'_>, row: &[f64]) -> Travel {
    let [q, dq] = [&record.motion.q, &record.motion.dq]
        .map(|series| (0..series.len()).map(|k| row.iter().zip(series.sample(k)).map(|(n, v)| n * v).sum()).collect());
    Travel { q, dq }
}

/// The shapes of a friction along its travel.
fn shapes(Travel { q, dq }: &Travel) -> Vec<Vec<f64>> {
    let (reach, fastest) = (span(q), dq.iter().fold(0.0_f64, |f, v| f.max(v.abs())));
    let bent = PRESLIDING.iter().map(|part| bending(q, part * reach));
    let falling = STRIBECK.iter().map(|part| dq.iter().map(|v| fall(*v, part * fastest)).collect());
    let growing = std::iter::once(dq.iter().map(|v| v * v.abs()).collect());
    bent.chain(falling).chain(growing).collect()
}

/// Friction that turns around over a travel (Dahl's law): from -1 to 1, zero at first.
fn bending(q: &[f64], travel: f64) -> Vec<f64> {
    let mut bent = 0.0;
    let mut last = q.first().copied().unwrap_or_default();
    let mut next = |q: f64| {
        let step = q - std::mem::replace(&mut last, q);
        if travel > 0.0 && step != 0.0 {
            bent = step.signum() - (step.signum() - bent) * (-step.abs() / travel).exp();
        }
        bent
    };
    q.iter().map(|q| next(*q)).collect()
}

/// What friction has more of at low velocity.
fn fall(velocity: f64, over: f64) -> f64 {
    if over > 0.0 && velocity != 0.0 { velocity.signum() * (-(velocity / over).powi(2)).exp() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_turns_around_over_the_travel() {
        let q: Vec<f64> =
            (0..=100).map(|k| 0.01 * f64::from(k)).chain((0..100).rev().map(|k| 0.01 * f64::from(k))).collect();
        let bent = bending(&q, 0.1);
        assert!((bent[100] - 1.0).abs() < 1e-4, "{}", bent[100]);
        // Behind the reversal: -1 + 2 exp(-travelled / 0.1).
        assert!((bent[110] - (2.0 * (-1.0_f64).exp() - 1.0)).abs() < 1e-4, "{}", bent[110]);
        assert!(bending(&[1.0; 5], 0.1).iter().all(|b| *b == 0.0));
    }
}
