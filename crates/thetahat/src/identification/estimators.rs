use serde::{Deserialize, Serialize};

use crate::linear_algebra::{Matrix, PivotedQr, norm};

/// An estimator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Least squares on the measured motion (8).
    IdimLs,
    /// Instrumental variables from a simulated motion (10).
    IdimIv,
    /// Least squares on the simulated motion (19).
    Didim,
}

impl Method {
    /// Its name, lower case with hyphens.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::IdimLs => "idim-ls",
            Self::IdimIv => "idim-iv",
            Self::Didim => "didim",
        }
    }
}

/// What the squared residual is divided by for the variance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Divisor {
    /// Rows less parameters: the unbiased one.
    #[default]
    RowsMinusParameters,
    /// Rows less one, as some published figures have it.
    RowsMinusOne,
}

/// Why there is no estimate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EstimationError {
    /// The motion does not separate the parameters.
    #[error("the motion separates only {rank} of {columns} parameters; columns that depend on others: {dependent:?}")]
    NotIdentifiable {
        /// Rank of the matrix.
        rank: usize,
        /// Number of parameters.
        columns: usize,
        /// Columns, from zero, that the others span.
        dependent: Vec<usize>,
    },
    /// There is no finite estimate or error.
    #[error("no finite estimate: the torques are zero in the window, or values are too large; check the units")]
    NotFinite,
    /// IV and DIDIM need the observation matrix of a simulated motion.
    #[error("this method needs instruments from a simulation: give a [controller]")]
    NoInstruments,
    /// There are not more rows than parameters.
    #[error("{rows} rows cannot determine {columns} parameters; take a longer record or a smaller decimation factor")]
    TooFewRows {
        /// Rows.
        rows: usize,
        /// Parameters.
        columns: usize,
    },
}

/// An estimate with its statistics.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The parameters.
    pub theta: Vec<f64>,
    /// Their classical standard deviations.
    pub standard_deviation: Vec<f64>,
    /// `y_hat`: `X theta` for LS and IV, `Z theta` for DIDIM, unweighted.
    pub prediction: Vec<f64>,
    /// `100 |y - y_hat| / |y|`, unweighted.
    pub relative_error_percent: f64,
    /// Ratio of the extreme singular values of the matrix that is solved: X, or the instruments' projection of it.
    pub condition_number: f64,
}

/// Size of a diagonal entry of R, relative to the largest and with columns of equal norm, below which a column counts as
/// dependent: a hundredth of what the rounding of a record in double precision leaves.
const RANK_TOLERANCE: f64 = 1e-10;

/// IDIM-LS (8): `theta = X^+ y`, with covariance `s^2 (X^T X)^-1` and `s^2` from the residual.
///
/// The covariance assumes an exact X and independent rows of equal variance. With `weights`, one for each row, X, y and
/// the residual in `s^2` are whitened (WLS).
///
/// # Errors
/// [`EstimationError`] where the columns are dependent.
pub fn idim_ls(x: &Matrix, y: &[f64], weights: Option<&[f64]>, divisor: Divisor) -> Result<Fit, EstimationError> {
    let (xw, yw) = (whiten_matrix(x, weights), whiten(y, weights));
    let qr = full_rank(&xw)?;
    let theta = qr.solve(&yw);
    let inverse_gram = qr.inverse_gram();
    let variance = variance(&yw, &xw.times(&theta), theta.len(), divisor);
    let diagonal = (0..theta.len()).map(|i| inverse_gram.at(i, i));
    Fit::new(y, x.times(&theta), theta, diagonal, variance, qr.thin_r().condition_number())
}

/// IDIM-IV (9): `theta = (Z^T X)^-1 Z^T y`, with covariance `s^2 (Z^T X)^-1 Z^T Z (X^T Z)^-1`.
///
/// With `Z = Q R`, `theta = (Q^T X)^-1 Q^T y` and the covariance is `s^2 (Q^T X)^-1 (Q^T X)^-T`. It assumes instruments
/// that are independent of the noise and rows of equal variance. Weights whiten X, y and Z alike.
///
/// # Errors
/// [`EstimationError`] where Z or the product has dependent columns.
pub fn idim_iv(
    z: &Matrix,
    x: &Matrix,
    y: &[f64],
    weights: Option<&[f64]>,
    divisor: Divisor,
) -> Result<Fit, EstimationError> {
    let (zw, xw, yw) = (whiten_matrix(z, weights), whiten_matrix(x, weights), whiten(y, weights));
    let q = full_rank(&zw)?.thin_q();
    let projected = q.transposed_times(&xw);
    let qr = full_rank(&projected)?;
    let theta = qr.solve(&q.transpose_times(&yw));
    let inverse = qr.solve_matrix(&Matrix::identity(projected.rows()));
    let variance = variance(&yw, &xw.times(&theta), theta.len(), divisor);
    let columns = theta.len();
    let diagonal = (0..columns).map(|i| (0..columns).map(|k| inverse.at(i, k).powi(2)).sum());
    Fit::new(y, x.times(&theta), theta, diagonal, variance, projected.condition_number())
}

