//! The weights of joints and their weighted least squares, iterated together.

use super::{
    estimators::idim_ls,
    fit::{Divisor, EstimationError},
};
use crate::regression::{BlockKey, Regression, RowBlock, RowLayout};
use thetahat_ground::linear_algebra::Matrix;

/// Largest relative change of a weight in the last step.
const SETTLED: f64 = 1e-6;
/// Most steps.
const MOST_STEPS: usize = 100;

/// The weight of each joint, one over the standard deviation of its residual in the fit with these weights.
#[derive(Debug, Clone, PartialEq)]
pub struct JointWeights {
    /// One for each joint.
    pub weights: Vec<f64>,
    /// Number of estimates.
    pub steps: usize,
    /// Largest relative change of a weight in the last step.
    pub change: f64,
}

impl JointWeights {
    /// Weighted least squares with the weights of its own residual: starting from equal weights, estimate and weights are iterated until no
    /// weight changes by more than a millionth, or a hundred times.
    ///
    /// # Errors
    /// [`EstimationError`] where there is no estimate.
    pub fn of(regression: &Regression, weights_of_recordings: &[f64]) -> Result<Self, EstimationError> {
        let rows = compressed(regression);
        let mut found = Self { weights: vec![1.0; regression.layout.joints()], steps: 0, change: f64::INFINITY };
        while found.steps < MOST_STEPS && !found.is_settled() {
            let weights = rows.row_weights(weights_of_recordings, Some(&found.weights));
            let fit = idim_ls(&rows.with_weights(weights), Divisor::default())?;
            let next = rows.joint_weights(&fit.prediction);
            let change = |(new, old): (&f64, &f64)| (new / old - 1.0).abs();
            let steps = found.steps + 1;
            // The first step starts from equal weights.
            let largest = next.iter().zip(&found.weights).map(change).fold(0.0, f64::max);
            found = Self { weights: next, steps, change: if steps == 1 { f64::INFINITY } else { largest } };
        }
        Ok(found)
    }

    /// Whether the weights no longer change.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.change <= SETTLED
    }
}

/// The same sums of squares, per joint and recording, in the few rows of triangular factors.
fn compressed(regression: &Regression) -> Regression {
    let layout = &regression.layout;
    let mut factors = Vec::new();
    let mut few = RowLayout::empty(layout.joints(), layout.recordings());
    let y = Matrix::from_fn(regression.y.len(), 1, |i, _| regression.y[i]);
    let all = Matrix::side_by_side(&[&regression.x, &y]);
    for block in layout.blocks() {
        let rows = all.row_range(block.rows.clone());
        let factor = if rows.rows() > rows.columns() { rows.triangular_factor() } else { rows };
        let RowBlock { joint, recording, stretch, .. } = *block;
        few.push(BlockKey { joint, recording, stretch }, factor.rows());
        factors.push(factor);
    }
    let stacked = Matrix::stack(&factors.iter().collect::<Vec<_>>());
    let columns = regression.x.columns();
    let x = stacked.select_columns(&(0..columns).collect::<Vec<_>>());
    Regression::of_factors(x, stacked.column(columns).to_vec(), few, regression.represented.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(k: usize) -> f64 {
        ((78.233 * k as f64).sin() * 43_758.545_3).fract()
    }

    /// Two joints that share a parameter, one with ten times the noise of the other.
    fn two_joints() -> Regression {
        let x = Matrix::from_fn(400, 3, |k, c| match (c, k < 200) {
            (0, _) => (0.1 * k as f64).sin(),
            (1, true) => (0.031 * k as f64).cos(),
            (2, false) => (0.017 * k as f64).sin(),
            (_, _) => 0.0,
        });
        let size = |k: usize| if k < 200 { 1.0 } else { 0.1 };
        let y = x.times(&[2.0, 1.0, -1.0]).iter().enumerate().map(|(k, y)| y + size(k) * noise(k)).collect();
        Regression::new(x, y, RowLayout::new(2, &[200]))
    }

    /// The fixed point: the weights of the residual that weighted least squares leave are the weights.
    #[test]
    fn weights_and_estimate_follow_from_one_another() {
        let regression = two_joints();
        let found = JointWeights::of(&regression, &[1.0]).unwrap();
        assert!(found.is_settled() && found.steps > 2, "{found:?}");
        let weights = regression.row_weights(&[1.0], Some(&found.weights));
        let fit = idim_ls(&regression.with_weights(weights), Divisor::default()).unwrap();
        for (again, weight) in regression.joint_weights(&fit.prediction).iter().zip(&found.weights) {
            assert!((again / weight - 1.0).abs() < 1e-5, "{again} {weight}");
        }
        assert!((found.weights[1] / found.weights[0] - 10.0).abs() < 2.0, "{found:?}");
    }
}
