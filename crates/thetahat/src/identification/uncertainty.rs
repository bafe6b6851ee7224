use super::{
    EstimationError, Fit, Method,
    estimators::{full_rank, whiten_matrix},
};
use crate::{
    linear_algebra::Matrix,
    statistics::{EstimatedVariance, RowBlocks, Sandwich},
};

/// How far an estimate may be off, with errors that are correlated in time and differ between joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Standard deviation of each parameter, by [`Sandwich::robust`].
    pub standard_deviation: Vec<f64>,
    /// Degrees of freedom of each standard deviation.
    pub freedom: Vec<f64>,
    /// Intervals that hold the true values 95 times in a hundred, where the method's assumptions hold.
    pub interval_95: Vec<[f64; 2]>,
}

/// The matrix A of a method, rows by parameters: `theta_hat - theta = A^T e`, for errors e of the rows of y.
///
/// LS: `W X_w (X_w^T X_w)^-1`; IV: `W Q (X_w^T Q)^-1` with `Z_w = Q R`; DIDIM: as LS with Z in place of X. W are the weights,
/// index w is whitened with them.
///
/// # Errors
/// [`EstimationError`] where the method has no estimate, or has no instruments.
pub fn influence(
    method: Method,
    x: &Matrix,
    z: Option<&Matrix>,
    weights: Option<&[f64]>,
) -> Result<Matrix, EstimationError> {
    let influence = match (method, z) {
        (Method::IdimLs, _) => least_squares(&whiten_matrix(x, weights))?,
        (Method::IdimIv, Some(z)) => instrumental(&whiten_matrix(z, weights), &whiten_matrix(x, weights))?,
        (Method::Didim, Some(z)) => least_squares(&whiten_matrix(z, weights))?,
        (Method::IdimIv | Method::Didim, None) => return Err(EstimationError::NoInstruments),
    };
    Ok(weights.map_or(influence.clone(), |w| influence.scale_rows(w)))
}

fn least_squares(x: &Matrix) -> Result<Matrix, EstimationError> {
    Ok(x.times_matrix(&full_rank(x)?.inverse_gram()))
}

fn instrumental(z: &Matrix, x: &Matrix) -> Result<Matrix, EstimationError> {
    let q = full_rank(z)?.thin_q();
    let projected = q.transposed_times(x);
    let inverse = full_rank(&projected)?.solve_matrix(&Matrix::identity(projected.rows()));
    Ok(q.times_matrix(&inverse.transpose()))
}

/// Standard deviations and intervals of a fit of the rows laid out as `rows`.
///
/// The interval is that of Student's t with each parameter's own degrees of freedom. It holds what [`Sandwich::robust`]
/// assumes, and what the method does: a filter's bias in X, or a wrong simulator in DIDIM, moves the whole interval.
///
/// # Errors
/// As [`influence`], and where there is no finite interval.
pub fn uncertainty(
    method: Method,
    (x, z, y): (&Matrix, Option<&Matrix>, &[f64]),
    weights: Option<&[f64]>,
    fit: &Fit,
    rows: &RowBlocks,
) -> Result<Uncertainty, EstimationError> {
    let influence = influence(method, x, z, weights)?;
    let design = z.filter(|_| method == Method::Didim).unwrap_or(x);
    let residual: Vec<f64> = y.iter().zip(&fit.prediction).map(|(y, p)| y - p).collect();
    let variances = Sandwich { design, influence: &influence, residual: &residual, rows }.robust();
    Uncertainty::new(&fit.theta, &variances)
}

impl Uncertainty {
    /// The intervals of estimates from the variances of their errors.
    ///
    /// # Errors
    /// [`EstimationError::NotFinite`] where there is none.
    pub fn new(theta: &[f64], variances: &[EstimatedVariance]) -> Result<Self, EstimationError> {
        let interval = |(theta, v): (&f64, &EstimatedVariance)| {
            v.half_width_95().map(|h| [theta - h, theta + h]).ok_or(EstimationError::NotFinite)
        };
        Ok(Self {
            standard_deviation: variances.iter().map(|v| v.variance.sqrt()).collect(),
            freedom: variances.iter().map(|v| v.freedom).collect(),
            interval_95: theta.iter().zip(variances).map(interval).collect::<Result<_, _>>()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::{Divisor, didim, idim_iv, idim_ls};

    const ROWS: usize = 120;

    fn matrices() -> (Matrix, Matrix, Vec<f64>, Vec<f64>) {
        let x = Matrix::from_fn(ROWS, 3, |k, i| (0.11 * (k * (i + 1)) as f64).sin() + 0.1 * i as f64);
        let z = Matrix::from_fn(ROWS, 3, |k, i| (0.11 * (k * (i + 1)) as f64 + 0.2).sin());
        let y = (0..ROWS).map(|k| (0.3 * k as f64).cos() + x.at(k, 1)).collect();
        let weights = (0..ROWS).map(|k| 1.0 + (k % 4) as f64).collect();
        (x, z, y, weights)
    }

    /// An estimate is its influence times y, and the classical variance is `s^2 A^T A` where nothing is weighted.
    #[test]
    fn the_influence_is_what_turns_y_into_the_estimate() {
        let (x, z, y, weights) = matrices();
        for weights in [None, Some(&weights[..])] {
            for method in [Method::IdimLs, Method::IdimIv, Method::Didim] {
                let fit = match method {
                    Method::IdimLs => idim_ls(&x, &y, weights, Divisor::default()),
                    Method::IdimIv => idim_iv(&z, &x, &y, weights, Divisor::default()),
                    Method::Didim => didim(&z, &y, weights, Divisor::default()),
                };
                let (fit, a) = (fit.unwrap(), influence(method, &x, Some(&z), weights).unwrap());
                for (i, theta) in a.transpose().times(&y).into_iter().enumerate() {
                    assert!((theta - fit.theta[i]).abs() < 1e-12, "{method:?}");
                }
                if weights.is_none() {
                    let s = (fit.residual_sum_of_squares(&y) / (ROWS - 3) as f64).sqrt();
                    let norm: f64 = a.column(1).iter().map(|a| a * a).sum::<f64>().sqrt();
                    assert!((s * norm / fit.standard_deviation[1] - 1.0).abs() < 1e-12, "{method:?}");
                }
            }
        }
    }

    #[test]
    fn intervals_lie_about_the_estimates_as_wide_as_students_t() {
        let variances = [EstimatedVariance { variance: 4.0, freedom: 5.0 }; 2];
        let found = Uncertainty::new(&[1.0, -3.0], &variances).unwrap();
        let half = 2.0 * 2.570_581_835_636_314;
        for ([low, high], theta) in found.interval_95.into_iter().zip([1.0, -3.0]) {
            assert!((low - theta + half).abs() < 1e-12 && (high - theta - half).abs() < 1e-12);
        }
    }

    #[test]
    fn without_instruments_there_is_no_influence() {
        let (x, ..) = matrices();
        assert_eq!(influence(Method::IdimIv, &x, None, None), Err(EstimationError::NoInstruments));
    }
}
