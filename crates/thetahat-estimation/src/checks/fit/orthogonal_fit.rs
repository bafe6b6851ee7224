//! Weighted least squares with an orthonormal basis of X: another y needs no other factorisation.

use std::ops::Range;

use crate::{
    checks::numbers::{deviation, rms},
    regression::{Regression, RowBlock},
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, dot};

/// Relative size of the last diagonal entries of R below which a column counts as dependent, as for the estimate.
const RANK_TOLERANCE: f64 = 1e-10;

/// Standard deviation of a torque, relative to its rms, up to which it is constant: rounding.
const CONSTANT: f64 = 1e-12;

/// Stretches of time, of which every other one is held out.
const STRETCHES: usize = 10;

/// Least squares with every coordinate's rows divided by the standard deviation of its torque. Columns may be linearly
/// dependent.
///
/// Another y needs one projection ([`Self::unexplained`]); a y that differs in one coordinate needs the projection of its
/// rows ([`Self::squares_with`]).
pub(in crate::checks) struct OrthogonalFit {
    /// The rows, with their weights.
    regression: Regression,
    /// Weighted.
    pub(in crate::checks) x: Matrix,
    /// Orthonormal basis of the columns of x.
    basis: Matrix,
    pub(in crate::checks) qr: PivotedQr,
    pub(in crate::checks) rank: usize,
    /// Weighted.
    pub(in crate::checks) y: Vec<f64>,
    /// Components of y along the basis.
    projection: Vec<f64>,
    pub(in crate::checks) residual: Vec<f64>,
    /// Squared length of the residual.
    pub(in crate::checks) squares: f64,
}

impl OrthogonalFit {
    /// The fit of the rows of one recording; their weights are ignored.
    pub(in crate::checks) fn new(regression: &Regression) -> Self {
        Self::with_weights(weighted(regression))
    }

    /// The same with zero weight for some of the rows.
    pub(in crate::checks) fn without(regression: &Regression, left_out: &[bool]) -> Self {
        let regression = weighted(regression);
        let ones = vec![1.0; left_out.len()];
        let weights = regression.weights().unwrap_or(&ones).iter().zip(left_out);
        let weights = weights.map(|(w, left_out)| if *left_out { 0.0 } else { *w }).collect();
        Self::with_weights(regression.with_weights(Some(weights)))
    }

    /// The same with every coordinate's rows divided by the root mean square of its own errors.
    pub(in crate::checks) fn weighted_by_errors(&self) -> Self {
        let ones = vec![1.0; self.y.len()];
        let weights = self.regression.weights().unwrap_or(&ones);
        let weight = |block: &RowBlock| weights[self.rows_of(block.joint).start] / self.joint_error(block.joint);
        Self::with_weights(self.regression.with_weights(Some(self.regression.layout.spread(weight))))
    }

    /// The errors of coordinate `j`, without weights.
    pub(in crate::checks) fn errors(&self, j: usize) -> Vec<f64> {
        let rows = self.rows_of(j);
        let weight = self.regression.weights().map_or(1.0, |weights| weights[rows.start]);
        self.residual[rows].iter().map(|e| e / weight).collect()
    }

    fn with_weights(regression: Regression) -> Self {
        let x = regression.whiten_matrix(&regression.x).into_owned();
        let y = regression.whiten(&regression.y).into_owned();
        let qr = PivotedQr::new(&x);
        let rank = qr.rank(RANK_TOLERANCE);
        let basis = qr.thin_q().select_columns(&(0..rank).collect::<Vec<_>>());
        let residual = project_out(&basis, &y);
        let squares = dot(&residual, &residual);
        let projection = (0..rank).map(|c| dot(basis.column(c), &y)).collect();
        Self { regression, x, basis, qr, rank, y, projection, residual, squares }
    }

    /// The part of a vector of unweighted rows that no parameters explain, in weighted rows.
    pub(in crate::checks) fn unexplained(&self, rows: &[f64]) -> Vec<f64> {
        project_out(&self.basis, &self.regression.whiten(rows))
    }

    /// The covariance of the parameters of a fit of full rank without some rows: independent errors, alike in weighted rows.
    pub(in crate::checks) fn covariance(&self, left_out: &[bool]) -> Matrix {
        let used = left_out.iter().filter(|left_out| !**left_out).count();
        let spread = self.squares / used.saturating_sub(self.rank).max(1) as f64;
        let (gram, size) = (self.qr.inverse_gram(), self.rank);
        Matrix::from_fn(size, size, |a, b| spread * gram.at(a, b))
    }

    /// The parameters; those that depend on others are zero.
    pub(in crate::checks) fn theta(&self) -> Vec<f64> {
        self.theta_of_weighted(&self.y)
    }

    /// The same for another vector of unweighted rows.
    pub(in crate::checks) fn theta_of(&self, rows: &[f64]) -> Vec<f64> {
        self.theta_of_weighted(&self.regression.whiten(rows))
    }

    fn theta_of_weighted(&self, y: &[f64]) -> Vec<f64> {
        if self.rank == self.x.columns() {
            return self.qr.solve(y);
        }
        let mut theta = vec![0.0; self.x.columns()];
        let independent = &self.qr.pivots()[..self.rank];
        let solution = PivotedQr::new(&self.x.select_columns(independent)).solve(y);
        independent.iter().zip(solution).for_each(|(&c, v)| theta[c] = v);
        theta
    }

