use std::{borrow::Cow, sync::Arc};

use super::layout::RowLayout;
use thetahat_ground::linear_algebra::{Matrix, norm};

/// Rows `y = X theta + e`, with weights and layout.
///
/// X and y are shared: copies with other weights need no memory.
#[derive(Debug, Clone)]
pub struct Regression {
    /// Observation matrix, r x b.
    pub x: Arc<Matrix>,
    /// Torques, r.
    pub y: Arc<Vec<f64>>,
    /// Factor of each row of y, X and Z; `None` if all are one.
    pub weights: Option<Arc<Vec<f64>>>,
    /// Joint, recording and stretch of time of each row.
    pub layout: Arc<RowLayout>,
    /// Number of rows of each joint that these represent: their own number, fewer with a mask, more for triangular factors.
    pub represented: Vec<f64>,
    /// Whether the rows of a block follow one another in time, so that their residual can be tested for correlation: the
    /// rows of triangular factors do not.
    pub is_in_time_order: bool,
}

impl Regression {
    /// Rows without weights that represent only themselves.
    #[must_use]
    pub fn new(x: Matrix, y: Vec<f64>, layout: RowLayout) -> Self {
        let represented = layout.counted_by_joint();
        let (x, y, layout) = (Arc::new(x), Arc::new(y), Arc::new(layout));
        Self { x, y, weights: None, layout, represented, is_in_time_order: true }
    }

    /// Rows of triangular factors, without weights, and the number of rows of each joint for which they stand.
    #[must_use]
    pub fn of_factors(x: Matrix, y: Vec<f64>, layout: RowLayout, represented: Vec<f64>) -> Self {
        Self { represented, is_in_time_order: false, ..Self::new(x, y, layout) }
    }

    /// Rows of one joint in one recording, without weights.
    #[must_use]
    pub fn single_series(x: Matrix, y: Vec<f64>) -> Self {
        let layout = RowLayout::new(1, &[y.len()]);
        Self::new(x, y, layout)
    }

    /// The same rows with other weights.
    #[must_use]
    pub fn with_weights(&self, weights: Option<Vec<f64>>) -> Self {
        Self { weights: weights.map(Arc::new), ..self.clone() }
    }

    /// The same rows with some of the columns of X.
    #[must_use]
    pub fn with_columns(&self, columns: &[usize]) -> Self {
        Self { x: Arc::new(self.x.select_columns(columns)), ..self.clone() }
    }

    /// The same rows with another matrix instead of X.
    #[must_use]
    pub fn with_matrix(&self, x: Matrix) -> Self {
        Self { x: Arc::new(x), ..self.clone() }
    }

    /// The same rows with an offset subtracted from y.
    #[must_use]
    pub fn less(&self, offset: Option<&[f64]>) -> Self {
        let subtracted = |offset: &[f64]| Arc::new(self.y.iter().zip(offset).map(|(y, o)| y - o).collect());
        Self { y: offset.map_or_else(|| self.y.clone(), subtracted), ..self.clone() }
    }

    /// The same rows with another vector instead of y.
    #[must_use]
    pub fn with_measured(&self, y: Vec<f64>) -> Self {
        Self { y: Arc::new(y), ..self.clone() }
    }

    /// The same for a y to which no mask applies.
    #[must_use]
    pub fn without_mask(&self) -> Self {
        if !self.layout.is_masked() {
            return self.clone();
        }
        let layout = RowLayout::clone(&self.layout).with_shares(None);
        Self { represented: layout.counted_by_joint(), layout: Arc::new(layout), ..self.clone() }
    }

    /// Number of rows that these represent, over all joints.
    #[must_use]
    pub fn rows_represented(&self) -> usize {
        self.represented.iter().sum::<f64>().round() as usize
    }

    /// Number of parameters.
    #[must_use]
    pub fn parameters(&self) -> usize {
        self.x.columns()
    }