/// One step of DIDIM (19): `theta = Z^+ y`, with covariance `s^2 (Z^T Z)^-1`.
///
/// The covariance assumes an exact simulator: the bias that a wrong one brings is not in it.
///
/// # Errors
/// [`EstimationError`] where Z has dependent columns.
pub fn didim(z: &Matrix, y: &[f64], weights: Option<&[f64]>, divisor: Divisor) -> Result<Fit, EstimationError> {
    idim_ls(z, y, weights, divisor)
}

/// The weight of each row, one over the standard deviation of its joint's residual, from a fit with equal weights.
///
/// The deviation of a joint divides by its rows less the parameters that act on it. A joint without residual weighs as
/// much as the best of the others.
#[must_use]
pub fn joint_weights(x: &Matrix, y: &[f64], fit: &Fit, joints: usize) -> Vec<f64> {
    let rows = y.len() / joints;
    let of_joint = |j: usize| j * rows..(j + 1) * rows;
    let acts = |c: usize, j: usize| x.column(c)[of_joint(j)].iter().any(|v| *v != 0.0);
    let deviation = |j: usize| {
        let residual: f64 = of_joint(j).map(|k| (y[k] - fit.prediction[k]).powi(2)).sum();
        let acting = (0..x.columns()).filter(|&c| acts(c, j)).count();
        (residual / rows.saturating_sub(acting).max(1) as f64).sqrt()
    };
    let deviations: Vec<f64> = (0..joints).map(deviation).collect();
    let smallest = deviations.iter().copied().filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
    let smallest = if smallest.is_finite() { smallest } else { 1.0 };
    deviations.iter().flat_map(|d| std::iter::repeat_n(1.0 / d.max(smallest), rows)).collect()
}

impl Fit {
    fn new(
        y: &[f64],
        prediction: Vec<f64>,
        theta: Vec<f64>,
        covariance_diagonal: impl Iterator<Item = f64>,
        variance: f64,
        condition_number: f64,
    ) -> Result<Self, EstimationError> {
        let fit = Self {
            standard_deviation: covariance_diagonal.map(|v| (variance * v).sqrt()).collect(),
            relative_error_percent: relative_error_percent(y, &prediction),
            theta,
            prediction,
            condition_number,
        };
        let numbers = fit.theta.iter().chain(&fit.standard_deviation).chain([&fit.relative_error_percent]);
        let finite = numbers.copied().all(f64::is_finite);
        if finite { Ok(fit) } else { Err(EstimationError::NotFinite) }
    }

    /// Sum of the squared, unweighted residual.
    #[must_use]
    pub fn residual_sum_of_squares(&self, y: &[f64]) -> f64 {
        y.iter().zip(&self.prediction).map(|(y, p)| (y - p).powi(2)).sum()
    }
}

/// `100 |y - y_hat| / |y|`.
#[must_use]
pub fn relative_error_percent(y: &[f64], prediction: &[f64]) -> f64 {
    let residual: Vec<f64> = y.iter().zip(prediction).map(|(y, p)| y - p).collect();
    100.0 * norm(&residual) / norm(y)
}

pub(super) fn full_rank(a: &Matrix) -> Result<PivotedQr, EstimationError> {
    if a.rows() < a.columns() {
        return Err(EstimationError::TooFewRows { rows: a.rows(), columns: a.columns() });
    }
    let qr = PivotedQr::with_equal_columns(a);
    let rank = qr.rank(RANK_TOLERANCE);
    if rank == a.columns() {
        return Ok(qr);
    }
    Err(EstimationError::NotIdentifiable { rank, columns: a.columns(), dependent: qr.pivots()[rank..].to_vec() })
}

pub(super) fn whiten_matrix(a: &Matrix, weights: Option<&[f64]>) -> Matrix {
    weights.map_or_else(|| a.clone(), |w| a.scale_rows(w))
}

fn whiten(y: &[f64], weights: Option<&[f64]>) -> Vec<f64> {
    weights.map_or_else(|| y.to_vec(), |w| y.iter().zip(w).map(|(y, w)| w * y).collect())
}

