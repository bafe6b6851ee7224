//! Selects the samples of each joint that make rows: it leaves out those near rest, where the sign of the velocity is not known.

use std::ops::Range;

use crate::signal::{Decimator, SignalError};
use thetahat_ground::series::Series;
use thetahat_model::dynamics::Jump;

/// Samples of each joint that are zero in y, X and Z. Decimation is linear, so that the rows obey the same equations as the remaining
/// samples.
#[derive(Debug, Clone, PartialEq)]
pub struct RowMask {
    /// One where a sample is used, zero where it is not: a channel for each coordinate.
    used: Series,
}

/// The criterion for near rest.
#[derive(Debug, Clone, PartialEq)]
pub struct NearRest {
    /// Velocity of each coordinate, rad/s or m/s, below which the sign of its friction is not known.
    pub velocity: Vec<f64>,
    /// Samples on either side that are left out as well.
    pub widened: usize,
}

/// Largest fraction of a joint's samples that is left out if few remain: a joint that hardly moves keeps all, so that the effects of
/// gravity and of the other joints on it remain identifiable.
const LARGEST_PART: f64 = 0.8;
/// Number of widening widths (each a period of the cut-off) that are enough to remain: a joint that moves alone for a part of the recording
/// shows its friction there.
const ENOUGH_PERIODS: usize = 8;

impl RowMask {
    /// Leaves out the samples of each coordinate on which a jump acts near rest. None if no sample would be left out.
    #[must_use]
    pub fn near_rest(jumps: &[Jump], dq: &Series, rule: &NearRest) -> Option<Self> {
        Self::near_rest_among(jumps, dq, rule, None)
    }

    /// The same among the samples that another mask uses, and without those that it leaves out.
    #[doc(hidden)]
    pub fn near_rest_among(jumps: &[Jump], dq: &Series, rule: &NearRest, others: Option<&Self>) -> Option<Self> {
        let mut channels = rule.used(jumps, dq);
        for (j, used) in channels.iter_mut().enumerate() {
            let counts = |k: usize| others.is_none_or(|others| others.used.sample(k)[j] == 1.0);
            let samples = (0..used.len()).filter(|&k| counts(k)).count();
            let left_out = used.iter().enumerate().filter(|(k, u)| **u == 0.0 && counts(*k)).count();
            if hardly_moves(left_out, samples, rule.widened) {
                used.fill(1.0);
            }
        }
        let slow = Self { used: Series::side_by_side(&channels) };
        let mask = others.map_or(slow.clone(), |others| slow.and(others));
        mask.used.values().contains(&0.0).then_some(mask)
    }

    /// Leaves out the samples of some coordinates, in pairs of both. None if no sample would be left out.
    #[must_use]
    pub fn leaving_out(coordinates: usize, samples: usize, parts: &[(Range<usize>, Range<usize>)]) -> Option<Self> {
        let mut used = Series::shaped(coordinates, vec![1.0; coordinates * samples]);
        for (of, at) in parts {
            for k in at.start..at.end.min(samples) {
                used.sample_mut(k)[of.clone()].fill(0.0);
            }
        }
        used.values().contains(&0.0).then_some(Self { used })
    }

    /// Leaves out what either of two leaves out.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self { used: other.applied_to(&self.used) }
    }

    /// A series with one channel for each coordinate, zero where a sample is not used.
    #[doc(hidden)]
    pub fn applied_to(&self, series: &Series) -> Series {
        let values = series.values().iter().zip(self.used.values()).map(|(value, used)| value * used);
        Series::shaped(series.channels(), values.collect())
    }

    /// Sets the values of a sample to zero whose coordinates are not used there.
    pub(super) fn scale(&self, sample: usize, values: &mut [f64], coordinate_of: impl Fn(usize) -> usize) {
        let used = self.used.sample(sample);
        values.iter_mut().enumerate().for_each(|(i, value)| *value *= used[coordinate_of(i)]);
    }

    /// Fraction of each coordinate's samples that is left out.
    #[must_use]
    pub fn left_out(&self) -> Vec<f64> {
        let part = |used: Vec<f64>| 1.0 - used.iter().sum::<f64>() / used.len() as f64;
        (0..self.used.channels()).map(|j| part(self.used.channel(j))).collect()
    }

    /// The fraction of each row that is used, coordinate by coordinate: the decimated mask.
    ///
    /// # Errors
    /// [`SignalError`] where the decimator is for another number of samples.
    pub fn shares(&self, decimator: &Decimator) -> Result<Vec<f64>, SignalError> {
        let shares = decimator.decimate(&self.used)?;
        let share = |decimated: f64| share_of_row(decimated, decimator);
        Ok((0..shares.channels()).flat_map(|j| shares.channel(j)).map(share).collect())
    }
}

impl NearRest {
    /// One at a sample where no jump acts on a coordinate near rest, otherwise zero, for each coordinate.
    #[doc(hidden)]
    pub fn used(&self, jumps: &[Jump], dq: &Series) -> Vec<Vec<f64>> {
        let mut channels = vec![vec![1.0; dq.len()]; dq.channels()];
        for jump in jumps {
            let limit = jump.velocity.iter().map(|&(j, w)| (w * self.velocity[j]).powi(2)).sum::<f64>().sqrt();
            let velocity: Vec<f64> = (0..dq.len()).map(|k| jump.velocity(dq.sample(k))).collect();
            let near = near_rest(&velocity, limit, self.widened);
            for &coordinate in &jump.acts_on {
                let used = channels[coordinate].iter_mut().zip(&near);
                used.filter(|(_, near)| **near).for_each(|(used, _)| *used = 0.0);
            }
        }
        channels
    }
}