    /// The weights of the rows.
    #[must_use]
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_ref().map(|w| &w[..])
    }

    /// A matrix with the rows of y, weighted.
    #[must_use]
    pub fn whiten_matrix<'a>(&self, a: &'a Matrix) -> Cow<'a, Matrix> {
        self.weights().map_or(Cow::Borrowed(a), |w| Cow::Owned(a.scale_rows(w)))
    }

    /// A vector with the rows of y, weighted.
    #[must_use]
    pub fn whiten<'a>(&self, rows: &'a [f64]) -> Cow<'a, [f64]> {
        self.weights().map_or(Cow::Borrowed(rows), |w| Cow::Owned(rows.iter().zip(w).map(|(r, w)| r * w).collect()))
    }

    /// `y - y_hat`, unweighted.
    #[must_use]
    pub fn residual(&self, prediction: &[f64]) -> Vec<f64> {
        self.y.iter().zip(prediction).map(|(y, p)| y - p).collect()
    }

    /// Sum of the squared, unweighted residual.
    #[must_use]
    pub fn residual_sum_of_squares(&self, prediction: &[f64]) -> f64 {
        self.y.iter().zip(prediction).map(|(y, p)| (y - p).powi(2)).sum()
    }

    /// The relative error of each joint, percent; `None` if its torque is zero.
    #[must_use]
    pub fn joint_relative_errors_percent(&self, prediction: &[f64]) -> Vec<Option<f64>> {
        let (measured, predicted) = (self.layout.by_joint(&self.y), self.layout.by_joint(prediction));
        let error = |(y, p): (&Vec<f64>, &Vec<f64>)| Some(relative_error_percent(y, p)).filter(|e| e.is_finite());
        measured.iter().zip(&predicted).map(error).collect()
    }

    /// The weight of each joint: one over the standard deviation of its residual, from a prediction with equal weights.
    ///
    /// The variance of a joint is its sum of squares divided by its rows minus the parameters that act on it. A joint without
    /// residual gets the largest weight of the others.
    #[must_use]
    pub fn joint_weights(&self, prediction: &[f64]) -> Vec<f64> {
        let joints = self.layout.joints();
        let acts = |c: usize, joint: usize| self.layout.rows_of_joint(joint).any(|k| self.x.at(k, c) != 0.0);
        let deviation = |joint: usize| {
            let residual: f64 = self.layout.rows_of_joint(joint).map(|k| (self.y[k] - prediction[k]).powi(2)).sum();
            let acting = (0..self.x.columns()).filter(|&c| acts(c, joint)).count();
            (residual / (self.represented[joint] - acting as f64).max(1.0)).sqrt()
        };
        let deviations: Vec<f64> = (0..joints).map(deviation).collect();
        let smallest = deviations.iter().copied().filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
        let smallest = if smallest.is_finite() { smallest } else { 1.0 };
        deviations.iter().map(|d| 1.0 / d.max(smallest)).collect()
    }

    /// The weight of each row from the weights of its recording and its joint; `None` if the weights of all recordings are one
    /// and joints have no weights.
    #[must_use]
    pub fn row_weights(&self, of_recordings: &[f64], of_joints: Option<&[f64]>) -> Option<Vec<f64>> {
        if of_joints.is_none() && of_recordings.iter().all(|w| *w == 1.0) {
            return None;
        }
        Some(self.layout.spread(|b| of_recordings[b.recording] * of_joints.map_or(1.0, |joints| joints[b.joint])))
    }
}

/// `100 |y - y_hat| / |y|`.
#[must_use]
pub fn relative_error_percent(y: &[f64], prediction: &[f64]) -> f64 {
    let residual: Vec<f64> = y.iter().zip(prediction).map(|(y, p)| y - p).collect();
    100.0 * norm(&residual) / norm(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joint one: two parameters act on three rows; joint two: one parameter, residual zero.
    #[test]
    fn a_joint_with_a_small_residual_has_a_large_weight() {
        let x = Matrix::from_fn(6, 2, |k, c| if k < 3 || c == 1 { 1.0 } else { 0.0 });
        let regression = Regression::new(x, vec![1.0, 2.0, 3.0, 5.0, 5.0, 5.0], RowLayout::new(2, &[3]));
        let weights = regression.joint_weights(&[1.0, 2.0, 1.0, 5.0, 5.0, 5.0]);
        // Squares 4 over 3 - 2 degrees of freedom.
        assert_eq!(weights, [0.5, 0.5]);
        assert_eq!(regression.row_weights(&[2.0], Some(&weights)), Some(vec![1.0; 6]));
        assert_eq!(regression.row_weights(&[1.0], None), None);
    }

    #[test]
    fn a_joint_without_torque_has_no_relative_error() {
        let x = Matrix::zeros(4, 1);
        let regression = Regression::new(x, vec![3.0, 4.0, 0.0, 0.0], RowLayout::new(2, &[2]));
        assert_eq!(regression.joint_relative_errors_percent(&[0.0; 4]), [Some(100.0), None]);
    }
}
