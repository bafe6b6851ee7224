use std::ops::Range;

use rand::Rng;

use super::{autoregressive::Autoregressive, lagged::add_lower_half};
use crate::regression::RowLayout;
use thetahat_ground::linear_algebra::Matrix;

/// Highest order of a joint's process that is tried.
const HIGHEST_ORDER: usize = 8;

/// Noise in the rows: one autoregressive process for each joint, independent of the others and between recordings.
#[derive(Debug, Clone)]
pub struct RowNoise {
    layout: RowLayout,
    /// The process of each joint.
    pub joints: Vec<Autoregressive>,
}

impl RowNoise {
    /// The noise of a residual.
    #[must_use]
    pub fn of(residual: &[f64], layout: &RowLayout) -> Self {
        let segments = layout.runs(residual);
        let joints = segments.iter().map(|s| Autoregressive::fit(s, HIGHEST_ORDER)).collect();
        Self { layout: layout.clone(), joints }
    }

    /// `Q_j^T S_j Q_j` of each joint j with the covariance S of its rows: the sum over the joints is the covariance of
    /// `Q^T e`.
    #[must_use]
    pub fn covariances(&self, q: &Matrix) -> Vec<Matrix> {
        let of_joint = |(joint, process): (usize, &Autoregressive)| {
            let mut lower_half = process.autocovariance();
            lower_half.iter_mut().take(1).for_each(|variance| *variance /= 2.0);
            let of_blocks =
                self.layout.of_joint(joint).map(|rows| covariance_of_rows(&self.part_of(q, rows), &lower_half));
            of_blocks.fold(Matrix::zeros(q.columns(), q.columns()), |sum, block| sum.plus(&block, 1.0))
        };
        self.joints.iter().enumerate().map(of_joint).collect()
    }

    /// The covariance of `Q^T e`.
    #[must_use]
    pub fn covariance(&self, q: &Matrix) -> Matrix {
        let zero = Matrix::zeros(q.columns(), q.columns());
        self.covariances(q).iter().fold(zero, |sum, part| sum.plus(part, 1.0))
    }

    /// Draws one realisation; `memory` comes from [`RowNoise::memory`].
    pub fn draw(&self, memory: &[usize], rng: &mut impl Rng, out: &mut [f64]) {
        for ((joint, process), memory) in self.joints.iter().enumerate().zip(memory) {
            self.layout.of_joint(joint).for_each(|rows| process.draw(*memory, rng, &mut out[rows]));
        }
        if let Some(shares) = self.layout.shares(0..out.len()) {
            out.iter_mut().zip(shares).for_each(|(e, share)| *e *= share);
        }
    }

    /// Some rows of a matrix, each times the part that a mask leaves.
    fn part_of(&self, q: &Matrix, rows: Range<usize>) -> Matrix {
        let part = q.row_range(rows.clone());
        match self.layout.shares(rows) {
            Some(shares) => part.scale_rows(shares),
            None => part,
        }
    }

    /// Number of rows after which each joint's process no longer depends on its start.
    #[must_use]
    pub fn memory(&self) -> Vec<usize> {
        self.joints.iter().map(|p| p.weights().len()).collect()
    }

    /// For each joint, the long-run variance of another residual divided by this residual's, from processes of the same orders;
    /// one if this residual's is zero.
    #[must_use]
    pub fn relative_long_run_variances(&self, residual: &[f64]) -> Vec<f64> {
        let segments = self.layout.runs(residual);
        let ratio = |(process, segments): (&Autoregressive, &Vec<&[f64]>)| {
            let other = Autoregressive::fit_order(segments, process.coefficients.len());
            let own = process.long_run_variance();
            if own > 0.0 { other.long_run_variance() / own } else { 1.0 }
        };
        self.joints.iter().zip(&segments).map(ratio).collect()
    }
}

/// `Q^T S Q` over rows that follow one another, with the Toeplitz matrix S of an autocovariance: `G + G^T` with `G = Q^T H Q`,
/// where H is the lower half of S, with half its diagonal; `lower_half` is its first column.
fn covariance_of_rows(rows: &Matrix, lower_half: &[f64]) -> Matrix {
    let mut filtered = Matrix::zeros(rows.rows(), rows.columns());
    for c in 0..rows.columns() {
        add_lower_half(lower_half, rows.column(c), filtered.column_mut(c));
    }
    let half = rows.transposed_times(&filtered);
    half.plus(&half.transpose(), 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    /// The covariance agrees with the sample covariance of many realisations.
    #[test]
    fn drawn_noise_has_the_covariance() {
        let layout = RowLayout::new(2, &[40, 20]);
        let process = |a: f64, v: f64| Autoregressive { coefficients: vec![a], innovation_variance: v };
        let noise = RowNoise { layout, joints: vec![process(0.7, 1.0), process(-0.4, 2.0)] };
        let q = Matrix::from_fn(120, 2, |k, c| (0.05 * (k * (c + 1)) as f64 + 0.3).sin());
        let covariance = noise.covariance(&q);
        let mut sum = Matrix::zeros(2, 2);
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let draws = 4000;
        let mut e = vec![0.0; 120];
        for _ in 0..draws {
            noise.draw(&noise.memory(), &mut rng, &mut e);
            let d = q.transpose_times(&e);
            sum = sum.plus(&Matrix::from_fn(2, 2, |i, j| d[i] * d[j]), 1.0 / f64::from(draws));
        }
        for (i, j) in [(0, 0), (0, 1), (1, 1)] {
            let scale = (covariance.at(i, i) * covariance.at(j, j)).sqrt();
            assert!((sum.at(i, j) - covariance.at(i, j)).abs() < 0.08 * scale, "{sum:?}, expected {covariance:?}");
        }
    }
}
