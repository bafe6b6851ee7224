//! Weighted least squares with an orthonormal basis of X, on which changes of y are tried without another
//! factorisation.

use std::ops::Range;

use super::numbers::{deviation, rms};
use crate::linear_algebra::{Matrix, PivotedQr, dot};

/// Relative size of the last diagonal entries of R below which a column counts as dependent, as for the estimate.
const RANK_TOLERANCE: f64 = 1e-10;

/// Least squares with every coordinate's rows divided by the standard deviation of its torque. Columns may depend on one
/// another.
///
/// What the parameters leave of any other vector of rows is one projection ([`Self::unexplained`]), and of one in which a
/// single coordinate differs a projection of that coordinate's rows ([`Self::squares_with`]).
pub(super) struct OrthogonalFit {
    /// Weighted.
    pub(super) x: Matrix,
    /// Factor of each row.
    weights: Vec<f64>,
    /// Orthonormal basis of the columns of x.
    basis: Matrix,
    pub(super) qr: PivotedQr,
    pub(super) rank: usize,
    /// Weighted.
    pub(super) y: Vec<f64>,
    /// y along the basis.
    projection: Vec<f64>,
    pub(super) residual: Vec<f64>,
    /// Squared length of the residual.
    pub(super) squares: f64,
    coordinates: usize,
}

impl OrthogonalFit {
    /// The fit of unweighted rows, as many for each of `coordinates` coordinates, one after the other.
    pub(super) fn new(x: &Matrix, y: &[f64], coordinates: usize) -> Self {
        let weights = weights(y, coordinates);
        let x = x.scale_rows(&weights);
        let y: Vec<f64> = y.iter().zip(&weights).map(|(y, w)| y * w).collect();
        let qr = PivotedQr::new(&x);
        let rank = qr.rank(RANK_TOLERANCE);
        let basis = qr.thin_q().select_columns(&(0..rank).collect::<Vec<_>>());
        let residual = project_out(&basis, &y);
        let squares = dot(&residual, &residual);
        let projection = (0..rank).map(|c| dot(basis.column(c), &y)).collect();
        Self { x, weights, basis, qr, rank, y, projection, residual, squares, coordinates }
    }

    /// The part of a vector of unweighted rows that no parameters explain, weighted.
    pub(super) fn unexplained(&self, rows: &[f64]) -> Vec<f64> {
        project_out(&self.basis, &self.weighted(rows))
    }

    /// A vector of unweighted rows, weighted.
    pub(super) fn weighted(&self, rows: &[f64]) -> Vec<f64> {
        rows.iter().zip(&self.weights).map(|(r, w)| r * w).collect()
    }

    /// Parameters; those that depend on others are zero.
    pub(super) fn theta(&self) -> Vec<f64> {
        self.theta_of_weighted(&self.y)
    }

    /// The same for another vector of unweighted rows.
    pub(super) fn theta_of(&self, rows: &[f64]) -> Vec<f64> {
        self.theta_of_weighted(&self.weighted(rows))
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
    pub(super) fn squares_with(&self, rows: &[f64], j: usize) -> f64 {
        let own = self.rows_of(j);
        let change: Vec<f64> = own.clone().map(|i| rows[i] * self.weights[i] - self.y[i]).collect();
        let norm = |y: &[f64]| dot(y, y);
        let total = norm(&self.y) + own.clone().zip(&change).map(|(i, c)| c * (c + 2.0 * self.y[i])).sum::<f64>();
        let along = |c: usize| self.projection[c] + dot(&self.basis.column(c)[own.clone()], &change);
        total - (0..self.rank).map(|c| along(c).powi(2)).sum::<f64>()
    }

    /// Variance of the weighted residual.
    pub(super) fn variance(&self) -> f64 {
        self.squares / self.y.len().saturating_sub(self.rank).max(1) as f64
    }

    /// Rms residual relative to the rms torque, without weights.
    pub(super) fn relative_error(&self) -> f64 {
        let unweighted = |rows: &[f64]| rows.iter().zip(&self.weights).map(|(r, w)| (r / w).powi(2)).sum::<f64>();
        (unweighted(&self.residual) / unweighted(&self.y)).sqrt()
    }

    /// Rms residual of coordinate `j`, relative to the standard deviation of its torque.
    pub(super) fn joint_error(&self, j: usize) -> f64 {
        rms(&self.residual[self.rows_of(j)])
    }

    fn rows_of(&self, j: usize) -> Range<usize> {
        let rows = self.y.len() / self.coordinates;
        j * rows..(j + 1) * rows
    }
}

/// For each row one over the standard deviation of its coordinate's torque; one where that is zero.
fn weights(y: &[f64], coordinates: usize) -> Vec<f64> {
    let rows = y.len() / coordinates;
    let weight = |y: &[f64]| Some(deviation(y)).filter(|s| *s > 0.0).map_or(1.0, f64::recip);
    y.chunks(rows).flat_map(|y| std::iter::repeat_n(weight(y), y.len())).collect()
}

/// The squared residual of [`OrthogonalFit`], from the triangle of `[X y]` alone.
pub(super) fn squared_residual(x: &Matrix, y: &[f64], coordinates: usize) -> f64 {
    let weights = weights(y, coordinates);
    let xw = x.scale_rows(&weights);
    let yw: Vec<f64> = y.iter().zip(&weights).map(|(y, w)| y * w).collect();
    let columns = x.columns();
    let triangle = Matrix::beside(&[&xw, &Matrix::from_fn(yw.len(), 1, |i, _| yw[i])]).triangular_factor();
    let of_x = triangle.select_columns(&(0..columns).collect::<Vec<_>>());
    if triangle.rows() <= columns || PivotedQr::new(&of_x).rank(RANK_TOLERANCE) < columns {
        return OrthogonalFit::new(x, y, coordinates).squares;
    }
    triangle.at(columns, columns).powi(2)
}

/// A vector less its part in the span of orthonormal columns.
fn project_out(basis: &Matrix, vector: &[f64]) -> Vec<f64> {
    let mut rest = vector.to_vec();
    for j in 0..basis.columns() {
        let along = dot(basis.column(j), &rest);
        rest.iter_mut().zip(basis.column(j)).for_each(|(r, b)| *r -= along * b);
    }
    rest
}
