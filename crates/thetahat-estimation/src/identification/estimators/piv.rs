//! Instrumental variables on rows whose noise is made white.

use super::{
    estimator::{Estimator, Weighting},
    iv::{self, IDIM_IV, idim_iv},
};
use crate::{
    identification::fit::{Divisor, EstimationError, Fit},
    regression::{Regression, RowBlock},
    statistics::Autoregressive,
};
use thetahat_ground::linear_algebra::Matrix;

/// Highest order of the noise of a joint, of each pass: the noise of small joints shows once those of large ones weigh no more than
/// they do.
const HIGHEST_ORDERS: [usize; 4] = [0, 0, 10, 10];
/// Fewest rows of each stretch of time for each coefficient: those of the first are without a past.
const ROWS_PER_COEFFICIENT: usize = 10;

pub(super) static IDIM_PIV: Estimator = Estimator {
    name: "idim-piv",
    equation: "(10)",
    weighting: Some(Weighting::None),
    estimate: |regression, z, divisor| idim_piv(regression, z.ok_or(EstimationError::NoInstruments)?, divisor),
    influence: |regression, z| influence(regression, z.ok_or(EstimationError::NoInstruments)?),
    ..IDIM_IV
};

/// IDIM-PIV: IDIM-IV of rows that are filtered by the inverse of their noise (M. Brunot, A. Janot, P. Young, F. Carrillo,
/// "An improved instrumental variable method for industrial robot model identification", Control Engineering Practice 74, 2018).
///
/// The noise of each joint is autoregressive, estimated from the residual with the order of the smallest Bayesian information
/// criterion, up to 10. The same filter, over the noise's standard deviation, applies to y, X and Z. The first passes estimate
/// variances alone.
///
/// # Errors
/// As [`idim_iv`], and [`EstimationError::NoTimeOrder`] for rows that do not follow one another in time.
fn idim_piv(regression: &Regression, z: &Matrix, divisor: Divisor) -> Result<Fit, EstimationError> {
    let white = WhiteRows::of(regression, z)?;
    let fit = idim_iv(&white.regression, &white.z, divisor)?;
    let theta = fit.theta.clone();
    Ok(fit.moved_to(theta, regression, &regression.x))
}

/// `W T^T A_w` with the influence `A_w` of the filtered rows, their filter T and the weights W.
fn influence(regression: &Regression, z: &Matrix) -> Result<Matrix, EstimationError> {
    let white = WhiteRows::of(regression, z)?;
    let of_white = iv::influence(&white.regression, &white.z)?;
    let back = white.filter.of_columns(&of_white, Filter::transposed);
    Ok(regression.whiten_matrix(&back).into_owned())
}

/// Rows filtered by the inverse of their noise.
struct WhiteRows {
    regression: Regression,
    z: Matrix,
    filter: Filter,
}

impl WhiteRows {
    fn of(regression: &Regression, z: &Matrix) -> Result<Self, EstimationError> {
        if !regression.is_in_time_order {
            return Err(EstimationError::NoTimeOrder);
        }
        let mut theta = idim_iv(regression, z, Divisor::default())?.theta;
        let mut white = Self::after(regression, z, &theta, HIGHEST_ORDERS[0]);
        for highest in &HIGHEST_ORDERS[1..] {
            theta = idim_iv(&white.regression, &white.z, Divisor::default())?.theta;
            white = Self::after(regression, z, &theta, *highest);
        }
        Ok(white)
    }

    /// The rows filtered by the inverse of the noise that an estimate leaves.
    fn after(regression: &Regression, z: &Matrix, theta: &[f64], highest: usize) -> Self {
        let residual = regression.residual(&regression.x.times(theta));
        let filter = Filter::of_noise(regression, &regression.whiten(&residual), highest);
        let x = filter.of_columns(&regression.whiten_matrix(&regression.x), Filter::applied);
        let y = filter.applied(&regression.whiten(&regression.y));
        let z = filter.of_columns(&regression.whiten_matrix(z), Filter::applied);
        Self { regression: regression.with_weights(None).with_matrix(x).with_measured(y), z, filter }
    }
}

/// The inverse of the noise of each joint: `(e_k - sum_i a_i e_(k-i)) / sigma`, zero for the first rows of a stretch of time, which
/// have no past.
struct Filter {
    blocks: Vec<RowBlock>,
    of_joints: Vec<Autoregressive>,
}

impl Filter {
    fn of_noise(regression: &Regression, residual: &[f64], highest: usize) -> Self {
        let layout = &regression.layout;
        let noise = |joint: usize| {
            let segments: Vec<&[f64]> = layout.of_joint(joint).map(|rows| &residual[rows]).collect();
            let shortest = segments.iter().map(|s| s.len()).min().unwrap_or(0);
            Autoregressive::fit(&segments, highest.min(shortest / ROWS_PER_COEFFICIENT))
        };
        Self { blocks: layout.blocks().to_vec(), of_joints: (0..layout.joints()).map(noise).collect() }
    }

