//! Columns of a friction transition between those of which there are columns.

use thetahat_model::{dynamics::FrictionTransition, robot::JointKind};

/// A transition between those of which there are columns.
pub(super) struct Between<'a> {
    pub(super) transitions: &'a [FrictionTransition],
    pub(super) kinds: &'a [JointKind],
    pub(super) at: FrictionTransition,
}

impl Between<'_> {
    fn of_joint(&self, joint: usize) -> (Vec<f64>, f64) {
        let kind = self.kinds[joint];
        (self.transitions.iter().map(|t| t.of(kind)).collect(), self.at.of(kind))
    }

    /// For each joint the weights with which its columns sum to nearly those of the transition.
    pub(super) fn weights(&self) -> Vec<Vec<f64>> {
        let of_joint = |joint: usize| {
            let (velocities, v) = self.of_joint(joint);
            weights_between(&velocities, v)
        };
        (0..self.kinds.len()).map(of_joint).collect()
    }

    /// For each joint how many of them are smaller.
    pub(super) fn smaller(&self) -> Vec<usize> {
        let of_joint = |joint: usize| {
            let (velocities, v) = self.of_joint(joint);
            velocities.iter().filter(|other| **other < v).count()
        };
        (0..self.kinds.len()).map(of_joint).collect()
    }
}

/// The weights with which the columns of some velocities sum to nearly those of one between them: Lagrange's polynomial in ln v. Between
/// 0.01 and 0.03 rad/s the sum is within 0.03 of the hyperbolic tangent, and within 0.008 rms up to 0.3 rad/s.
fn weights_between(transitions: &[f64], transition: f64) -> Vec<f64> {
    let places: Vec<f64> = transitions.iter().map(|v| v.ln()).collect();
    let weight = |k: usize| {
        let others = places.iter().enumerate().filter(|(other, _)| *other != k);
        others.map(|(_, place)| (transition.ln() - place) / (places[k] - place)).product()
    };
    (0..places.len()).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::weights_between;

    #[test]
    fn columns_between_two_velocities_are_nearly_sums_of_those_of_all() {
        let transitions = [0.03, 0.001, 0.003, 0.01, 0.1];
        assert_eq!(weights_between(&transitions, 0.01), [0.0, 0.0, 0.0, 1.0, 0.0]);
        let weights = weights_between(&transitions, 0.02);
        let error = |dq: f64| {
            let sum: f64 = transitions.iter().zip(&weights).map(|(v, weight)| weight * (dq / v).tanh()).sum();
            (sum - (dq / 0.02).tanh()).abs()
        };
        let worst = (0..3000).map(|k| error(1e-4 * f64::from(k))).fold(0.0, f64::max);
        assert!(worst < 0.03, "{worst}");
    }
}
