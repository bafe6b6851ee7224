//! The factor of a covariance, to draw from it and to whiten with it.

use thetahat_ground::linear_algebra::Matrix;

/// `C = D L L^T D`: standard deviations on the diagonal of D, and the lower factor L of the correlations, which has no units.
#[derive(Debug, Clone, PartialEq)]
#[doc(hidden)]
pub struct CovarianceFactor {
    deviation: Vec<f64>,
    lower: Matrix,
}

impl CovarianceFactor {
    /// `None` for a covariance that is not positive definite.
    #[doc(hidden)]
    pub fn of(covariance: &Matrix) -> Option<Self> {
        let n = covariance.rows();
        let deviation: Vec<f64> = (0..n).map(|i| covariance.at(i, i).sqrt()).collect();
        if !deviation.iter().all(|d| d.is_finite() && *d > 0.0) {
            return None;
        }
        let correlation = Matrix::from_fn(n, n, |i, j| covariance.at(i, j) / (deviation[i] * deviation[j]));
        let lower = correlation.cholesky()?.lower();
        Some(Self { deviation, lower })
    }

    /// `D L z`: turns independent standard normal numbers into a vector with this covariance.
    #[doc(hidden)]
    pub fn coloured(&self, z: &[f64]) -> Vec<f64> {
        self.lower.times(z).iter().zip(&self.deviation).map(|(v, d)| v * d).collect()
    }

    /// `R = L^-1 D^-1`, so that `R^T R` is the inverse of the covariance.
    #[doc(hidden)]
    pub fn whitening(&self) -> Option<Matrix> {
        let n = self.deviation.len();
        let inverse = self.lower.inverse()?;
        Some(Matrix::from_fn(n, n, |i, j| inverse.at(i, j) / self.deviation[j]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_draws_from_and_whitens_with_the_covariance() {
        let covariance = Matrix::from_fn(2, 2, |i, j| [[4.0, 1e-6], [1e-6, 1e-12]][i][j]);
        let factor = CovarianceFactor::of(&covariance).unwrap();
        let columns: Vec<Vec<f64>> = [[1.0, 0.0], [0.0, 1.0]].iter().map(|z| factor.coloured(z)).collect();
        for (i, j, expected) in [(0, 0, 4.0), (0, 1, 1e-6), (1, 1, 1e-12)] {
            let found: f64 = columns.iter().map(|c| c[i] * c[j]).sum();
            assert!((found / expected - 1.0).abs() < 1e-12, "{i} {j}: {found}");
        }
        let whitening = factor.whitening().unwrap();
        let white = whitening.times_matrix(&covariance).times_transposed(&whitening);
        for (i, j, expected) in [(0, 0, 1.0), (0, 1, 0.0), (1, 0, 0.0), (1, 1, 1.0)] {
            assert!((white.at(i, j) - expected).abs() < 1e-12, "{i} {j}: {}", white.at(i, j));
        }
    }

    #[test]
    fn a_deviation_of_zero_and_a_full_correlation_have_no_factor() {
        for entries in [[[1.0, 0.0], [0.0, 0.0]], [[1.0, 2.0], [2.0, 4.0]], [[1.0, 0.0], [0.0, f64::NAN]]] {
            assert_eq!(CovarianceFactor::of(&Matrix::from_fn(2, 2, |i, j| entries[i][j])), None);
        }
    }
}