/// Whether a coordinate keeps all its samples, given how many are near rest and by how many samples rests are widened.
#[doc(hidden)]
pub fn hardly_moves(near_rest: usize, samples: usize, widened: usize) -> bool {
    let is_left = samples - near_rest;
    near_rest as f64 > LARGEST_PART * samples as f64 && is_left < ENOUGH_PERIODS * widened.max(1)
}

/// The fraction of a row that is used, from its sample of the decimated mask.
#[doc(hidden)]
pub fn share_of_row(decimated: f64, decimator: &Decimator) -> f64 {
    // The filter rings where the mask jumps.
    (decimated / decimator.constant_gain()).clamp(0.0, 1.0)
}

/// The samples whose velocity is below a limit or about to change its sign, and `widened` samples on either side.
fn near_rest(velocity: &[f64], limit: f64, widened: usize) -> Vec<bool> {
    let mut near = vec![false; velocity.len()];
    for (k, v) in velocity.iter().enumerate() {
        let changes = velocity.get(k + 1).is_some_and(|next| v * next <= 0.0);
        if v.abs() < limit || changes {
            let end = (k + widened + 1).min(near.len());
            near[k.saturating_sub(widened)..end].fill(true);
        }
    }
    near
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own(coordinate: usize) -> Jump {
        Jump { velocity: vec![(coordinate, 1.0)], acts_on: vec![coordinate] }
    }

    #[test]
    fn samples_near_rest_and_next_to_it_are_left_out_of_their_own_joint() {
        let first: Vec<f64> = (0..20).map(|k| f64::from(k) - 9.5).collect();
        let dq = Series::side_by_side(&[first, vec![3.0; 20]]);
        let rule = NearRest { velocity: vec![1.0, 1.0], widened: 2 };
        let mask = RowMask::near_rest(&[own(0), own(1)], &dq, &rule).unwrap();
        let used: Vec<usize> = (0..20).filter(|&k| mask.used.sample(k)[0] == 1.0).collect();
        assert_eq!(used, [0, 1, 2, 3, 4, 5, 6, 13, 14, 15, 16, 17, 18, 19]);
        assert!((mask.left_out()[0] - 0.3).abs() < 1e-12 && mask.left_out()[1] == 0.0);
    }

    #[test]
    fn a_motor_near_rest_takes_all_joints_that_move_it() {
        let rule = NearRest { velocity: vec![0.1, 0.1], widened: 0 };
        // The motor's velocity is -1, 3, 0, 3, 3 ...: it changes its sign after the first sample and at the third.
        let dq = Series::side_by_side(&[vec![2.0; 8], vec![-3.0, 1.0, -2.0, 1.0, 1.0, 1.0, 1.0, 1.0]]);
        let motor = Jump { velocity: vec![(0, 1.0), (1, 1.0)], acts_on: vec![0, 1] };
        let mask = RowMask::near_rest(&[motor], &dq, &rule).unwrap();
        assert_eq!(mask.left_out(), [0.375, 0.375]);
    }

    #[test]
    fn a_joint_that_hardly_moves_keeps_all_samples() {
        let dq = Series::side_by_side(&[vec![1e-3; 30]]);
        let rule = NearRest { velocity: vec![0.1], widened: 1 };
        assert_eq!(RowMask::near_rest(&[own(0)], &dq, &rule), None);
    }

    /// Once all rests were kept, where the sign of the friction is that of the velocity's noise: fc was 0.11, its true value 0.5.
    #[test]
    fn a_joint_that_moves_for_a_tenth_of_the_recording_keeps_that_tenth() {
        let moves =
            |from: usize, to: usize| (0..5000).map(|k| if (from..to).contains(&k) { 1.0 } else { 1e-3 }).collect();
        let left_out = |samples: usize| {
            let dq = Series::side_by_side(&[moves(2000, 2000 + samples)]);
            RowMask::near_rest(&[own(0)], &dq, &NearRest { velocity: vec![0.1], widened: 20 }).map(|m| m.left_out()[0])
        };
        assert_eq!(left_out(500), Some(1.0 - 460.0 / 5000.0));
        assert_eq!(left_out(199), None);
    }

    #[test]
    fn shares_are_one_away_from_what_is_left_out_and_zero_inside() {
        let velocity: Vec<f64> = (0..4000).map(|k| if (1000..1600).contains(&k) { 0.0 } else { 1.0 }).collect();
        let dq = Series::side_by_side(&[velocity]);
        let mask = RowMask::near_rest(&[own(0)], &dq, &NearRest { velocity: vec![0.1], widened: 0 }).unwrap();
        let decimator = Decimator::new(10, 4000).unwrap();
        let shares = mask.shares(&decimator).unwrap();
        assert!(shares[..90].iter().chain(&shares[170..]).all(|s| (s - 1.0).abs() < 0.03), "{shares:?}");
        assert!(shares[110..150].iter().all(|s| *s < 0.01));
        let total: f64 = shares.iter().sum();
        assert!((total - 340.0).abs() < 1.0, "{total}");
    }
}
