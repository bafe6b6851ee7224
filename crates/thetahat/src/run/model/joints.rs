//! What the recordings cover of each joint, and how far they determine its inertia.

use super::law_factors::ModelData;
use crate::{preparation::Setup, run::prepared::PreparedRecording};
use thetahat_ground::{linear_algebra::Matrix, series::Series};
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    regressor::Regressor,
};
use thetahat_report::results::ModelJoint;

/// Positions of each recording at which inertias are computed.
const POSITIONS: usize = 25;

/// Recorded positions, with the largest speeds and accelerations where samples are known.
pub(super) struct Covered {
    positions: Vec<Vec<f64>>,
    largest: Option<[Vec<f64>; 2]>,
}

impl Covered {
    pub(super) fn of_recordings(recordings: &[PreparedRecording]) -> Self {
        let motions = || recordings.iter().map(|p| &p.filtered.motion);
        let some = |q: &Series| -> Vec<Vec<f64>> {
            (0..q.len()).step_by(q.len().div_ceil(POSITIONS).max(1)).map(|k| q.sample(k).to_vec()).collect()
        };
        Self {
            positions: motions().flat_map(|motion| some(&motion.q)).collect(),
            largest: Some([largest(motions().map(|m| &m.dq)), largest(motions().map(|m| &m.ddq))]),
        }
    }

    /// The mean positions alone.
    pub(super) fn of_factors(data: &ModelData) -> Self {
        let positions = data.recordings.iter().map(|(_, factors)| factors.mean_position.clone());
        Self { positions: positions.collect(), largest: None }
    }

    /// Each joint with its inertia, by standard parameters and the covariance of base parameters.
    pub(super) fn joints(
        &self,
        setup: Setup<'_>,
        base: &BaseParameters,
        (standard, covariance): (&[f64], &Matrix),
    ) -> Vec<ModelJoint> {
        let model = Model::new(setup.robot);
        let mut sums = vec![[0.0; 2]; model.coordinate_count()];
        for q in &self.positions {
            let Ok(inertias) = model.joint_inertias(standard, q) else { return Vec::new() };
            let variances = variances(&model, base, covariance, q);
            for (sum, (inertia, variance)) in sums.iter_mut().zip(inertias.into_iter().zip(variances)) {
                *sum = [sum[0] + inertia * inertia, sum[1] + variance];
            }
        }
        let at = |which: usize, j: usize| self.largest.as_ref().map(|l| l[which][j]);
        let joint = |(j, [squares, variance]): (usize, [f64; 2])| ModelJoint {
            inertia: (squares / self.positions.len() as f64).sqrt(),
            inertia_deviation_percent: if squares > 0.0 { 100.0 * (variance / squares).max(0.0).sqrt() } else { 0.0 },
            speed: at(0, j),
            acceleration: at(1, j),
        };
        sums.into_iter().enumerate().map(joint).collect()
    }
}

/// The largest absolute value of each channel.
pub(in crate::run) fn largest<'s>(all: impl Iterator<Item = &'s Series>) -> Vec<f64> {
    let mut largest: Vec<f64> = Vec::new();
    for series in all {
        largest.resize(series.channels(), 0.0);
        for k in 0..series.len() {
            largest.iter_mut().zip(series.sample(k)).for_each(|(most, value)| *most = most.max(value.abs()));
        }
    }
    largest
}

/// The variance of each joint's inertia at a position: that of `x_j theta`, with the difference x_j of the joint's rows for its unit
/// acceleration and for rest.
fn variances(model: &Model, base: &BaseParameters, covariance: &Matrix, q: &[f64]) -> Vec<f64> {
    let (joints, columns) = (model.coordinate_count(), base.columns());
    let is_inertia = |c: &usize| {
        let quantity = model.parameter_table().get(columns[*c]).quantity;
        quantity.is_inertial() || quantity.is_motor_inertia()
    };
    let places: Vec<usize> = (0..columns.len()).filter(is_inertia).collect();
    let own: Vec<usize> = places.iter().map(|c| columns[*c]).collect();
    let positions = Series::shaped(joints, q.repeat(joints + 1));
    let rest = Series::zeros(joints + 1, joints);
    let mut accelerations = rest.clone();
    (0..joints).for_each(|j| accelerations.sample_mut(j)[j] = 1.0);
    let mut rows = vec![0.0; (joints + 1) * joints * own.len()];
    let motion = [&positions, &rest, &accelerations];
    Regressor::new(model, &own).evaluate_rows(model, motion, 0..joints + 1, Sign::Exact, &mut rows);
    let row = |sample: usize, joint: usize| &rows[(sample * joints + joint) * own.len()..][..own.len()];
    let variance = |j: usize| {
        let x: Vec<f64> = row(j, j).iter().zip(row(joints, j)).map(|(one, none)| one - none).collect();
        let with = |a: usize| (0..x.len()).map(|b| covariance.at(places[a], places[b]) * x[b]).sum::<f64>();
        (0..x.len()).map(|a| x[a] * with(a)).sum()
    };
    (0..joints).map(variance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_values_are_of_either_sign_and_of_all_series() {
        let first = Series::shaped(2, vec![1.0, -5.0, -2.0, 0.0]);
        let second = Series::shaped(2, vec![0.5, 1.0]);
        assert_eq!(largest([&first, &second].into_iter()), [2.0, 5.0]);
    }
}