    /// The squared residual with the rows of coordinate `j` taken from another vector of unweighted rows.
    pub(in crate::checks) fn squares_with(&self, rows: &[f64], j: usize) -> f64 {
        let own = self.rows_of(j);
        let other = self.regression.whiten(rows);
        let change: Vec<f64> = own.clone().map(|i| other[i] - self.y[i]).collect();
        let norm = |y: &[f64]| dot(y, y);
        let total = norm(&self.y) + own.clone().zip(&change).map(|(i, c)| c * (c + 2.0 * self.y[i])).sum::<f64>();
        let along = |c: usize| self.projection[c] + dot(&self.basis.column(c)[own.clone()], &change);
        total - (0..self.rank).map(|c| along(c).powi(2)).sum::<f64>()
    }

    /// Mean squared error of rows that are counted, relative to the torques' variances, on every other stretch of time with the
    /// parameters of the remaining stretches. `None` if these do not separate the parameters.
    pub(in crate::checks) fn held_out_squares(&self, is_counted: &[bool]) -> Option<f64> {
        let rows = self.regression.layout.block(0, 0).len();
        let is_even = |i: usize| ((i % rows) * STRETCHES / rows).is_multiple_of(2);
        let squares = |own: &dyn Fn(usize) -> bool| {
            let used: Vec<bool> = (0..self.y.len()).map(own).collect();
            let part = |y: bool| (0..self.y.len()).filter(move |i| own(*i) == y);
            let qr = PivotedQr::new(&self.x.select_rows(&used));
            let theta = qr.solve(&part(true).map(|i| self.y[i]).collect::<Vec<_>>());
            let error = |i: usize| self.y[i] - (0..self.x.columns()).map(|c| self.x.at(i, c) * theta[c]).sum::<f64>();
            let separates = qr.rank(RANK_TOLERANCE) == self.x.columns();
            separates.then(|| part(false).filter(|i| is_counted[*i]).map(|i| error(i).powi(2)).sum::<f64>())
        };
        let counted = is_counted.iter().filter(|is_counted| **is_counted).count();
        let enough = self.y.len() / 2 > self.x.columns() && rows > STRETCHES && counted > 0;
        let both = enough.then(|| Some(squares(&is_even)? + squares(&|i| !is_even(i))?)).flatten()?;
        Some(both / counted as f64)
    }

    /// Variance of the weighted residual.
    pub(in crate::checks) fn variance(&self) -> f64 {
        self.squares / self.y.len().saturating_sub(self.rank).max(1) as f64
    }

    /// Rms residual relative to the rms torque, without weights, over the rows with a weight above zero.
    pub(in crate::checks) fn relative_error(&self) -> f64 {
        let squares = |rows: &[f64]| self.unweighted(rows).map(|v| v.powi(2)).sum::<f64>();
        (squares(&self.residual) / squares(&self.y)).sqrt()
    }

    fn unweighted(&self, rows: &[f64]) -> impl Iterator<Item = f64> {
        let weights = self.regression.weights().into_iter().flatten();
        rows.iter().zip(weights).filter(|(_, w)| **w > 0.0).map(|(r, w)| r / w)
    }

    /// Rms residual of coordinate `j`, relative to the standard deviation of its torque.
    pub(in crate::checks) fn joint_error(&self, j: usize) -> f64 {
        rms(&self.residual[self.rows_of(j)])
    }

    /// The same per degree of freedom: its rows with a weight above zero, minus the parameters that they determine.
    pub(in crate::checks) fn joint_error_per_freedom(&self, j: usize) -> f64 {
        let rows = self.rows_of(j);
        let determined: f64 = (0..self.rank).map(|c| &self.basis.column(c)[rows.clone()]).map(|b| dot(b, b)).sum();
        let residual = &self.residual[rows.clone()];
        let weights = self.regression.weights();
        let used = rows.filter(|&i| weights.is_none_or(|weights| weights[i] > 0.0)).count();
        (dot(residual, residual) / (used as f64 - determined).max(1.0)).sqrt()
    }

    /// The part of a vector of weighted rows that no parameters explain.
    pub(in crate::checks) fn project_out(&self, weighted: &[f64]) -> Vec<f64> {
        project_out(&self.basis, weighted)
    }

    fn rows_of(&self, j: usize) -> Range<usize> {
        self.regression.layout.block(j, 0)
    }
}

/// The rows weighted by one over the standard deviation of their coordinate's torque, or by one if the torque is constant.
fn weighted(regression: &Regression) -> Regression {
    let weight = |y: &Vec<f64>| Some(deviation(y)).filter(|s| *s > CONSTANT * rms(y)).map_or(1.0, f64::recip);
    let weights: Vec<f64> = regression.layout.by_joint(&regression.y).iter().map(weight).collect();
    regression.with_weights(Some(regression.layout.spread(|block| weights[block.joint])))
}

/// The squared residual of [`OrthogonalFit`], from the triangular factor of `[X y]` alone.
pub(in crate::checks) fn squared_residual(regression: &Regression) -> f64 {
    let rows = weighted(regression);
    let (x, y) = (rows.whiten_matrix(&rows.x), rows.whiten(&rows.y));
    let columns = x.columns();
    let triangle = Matrix::side_by_side(&[&x, &Matrix::from_fn(y.len(), 1, |i, _| y[i])]).triangular_factor();
    let of_x = triangle.select_columns(&(0..columns).collect::<Vec<_>>());
    if triangle.rows() <= columns || PivotedQr::new(&of_x).rank(RANK_TOLERANCE) < columns {
        return OrthogonalFit::new(regression).squares;
    }
    triangle.at(columns, columns).powi(2)
}

/// A vector minus its part in the span of orthonormal columns.
fn project_out(basis: &Matrix, vector: &[f64]) -> Vec<f64> {
    let mut rest = vector.to_vec();
    for j in 0..basis.columns() {
        let along = dot(basis.column(j), &rest);
        rest.iter_mut().zip(basis.column(j)).for_each(|(r, b)| *r -= along * b);
    }
    rest
}
