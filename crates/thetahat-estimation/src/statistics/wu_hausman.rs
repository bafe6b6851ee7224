use super::{ChiSquaredTest, FTest, RowNoise, chi_squared_test, f_test};
use crate::regression::RowLayout;
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, norm};

/// Part of a column below which its residual after the instruments is rounding.
const EXOGENOUS: f64 = 1e-8;
/// Relative size of a diagonal entry below which a direction is linearly dependent.
const DEPENDENT: f64 = 1e-8;

/// The Durbin-Wu-Hausman test of LS against IV.
#[derive(Debug, Clone, PartialEq)]
pub struct WuHausman {
    /// The F-test of the augmented regression: independent rows of equal variance.
    pub classical: FTest,
    /// The same with the autocorrelation and the variance of each joint's residual.
    pub robust: ChiSquaredTest,
    /// `theta_IV - theta_LS`.
    pub difference: Vec<f64>,
    /// Standard deviations of the IV estimates with the autocorrelation of the residual.
    pub iv_deviation: Vec<f64>,
    /// Average difference in standard deviations of IV, `sqrt(d^T V_IV^-1 d / b)`.
    pub average_difference: f64,
}

/// Tests whether the columns of X are free of noise that is also in y: whether LS and IV estimate the same.
///
/// The residual of X after the instruments, `V = X - Z Z^+ X`, is added to the regression of y on X; if X is exogenous, V
/// explains nothing (J. Durbin, 1954; D.-M. Wu, 1973; J. A. Hausman, "Specification tests in econometrics", 1978). Columns
/// that the instruments explain in full are left out of V. All arguments are whitened alike.
///
/// `None` if LS or IV has no estimate, or V is zero.
#[must_use]
pub fn wu_hausman(z: &Matrix, x: &Matrix, y: &[f64], layout: &RowLayout) -> Option<WuHausman> {
    let (rows, columns) = (x.rows(), x.columns());
    let (qr_x, q_z) = (PivotedQr::new(x), PivotedQr::new(z).thin_q());
    let q_x = qr_x.thin_q();
    let residual = without(&q_x, y);
    let v = residual_of_instruments(&q_z, x)?;
    let added = orthonormal(&without_columns(&q_x, &v));
    let delta = added.transpose_times(&residual);
    let (all, explained) = (norm(&residual).powi(2), norm(&delta).powi(2));
    let classical = f_test(all, columns, all - explained, columns + added.columns(), rows)?;
    let noise = RowNoise::of(&residual, layout);
    let robust = noise.covariance(&added).inverse_quadratic_form(&delta)?;
    let iv = IvEstimate::with_basis(&q_z, x, y, layout)?;
    let difference: Vec<f64> = iv.theta.iter().zip(&qr_x.solve(y)).map(|(a, b)| a - b).collect();
    Some(WuHausman {
        classical,
        robust: chi_squared_test(robust, added.columns())?,
        average_difference: iv.average(&difference)?,
        iv_deviation: iv.deviations(),
        difference,
    })
}

/// The columns of `X - Q Q^T X` that are not zero, each of length one, where Q is the basis of the instruments.
fn residual_of_instruments(q: &Matrix, x: &Matrix) -> Option<Matrix> {
    let left = without_columns(q, x);
    let noisy: Vec<usize> =
        (0..x.columns()).filter(|&c| norm(left.column(c)) > EXOGENOUS * norm(x.column(c))).collect();
    let mut left = left.select_columns(&noisy);
    for c in 0..left.columns() {
        let length = norm(left.column(c));
        left.column_mut(c).iter_mut().for_each(|v| *v /= length);
    }
    (!noisy.is_empty()).then_some(left)
}

/// `y - Q Q^T y`.
pub(super) fn without(q: &Matrix, y: &[f64]) -> Vec<f64> {
    let explained = q.times(&q.transpose_times(y));
    y.iter().zip(explained).map(|(y, e)| y - e).collect()
}

fn without_columns(q: &Matrix, a: &Matrix) -> Matrix {
    let explained = q.times_matrix(&q.transposed_times(a));
    a.plus(&explained, -1.0)
}

