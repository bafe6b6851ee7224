//! The problem of a prediction-error method, linearised at given parameters.

use super::fit::{EstimationError, Fit, SimulatedResponse};
use crate::regression::Regression;
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, norm};

/// The result of a step, and its metric.
#[derive(Debug, Clone, PartialEq)]
pub struct GaussNewtonStep {
    /// The parameters after the step.
    pub theta: Vec<f64>,
    /// R, b x b: the step minimises `|R (theta - theta_hat)|`.
    pub r: Matrix,
}

/// Projects a step onto parameters that can be simulated.
pub type StepProjection<'a> = dyn FnMut(GaussNewtonStep) -> Vec<f64> + 'a;

/// The weighted problem linearised at given parameters: `|z - R step|^2` and a constant.
#[derive(Debug, Clone)]
pub(super) struct Linearised {
    pub(super) theta: Vec<f64>,
    r: Matrix,
    z: Vec<f64>,
    pub(super) simulated: SimulatedResponse,
    pub(super) fit: Result<Fit, EstimationError>,
}

impl Linearised {
    pub(super) fn new(
        theta: Vec<f64>,
        simulated: SimulatedResponse,
        fit: Result<Fit, EstimationError>,
        regression: &Regression,
    ) -> Self {
        let residual = regression.residual(&simulated.response);
        let e = Matrix::from_fn(residual.len(), 1, |k, _| residual[k]);
        let all = regression.whiten_matrix(&Matrix::side_by_side(&[&simulated.sensitivities, &e])).triangular_factor();
        let columns: Vec<usize> = (0..theta.len()).collect();
        let (r, z) = (all.select_columns(&columns), all.column(theta.len()).to_vec());
        Self { theta, r, z, simulated, fit }
    }

    /// The step that minimises `|z - R step|^2 + damping |D step|^2`, D the norms of the columns.
    pub(super) fn step(&self, damping: f64) -> GaussNewtonStep {
        let size = self.theta.len();
        let norms: Vec<f64> = (0..size).map(|c| norm(self.r.column(c)).max(f64::MIN_POSITIVE)).collect();
        let damped = Matrix::from_fn(size, size, |i, j| if i == j { damping.sqrt() * norms[i] } else { 0.0 });
        let mut z = self.z.clone();
        z.resize(self.r.rows() + size, 0.0);
        let stacked = Matrix::stack(&[&self.r, &damped]);
        let step = PivotedQr::with_equal_columns(&stacked).solve(&z);
        let theta = self.theta.iter().zip(step).map(|(theta, step)| theta + step).collect();
        GaussNewtonStep { theta, r: stacked.triangular_factor() }
    }

    /// The largest part of the undamped step in standard deviations; none if parameters are not separated.
    pub(super) fn whole_step_in_deviations(&self, project: &mut StepProjection<'_>) -> Option<f64> {
        let fit = self.fit.as_ref().ok()?;
        let next = project(self.step(0.0));
        Some(in_deviations(fit, next.iter().zip(&self.theta).map(|(b, t)| b - t)))
    }
}

/// The constant part of the linearised model, in addition to `J theta`: `response - J theta`.
pub(super) fn offset(simulated: &SimulatedResponse, theta: &[f64]) -> Vec<f64> {
    let linear = simulated.sensitivities.times(theta);
    simulated.response.iter().zip(linear).map(|(r, l)| r - l).collect()
}

/// The largest change in standard deviations.
pub(super) fn in_deviations(fit: &Fit, changes: impl Iterator<Item = f64>) -> f64 {
    let size = |i: usize| fit.standard_deviation[i].max(f64::EPSILON * fit.theta[i].abs()).max(f64::MIN_POSITIVE);
    changes.enumerate().map(|(i, change)| change.abs() / size(i)).fold(0.0, f64::max)
}
