use crate::robot::Transmission;
use thetahat_ground::real::Real;

/// A motor that turns with more than one coordinate, as row i of `n` (design: motor velocity `n dq`).
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledMotor {
    /// Its number from zero, equal to that of its own joint.
    pub motor: usize,
    /// The coordinates that move it, with their weights in `n`.
    pub weights: Vec<(usize, f64)>,
}

impl CoupledMotor {
    /// The motor's velocity in joint units, `n_i dq`.
    #[must_use]
    pub fn velocity(&self, dq: &[f64]) -> f64 {
        self.weights.iter().map(|&(j, w)| w * dq[j]).sum()
    }

    /// The motor's velocity or acceleration in each lane.
    #[inline(always)]
    pub(crate) fn rate<T: Real>(&self, rates: &[T]) -> T {
        let mut sum = rates[0].like(0.0);
        for &(j, w) in &self.weights {
            sum += rates[j] * w;
        }
        sum
    }

    /// The cross terms of `n_i^T n_i`: every ordered pair of different coordinates with its weight.
    pub fn cross_terms(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.weights.iter().flat_map(move |&(j, wj)| {
            self.weights.iter().filter(move |&&(k, _)| k != j).map(move |&(k, wk)| (j, k, wj * wk))
        })
    }
}

/// The motors of a transmission that turn with more than one coordinate.
pub(super) fn coupled_motors(transmission: &Transmission, coordinates: &[usize]) -> Vec<CoupledMotor> {
    let n = transmission.motor_in_joint_units();
    let weights = |i: usize| (0..n.columns()).map(|j| (j, n.at(i, j))).filter(|(_, w)| *w != 0.0).collect();
    let motor = |i: usize| CoupledMotor { motor: coordinates[i], weights: weights(i) };
    transmission.coupled_motors().into_iter().map(motor).collect()
}