fn variance(y: &[f64], prediction: &[f64], parameters: usize, divisor: Divisor) -> f64 {
    let squares: f64 = y.iter().zip(prediction).map(|(y, p)| (y - p).powi(2)).sum();
    let freedom = match divisor {
        Divisor::RowsMinusParameters => y.len().saturating_sub(parameters),
        Divisor::RowsMinusOne => y.len() - 1,
    };
    squares / freedom.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: usize = 400;

    /// Two regressors, one observed with an error that also enters y as feedback would make it.
    fn example() -> (Matrix, Matrix, Vec<f64>) {
        let clean = Matrix::from_fn(ROWS, 2, |k, j| (0.05 * (k * (j + 1)) as f64).sin());
        let noise = |k: usize| 0.5 * ((12.9898 * k as f64).sin() * 43758.5453).fract();
        let x = Matrix::from_fn(ROWS, 2, |k, j| clean.at(k, j) + if j == 0 { noise(k) } else { 0.0 });
        let y = (0..ROWS).map(|k| 2.0 * clean.at(k, 0) - 3.0 * clean.at(k, 1)).collect();
        (x, clean, y)
    }

    #[test]
    fn iv_is_consistent_where_ls_is_not() {
        let (x, z, y) = example();
        let ls = idim_ls(&x, &y, None, Divisor::default()).unwrap();
        let iv = idim_iv(&z, &x, &y, None, Divisor::default()).unwrap();
        assert!((ls.theta[0] - 2.0).abs() > 5.0 * ls.standard_deviation[0]);
        assert!((iv.theta[0] - 2.0).abs() < 3.0 * iv.standard_deviation[0]);
    }

    #[test]
    fn iv_with_its_own_regressors_is_ls() {
        let (x, _, y) = example();
        let ls = idim_ls(&x, &y, None, Divisor::default()).unwrap();
        let iv = idim_iv(&x, &x, &y, None, Divisor::default()).unwrap();
        for i in 0..2 {
            assert!((ls.theta[i] - iv.theta[i]).abs() < 1e-12);
            assert!((ls.standard_deviation[i] - iv.standard_deviation[i]).abs() < 1e-12);
        }
        assert!((ls.condition_number - iv.condition_number).abs() < 1e-9);
    }

    #[test]
    fn iv_is_the_formula_of_the_paper() {
        let (x, z, y) = example();
        let weights: Vec<f64> = (0..ROWS).map(|k| 1.0 + (k % 3) as f64).collect();
        let fit = idim_iv(&z, &x, &y, Some(&weights), Divisor::default()).unwrap();
        let (zw, xw) = (z.scale_rows(&weights), x.scale_rows(&weights));
        let yw: Vec<f64> = y.iter().zip(&weights).map(|(y, w)| y * w).collect();
        let cross = zw.transpose().times_matrix(&xw).inverse().unwrap();
        let direct = cross.times(&zw.transpose().times(&yw));
        let gram = cross.times_matrix(&zw.transpose().times_matrix(&zw)).times_matrix(&cross.transpose());
        let residual: f64 = xw.times(&direct).iter().zip(&yw).map(|(p, y)| (y - p).powi(2)).sum();
        for (i, expected) in direct.iter().enumerate() {
            assert!((fit.theta[i] - expected).abs() < 1e-11);
            let sd = (residual / (ROWS - 2) as f64 * gram.at(i, i)).sqrt();
            assert!((fit.standard_deviation[i] - sd).abs() < 1e-12);
        }
    }

    #[test]
    fn whitening_acts_on_all_three_alike() {
        // Rows of weight zero are as good as absent.
        let (x, z, y) = example();
        let weights: Vec<f64> = (0..ROWS).map(|k| if k % 2 == 0 { 1.0 } else { 0.0 }).collect();
        let keep: Vec<bool> = (0..ROWS).map(|k| k % 2 == 0).collect();
        let half: Vec<f64> = y.iter().step_by(2).copied().collect();
        let weighted = idim_iv(&z, &x, &y, Some(&weights), Divisor::default()).unwrap();
        let cut = idim_iv(&z.select_rows(&keep), &x.select_rows(&keep), &half, None, Divisor::default()).unwrap();
        assert!((weighted.theta[0] - cut.theta[0]).abs() < 1e-12);
    }

    #[test]
    fn torques_of_zero_give_no_estimate() {
        let (x, _, _) = example();
        let result = idim_ls(&x, &[0.0; ROWS], None, Divisor::default());
        assert_eq!(result, Err(EstimationError::NotFinite));
    }

    #[test]
    fn a_dependent_column_is_named() {
        let x = Matrix::from_fn(ROWS, 3, |k, j| if j == 2 { 0.0 } else { (0.1 * (k * (j + 1)) as f64).cos() });
        let error = idim_ls(&x, &vec![1.0; ROWS], None, Divisor::default()).unwrap_err();
        assert_eq!(error, EstimationError::NotIdentifiable { rank: 2, columns: 3, dependent: vec![2] });
    }
}
