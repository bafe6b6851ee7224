//! Sums of rows, and ratios of likelihoods between changes of some parameters and none.
//!
//! Rows `y = x a + e` with `e` of variance one have the information `J = sum x^T x` and the score `s = sum x^T y`. Under no change `a` is the
//! error of the baseline, of precision `P`; a change adds a vector `E d` with a Gaussian prior of `d`. With
//! `u = P (P + J)^-1 s` and `W = P (P + J)^-1 J` the ratio of both likelihoods has the logarithm
//! `1/2 u_E^T (Q^-1 + W_EE)^-1 u_E - 1/2 log det(1 + Q W_EE)`, `Q` the variance of `d`.

use super::subject::{CHANGES, Row};
use thetahat_ground::linear_algebra::Matrix;

/// Information and score of the changes that act on each joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sums {
    joints: Vec<OfJoint>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct OfJoint {
    information: [[f64; CHANGES]; CHANGES],
    score: [f64; CHANGES],
}

const NOTHING: OfJoint = OfJoint { information: [[0.0; CHANGES]; CHANGES], score: [0.0; CHANGES] };

/// The place of a joint's change among those of the robot: three of each joint, then the payload's.
pub(super) fn place(joints: usize, joint: usize, change: usize) -> usize {
    if change < 3 { 3 * joint + change } else { 3 * (joints - 1) + change }
}

/// The number of changes of a robot.
pub(super) fn changes_of(joints: usize) -> usize {
    3 * joints + CHANGES - 3
}

/// The changes that act on a joint.
pub(super) fn of_joint(changes: &[f64], joint: usize) -> [f64; CHANGES] {
    let joints = (changes.len() + 3 - CHANGES) / 3;
    std::array::from_fn(|change| changes[place(joints, joint, change)])
}

impl Sums {
    pub(super) fn zeros(joints: usize) -> Self {
        Self { joints: vec![NOTHING; joints] }
    }

    /// Adds a row with a weight: one over its variance.
    pub(super) fn add_row(&mut self, joint: usize, row: &Row, weight: f64) {
        let OfJoint { information, score } = &mut self.joints[joint];
        for (i, x) in row.x.iter().enumerate() {
            let weighted = weight * x;
            score[i] += weighted * row.y;
            information[i].iter_mut().zip(&row.x).for_each(|(sum, other)| *sum += weighted * other);
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (own, other) in self.joints.iter_mut().zip(&other.joints) {
            own.score.iter_mut().zip(&other.score).for_each(|(a, b)| *a += b);
            for (row, other) in own.information.iter_mut().zip(&other.information) {
                row.iter_mut().zip(other).for_each(|(a, b)| *a += b);
            }
        }
    }

    /// The same for rows less the torque of some changes.
    pub(super) fn less(&mut self, changes: &[f64]) {
        for (j, own) in self.joints.iter_mut().enumerate() {
            let changes = of_joint(changes, j);
            for (score, row) in own.score.iter_mut().zip(&own.information) {
                *score -= row.iter().zip(&changes).map(|(a, b)| a * b).sum::<f64>();
            }
        }
    }

    /// The sums with the information and score of a joint's own changes alone: friction and offset.
    pub(super) fn own(&self, joint: usize) -> (Matrix, Vec<f64>) {
        let OfJoint { information, score } = &self.joints[joint];
        (Matrix::from_fn(3, 3, |i, k| information[i][k]), score[..3].to_vec())
    }

    /// The information and the score of all changes.
    pub(super) fn all(&self) -> (Matrix, Vec<f64>) {
        let joints = self.joints.len();
        let mut information = Matrix::zeros(changes_of(joints), changes_of(joints));
        let mut score = vec![0.0; changes_of(joints)];
        for (j, own) in self.joints.iter().enumerate() {
            for i in 0..CHANGES {
                let row = place(joints, j, i);
                score[row] += own.score[i];
                for k in 0..CHANGES {
                    *information.at_mut(row, place(joints, j, k)) += own.information[i][k];
                }
            }
        }
        (information, score)
    }
}

/// The changes that rows of a baseline of some precision show: their most probable value and precision; `None` where the sums are no
/// numbers.
pub(super) fn posterior(precision: &Matrix, sums: &Sums) -> Option<(Vec<f64>, Matrix)> {
    let (information, score) = sums.all();
    let precision = precision.plus(&information, 1.0);
    let changes = precision.cholesky()?.solve(&score);
    Some((changes, precision))
}

/// What rows show beyond an error of the baseline: `u` and `W`.
pub(super) struct Unexplained {
    score: Vec<f64>,
    information: Matrix,
}

impl Unexplained {
    /// Of rows whose baseline has this precision; `None` where the sums are no numbers.
    pub(super) fn of(precision: &Matrix, sums: &Sums) -> Option<Self> {
        let (information, score) = sums.all();
        let factor = precision.plus(&information, 1.0).cholesky()?;
        let unexplained = precision.times_matrix(&factor.solve_matrix(&information));
        Some(Self { score: precision.times(&factor.solve(&score)), information: unexplained })
    }

