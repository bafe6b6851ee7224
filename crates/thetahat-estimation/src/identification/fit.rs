use serde::Deserialize;

use crate::regression::{Regression, relative_error_percent};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr};

/// The divisor of the squared residual for the variance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Divisor {
    /// Rows less parameters: the unbiased one.
    #[default]
    RowsMinusParameters,
    /// Rows less one, as in some published figures.
    RowsMinusOne,
}

impl Divisor {
    fn freedom(self, rows: usize, parameters: usize) -> f64 {
        let freedom = match self {
            Self::RowsMinusParameters => rows.saturating_sub(parameters),
            Self::RowsMinusOne => rows.saturating_sub(1),
        };
        freedom.max(1) as f64
    }
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
    /// The noise of a series needs rows that follow one another in time.
    #[error("this method models the noise in time, and the rows of a reduction have no order: use idim-iv")]
    NoTimeOrder,
    /// There are not more rows than parameters.
    #[error(
        "{rows} rows cannot determine {columns} parameters; take a longer recording or a smaller decimation factor"
    )]
    TooFewRows {
        /// Rows.
        rows: usize,
        /// Parameters.
        columns: usize,
    },
}

/// The response of the loop simulated with parameters, in the rows of y.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedResponse {
    /// The simulated torques or positions, r.
    pub response: Vec<f64>,
    /// Their derivatives J with respect to the parameters (14), r x b.
    pub sensitivities: Matrix,
}

/// An estimate with its statistics.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The parameters.
    pub theta: Vec<f64>,
    /// Their classical covariance: independent rows of equal variance, after whitening.
    pub covariance: Matrix,
    /// Their classical standard deviations.
    pub standard_deviation: Vec<f64>,
    /// `y_hat`: `X theta` for LS and IV, `Z theta` for DIDIM, unweighted.
    pub prediction: Vec<f64>,
    /// `100 |y - y_hat| / |y|`, unweighted.
    pub relative_error_percent: f64,
    /// Ratio of the extreme singular values of the matrix that is solved: X, or the instruments' projection of it.
    pub condition_number: f64,
}

/// The solution of an estimator.
pub(super) struct Solved {
    pub(super) theta: Vec<f64>,
    /// The covariance of the parameters for rows of variance one, b x b.
    pub(super) unit_covariance: Matrix,
    pub(super) condition_number: f64,
}

impl Fit {
    /// The fit of a solution. `design` is the matrix that the parameters multiply in the prediction: X, or Z for DIDIM.
    ///
    /// # Errors
    /// [`EstimationError::NotFinite`] where a number is not finite.
    pub(super) fn new(
        regression: &Regression,
        design: &Matrix,
        divisor: Divisor,
        solved: Solved,
    ) -> Result<Self, EstimationError> {
        let whitened = regression.whiten_matrix(design).times(&solved.theta);
        let squares = regression.whiten(&regression.y).iter().zip(&whitened).map(|(y, p)| (y - p).powi(2)).sum();
        let prediction = design.times(&solved.theta);
        Self::with_squares(regression, divisor, solved, prediction, squares)
    }

    /// The fit with other parameters, for example those of a constrained estimate; standard deviations stay those of the free one.
    #[must_use]
    pub fn moved_to(self, theta: Vec<f64>, regression: &Regression, design: &Matrix) -> Self {
        let prediction = design.times(&theta);
        let relative_error_percent = relative_error_percent(&regression.y, &prediction);
        Self { theta, prediction, relative_error_percent, ..self }
    }

    /// The fit of a simulated response to y, with the covariance of the regression linearised there.
    ///
    /// # Errors
    /// [`EstimationError`] where the sensitivities have dependent columns or a number is not finite.
    pub(super) fn of_response(
        regression: &Regression,
        simulated: &SimulatedResponse,
        theta: &[f64],
        divisor: Divisor,
    ) -> Result<Self, EstimationError> {
        let qr = full_rank(&regression.whiten_matrix(&simulated.sensitivities))?;
        let (unit_covariance, condition_number) = (qr.inverse_gram(), qr.thin_r().condition_number());
        let solved = Solved { theta: theta.to_vec(), unit_covariance, condition_number };
        let residual = regression.residual(&simulated.response);
        let squares = regression.whiten(&residual).iter().map(|e| e * e).sum();
        Self::with_squares(regression, divisor, solved, simulated.response.clone(), squares)
    }

    /// The fit of a solution with its prediction and the sum of its squared, weighted residual.
    fn with_squares(
        regression: &Regression,
        divisor: Divisor,
        Solved { theta, unit_covariance, condition_number }: Solved,
        prediction: Vec<f64>,
        squares: f64,
    ) -> Result<Self, EstimationError> {
        let size = theta.len();
        let rows = regression.y.len();
        let variance = squares / divisor.freedom(rows, size);
        // One, except for triangular factors: the same squares over the degrees of freedom of all rows that they represent.
        let represented = divisor.freedom(rows, size) / divisor.freedom(regression.rows_represented(), size);
        let fit = Self {
            standard_deviation: (0..size)
                .map(|i| (variance * unit_covariance.at(i, i)).sqrt() * represented.sqrt())
                .collect(),
            covariance: Matrix::from_fn(size, size, |i, j| represented * variance * unit_covariance.at(i, j)),
            relative_error_percent: relative_error_percent(&regression.y, &prediction),
            theta,
            prediction,
            condition_number,
        };
        let numbers = fit.theta.iter().chain(&fit.standard_deviation).chain([&fit.relative_error_percent]);
        let finite = numbers.copied().all(f64::is_finite);
        if finite { Ok(fit) } else { Err(EstimationError::NotFinite) }
    }
}

/// Size of a diagonal entry of R, relative to the largest and with columns of equal norm, below which a column counts as
/// dependent: a hundredth of the rounding error of a recording in double precision.
const RANK_TOLERANCE: f64 = 1e-10;

/// The factors of a matrix whose columns are independent.
///
/// # Errors
/// [`EstimationError`] where they are not.
pub(super) fn full_rank(a: &Matrix) -> Result<PivotedQr, EstimationError> {
    if a.rows() < a.columns() {
        return Err(EstimationError::TooFewRows { rows: a.rows(), columns: a.columns() });
    }
    require_full_rank(PivotedQr::with_equal_columns(a), a.columns())
}

/// The columns that are independent, and those that depend on them, in the order of their pivots.
pub(super) fn independent_columns(a: &Matrix) -> (Vec<usize>, Vec<usize>) {
    let qr = PivotedQr::with_equal_columns(a);
    let (kept, dependent) = qr.pivots().split_at(qr.rank(RANK_TOLERANCE));
    (kept.to_vec(), dependent.to_vec())
}

/// Checks that factors computed elsewhere have full rank.
///
/// # Errors
/// [`EstimationError::NotIdentifiable`] where columns depend on others.
pub(super) fn require_full_rank(qr: PivotedQr, columns: usize) -> Result<PivotedQr, EstimationError> {
    let rank = qr.rank(RANK_TOLERANCE);
    if rank == columns {
        return Ok(qr);
    }
    Err(EstimationError::NotIdentifiable { rank, columns, dependent: qr.pivots()[rank..].to_vec() })
}
