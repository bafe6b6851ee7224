//! Sums of rows, and ratios of likelihoods between changes of some parameters and none.
//!
//! Rows `y = x a + e` with `e` of variance one have the information `J = sum x^T x` and the score `s = sum x^T y`. Under no change `a` is the
//! error of the baseline, of precision `P`; a change adds a vector `E d` with a Gaussian prior of `d`. With
//! `u = P (P + J)^-1 s` and `W = P (P + J)^-1 J` the ratio of both likelihoods has the logarithm
//! `1/2 u_E^T (Q^-1 + W_EE)^-1 u_E - 1/2 log det(1 + Q W_EE)`, `Q` the variance of `d`.

use super::{
    layout::{Layout, OWN},
    step::Row,
};
use thetahat_ground::linear_algebra::Matrix;

/// Information and score of all changes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sums {
    layout: Layout,
    information: Matrix,
    score: Vec<f64>,
}

impl Sums {
    pub(super) fn zeros(layout: Layout) -> Self {
        let size = layout.all();
        Self { layout, information: Matrix::zeros(size, size), score: vec![0.0; size] }
    }

    /// Adds a row with a weight: one over its variance.
    pub(super) fn add_row(&mut self, joint: usize, row: &Row, weight: f64) {
        let places = self.layout.places(joint);
        let mut x = row.x.iter();
        for place in places.iter().cloned().flatten() {
            let Some(weighted) = x.next().map(|x| weight * x).filter(|weighted| *weighted != 0.0) else { continue };
            self.score[place] += weighted * row.y;
            let (column, mut first) = (self.information.column_mut(place), 0);
            for part in &places {
                let others = &row.x[first..first + part.len()];
                column[part.clone()].iter_mut().zip(others).for_each(|(sum, other)| *sum += weighted * other);
                first += part.len();
            }
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.score.iter_mut().zip(&other.score).for_each(|(a, b)| *a += b);
        self.information = self.information.plus(&other.information, 1.0);
    }

    /// The same for rows less the torque of some changes.
    pub(super) fn less(&mut self, changes: &[f64]) {
        let torque = self.information.times(changes);
        self.score.iter_mut().zip(torque).for_each(|(score, torque)| *score -= torque);
    }

    /// The information and score of a joint's friction and offset alone.
    pub(super) fn own(&self, joint: usize) -> (Matrix, Vec<f64>) {
        let [own, ..] = self.layout.places(joint);
        let first = own.start;
        (Matrix::from_fn(OWN, OWN, |i, k| self.information.at(first + i, first + k)), self.score[own].to_vec())
    }

    /// The sum of squares of the torque of some changes, each with its place, over the variance.
    pub(super) fn square(&self, changes: &[(usize, f64)]) -> f64 {
        let product =
            |(i, a): &(usize, f64)| changes.iter().map(|(k, b)| a * b * self.information.at(*i, *k)).sum::<f64>();
        changes.iter().map(product).sum()
    }

    /// The information and the score of all changes.
    pub(super) fn all(&self) -> (&Matrix, &[f64]) {
        (&self.information, &self.score)
    }
}

/// The changes that rows of a baseline of some precision show: their most probable value and precision; `None` where the sums are no
/// numbers.
pub(super) fn posterior(precision: &Matrix, sums: &Sums) -> Option<(Vec<f64>, Matrix)> {
    let (information, score) = sums.all();
    let precision = precision.plus(information, 1.0);
    let changes = precision.cholesky()?.solve(score);
    Some((changes, precision))
}

/// What rows show beyond an error of the baseline, of the changes that are said: `u` and `W`.
pub(super) struct Unexplained {
    score: Vec<f64>,
    information: Matrix,
}

impl Unexplained {
    /// Of rows whose baseline has this precision; `None` where the sums are no numbers.
    pub(super) fn of(precision: &Matrix, sums: &Sums) -> Option<Self> {
        let (information, score) = sums.all();
        let factor = precision.plus(information, 1.0).cholesky()?;
        let said: Vec<usize> = (0..sums.layout.said()).collect();
        let shown = factor.solve_matrix(&information.select_columns(&said));
        // P (P + J)^-1 J, not J - J (P + J)^-1 J, whose difference is of rounding errors where J is much larger than P.
        let rows = precision.select_columns(&said);
        Some(Self { score: rows.transpose_times(&factor.solve(score)), information: rows.transposed_times(&shown) })
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
        let layout = Layout { joints: 1, model: 0 };
        let mut sums = Sums::zeros(layout);
        let mut row = Row { y: mean, ..Row::zeros(layout.of_joint()) };
        row.x[2] = 1.0;
        (0..40).for_each(|_| sums.add_row(0, &row, 1.0));
        let size = layout.all();
        let precision = Matrix::from_fn(size, size, |i, k| if i == k { baseline } else { 0.0 });
        let found = Unexplained::of(&precision, &sums).unwrap().ratio(&[2], &vec![change; size]).unwrap();
        let log_density = |variance: f64| -0.5 * (variance.ln() + mean * mean / variance);
        let before = 1.0 / rows + 1.0 / baseline;
        let expected = log_density(before + change * change) - log_density(before);
        assert!((found.log - expected).abs() < 1e-12, "{} in place of {expected}", found.log);
        let weight = change * change / (before + change * change);
        assert!((found.changes[0] - weight * mean).abs() < 1e-12);
        assert!((found.deviations[0].powi(2) - change * change * (1.0 - weight)).abs() < 1e-12);
    }
}