    /// Each row that has a past, with the coefficients of its noise and one over their deviation; a joint without noise stays
    /// as it is.
    fn for_rows(&self, mut with: impl FnMut(usize, &[f64], f64)) {
        for block in &self.blocks {
            let Autoregressive { coefficients, innovation_variance } = &self.of_joints[block.joint];
            let scale = if *innovation_variance > 0.0 { innovation_variance.sqrt().recip() } else { 1.0 };
            block.rows.clone().skip(coefficients.len()).for_each(|k| with(k, coefficients, scale));
        }
    }

    /// `T e`.
    fn applied(&self, rows: &[f64]) -> Vec<f64> {
        let mut filtered = vec![0.0; rows.len()];
        self.for_rows(|k, coefficients, scale| {
            let past: f64 = coefficients.iter().enumerate().map(|(i, a)| a * rows[k - 1 - i]).sum();
            filtered[k] = scale * (rows[k] - past);
        });
        filtered
    }

    /// `T^T e`.
    fn transposed(&self, rows: &[f64]) -> Vec<f64> {
        let mut filtered = vec![0.0; rows.len()];
        self.for_rows(|k, coefficients, scale| {
            filtered[k] += scale * rows[k];
            coefficients.iter().enumerate().for_each(|(i, a)| filtered[k - 1 - i] -= a * scale * rows[k]);
        });
        filtered
    }

    fn of_columns(&self, matrix: &Matrix, way: fn(&Self, &[f64]) -> Vec<f64>) -> Matrix {
        let values = (0..matrix.columns()).flat_map(|c| way(self, matrix.column(c))).collect();
        Matrix::from_columns(matrix.rows(), values)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::regression::RowLayout;

    const ROWS: [usize; 2] = [300, 500];

    /// Two joints in two recordings with autoregressive noise, a regressor with an error, and instruments.
    fn example(seed: u64) -> (Regression, Matrix) {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let processes = [(vec![0.8], 1.0), (vec![1.2, -0.6], 0.01)];
        let mut noise = Vec::new();
        for (coefficients, innovation_variance) in processes {
            let process = Autoregressive { coefficients, innovation_variance };
            for rows in ROWS {
                let mut drawn = vec![0.0; rows];
                process.draw(100, &mut generator, &mut drawn);
                noise.extend(drawn);
            }
        }
        let z = Matrix::from_fn(noise.len(), 2, |k, j| (0.3 * (k * (j + 1)) as f64).sin());
        let x = Matrix::from_fn(noise.len(), 2, |k, j| z.at(k, j) + if j == 0 { 0.3 * noise[k] } else { 0.0 });
        let y = (0..noise.len()).map(|k| 2.0 * x.at(k, 0) - 3.0 * x.at(k, 1) + noise[k]).collect();
        (Regression::new(x, y, RowLayout::new(2, &ROWS)), z)
    }

    /// With the filter as a matrix T: `theta = (Z^T T^T T X)^-1 Z^T T^T T y`, and `theta_hat - theta = A^T e`.
    #[test]
    fn the_estimate_is_generalised_least_squares_with_instruments() {
        let (regression, z) = example(1);
        let filter = WhiteRows::of(&regression, &z).unwrap().filter;
        let rows = regression.y.len();
        let t = filter.of_columns(&Matrix::identity(rows), Filter::applied);
        let weighted = t.transposed_times(&t);
        let cross = z.transposed_times(&weighted.times_matrix(&regression.x)).inverse().unwrap();
        let direct = cross.times(&z.transpose_times(&weighted.times(&regression.y)));
        let fit = idim_piv(&regression, &z, Divisor::default()).unwrap();
        let found = influence(&regression, &z).unwrap();
        let error = found.transpose_times(&regression.residual(&regression.x.times(&[2.0, -3.0])));
        for i in 0..2 {
            assert!((fit.theta[i] - direct[i]).abs() < 1e-10);
            assert!((fit.theta[i] - [2.0, -3.0][i] - error[i]).abs() < 1e-10);
        }
    }

    /// The noise of the joints differs 100 times and is correlated: the deviations of IDIM-IV are nearly three times as large.
    #[test]
    fn errors_are_smaller_than_those_of_iv_and_as_large_as_predicted() {
        let runs = 60;
        let (mut squares, mut squares_of_iv, mut predicted) = (0.0, 0.0, 0.0);
        for seed in 0..runs {
            let (regression, z) = example(seed);
            let fit = idim_piv(&regression, &z, Divisor::default()).unwrap();
            let of_iv = idim_iv(&regression, &z, Divisor::default()).unwrap();
            squares += (fit.theta[1] + 3.0).powi(2);
            squares_of_iv += (of_iv.theta[1] + 3.0).powi(2);
            predicted += fit.covariance.at(1, 1);
        }
        assert!(squares < 0.2 * squares_of_iv, "{squares}, IV {squares_of_iv}");
        // A variance from 60 draws is known to 18 %.
        assert!((squares / predicted - 1.0).abs() < 0.54, "{squares}, predicted {predicted}");
    }

    #[test]
    fn rows_without_time_are_refused() {
        let (regression, z) = example(1);
        let regression = Regression { is_in_time_order: false, ..regression };
        assert_eq!(idim_piv(&regression, &z, Divisor::default()), Err(EstimationError::NoTimeOrder));
    }
}