    /// The ratio of likelihoods between a change of some parameters with these prior deviations, and none.
    pub(super) fn ratio(&self, parameters: &[usize], prior: &[f64]) -> Option<Ratio> {
        let of = |i: usize| prior[parameters[i]];
        let score: Vec<f64> = parameters.iter().map(|&p| prior[p] * self.score[p]).collect();
        let count = parameters.len();
        let information = |i: usize, k: usize| of(i) * of(k) * self.information.at(parameters[i], parameters[k]);
        let factor =
            Matrix::from_fn(count, count, |i, k| f64::from(u8::from(i == k)) + information(i, k)).cholesky()?;
        let solved = factor.solve(&score);
        let lower = factor.lower();
        let half_log_determinant: f64 = (0..count).map(|i| lower.at(i, i).ln()).sum();
        let square: f64 = score.iter().zip(&solved).map(|(a, b)| a * b).sum();
        let inverse = factor.solve_matrix(&Matrix::identity(count));
        Some(Ratio {
            log: 0.5 * square - half_log_determinant,
            changes: (0..count).map(|i| of(i) * solved[i]).collect(),
            deviations: (0..count).map(|i| of(i) * inverse.at(i, i).max(0.0).sqrt()).collect(),
        })
    }
}

/// A ratio of likelihoods, and the changes that it is for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ratio {
    pub(super) log: f64,
    pub(super) changes: Vec<f64>,
    pub(super) deviations: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One joint whose offset alone is excited: a scalar Gaussian, whose marginal likelihoods are known.
    #[test]
    fn the_ratio_is_that_of_two_gaussians() {
        let (rows, mean, baseline, change) = (40.0, 0.6, 25.0, 2.0);
        let mut sums = Sums::zeros(1);
        let mut row = Row { y: mean, ..Row::default() };
        row.x[2] = 1.0;
        (0..40).for_each(|_| sums.add_row(0, &row, 1.0));
        let precision = Matrix::from_fn(CHANGES, CHANGES, |i, k| if i == k { baseline } else { 0.0 });
        let found = Unexplained::of(&precision, &sums).unwrap().ratio(&[2], &[change; CHANGES]).unwrap();
        let log_density = |variance: f64| -0.5 * (variance.ln() + mean * mean / variance);
        let before = 1.0 / rows + 1.0 / baseline;
        let expected = log_density(before + change * change) - log_density(before);
        assert!((found.log - expected).abs() < 1e-12, "{} in place of {expected}", found.log);
        let weight = change * change / (before + change * change);
        assert!((found.changes[0] - weight * mean).abs() < 1e-12);
        assert!((found.deviations[0].powi(2) - change * change * (1.0 - weight)).abs() < 1e-12);
    }

    #[test]
    fn changes_have_their_places() {
        let places: Vec<usize> = (0..2).flat_map(|j| (0..5).map(move |c| place(2, j, c))).collect();
        assert_eq!(places, [0, 1, 2, 6, 7, 3, 4, 5, 6, 7]);
        assert_eq!(changes_of(2), 6 + 10);
        let changes: Vec<f64> = (0..16).map(f64::from).collect();
        assert_eq!(of_joint(&changes, 1)[..5], [3.0, 4.0, 5.0, 6.0, 7.0]);
    }
}