/// An orthonormal basis of the columns.
fn orthonormal(a: &Matrix) -> Matrix {
    let qr = PivotedQr::new(a);
    let rank = qr.rank(DEPENDENT);
    qr.thin_q().select_columns(&(0..rank).collect::<Vec<_>>())
}

/// An IV estimate in the basis of its instruments, with the covariance of autocorrelated rows.
pub(super) struct IvEstimate {
    pub(super) theta: Vec<f64>,
    pub(super) residual: Vec<f64>,
    /// `M = Q^T X` with `Z = Q R`.
    projected: Matrix,
    /// Covariance of `Q^T e`.
    covariance: Matrix,
}

impl IvEstimate {
    pub(super) fn with_basis(q: &Matrix, x: &Matrix, y: &[f64], layout: &RowLayout) -> Option<Self> {
        let projected = q.transposed_times(x);
        let qr = PivotedQr::new(&projected);
        let theta = qr.solve(&q.transpose_times(y));
        let residual: Vec<f64> = x.times(&theta).iter().zip(y).map(|(p, y)| y - p).collect();
        let covariance = RowNoise::of(&residual, layout).covariance(q);
        let usable = qr.rank(DEPENDENT * DEPENDENT) == x.columns() && theta.iter().all(|t| t.is_finite());
        usable.then_some(Self { theta, residual, projected, covariance })
    }

    /// Standard deviations of the estimates.
    pub(super) fn deviations(&self) -> Vec<f64> {
        let inverse = PivotedQr::new(&self.projected).solve_matrix(&Matrix::identity(self.theta.len()));
        let covariance = inverse.times_matrix(&self.covariance).times_matrix(&inverse.transpose());
        (0..self.theta.len()).map(|i| covariance.at(i, i).max(0.0).sqrt()).collect()
    }

    /// The average size of a difference in standard deviations of the estimate, correlations considered.
    pub(super) fn average(&self, difference: &[f64]) -> Option<f64> {
        let squares = self.covariance.inverse_quadratic_form(&self.projected.times(difference))?;
        Some((squares / difference.len() as f64).sqrt())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) struct Example {
        pub(crate) z: Matrix,
        pub(crate) x: Matrix,
        pub(crate) y: Vec<f64>,
    }

    /// Two regressors with noise, one without, and y with the noise of the first.
    pub(crate) fn example() -> Example {
        let k = |k: usize| k as f64;
        let clean = |i: usize, j: usize| [(0.05 * k(i)).sin(), (0.11 * k(i)).cos(), 1.0][j];
        let noise = |i: usize, j: usize| [(1.7 * k(i * i)).sin(), (1.3 * k(i * i) + 2.0).sin(), 0.0][j];
        let z = Matrix::from_fn(200, 3, clean);
        let x = Matrix::from_fn(200, 3, |i, j| clean(i, j) + 0.5 * noise(i, j));
        let true_part = x.times(&[2.0, -1.0, 0.5]);
        let error = |i: usize| 0.3 * noise(i, 0) + 0.4 * (2.3 * k(i * i) + 1.0).cos();
        let y = true_part.iter().enumerate().map(|(i, t)| t + error(i)).collect();
        Example { z, x, y }
    }

    fn one_block() -> RowLayout {
        RowLayout::new(1, &[200])
    }

    /// statsmodels 0.15.0: OLS of y on X and V against OLS on X, `compare_f_test`.
    #[test]
    fn the_statistic_is_that_of_the_augmented_regression() {
        let Example { z, x, y } = example();
        let test = wu_hausman(&z, &x, &y, &one_block()).unwrap();
        assert!((test.classical.statistic / 27.185_980_319_573_68 - 1.0).abs() < 1e-9, "{:?}", test.classical);
        assert!((test.classical.p_value / 3.852_402_641_479e-11 - 1.0).abs() < 1e-6, "{:?}", test.classical);
        assert_eq!((test.classical.numerator_freedom, test.robust.freedom), (2, 2));
        assert!(test.robust.p_value < 1e-6, "{:?}", test.robust);
    }

    #[test]
    fn exact_regressors_leave_nothing_to_test() {
        let Example { z, y, .. } = example();
        assert!(wu_hausman(&z, &z, &y, &one_block()).is_none());
    }
}
