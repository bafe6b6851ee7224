//! The quadratic form of an estimator in its estimate.

use std::borrow::Cow;

use crate::run::validation::cross_validation::Others;
use thetahat_estimation::{
    identification::{DesignMatrix, EstimationError, Method, Needs},
    regression::{InstrumentalVariables, Regression},
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr};
use thetahat_model::{
    base_parameters::BaseParameters,
    consistency::{ConsistentSet, LeastSquares, Prior, fit},
};

/// What an estimator minimises about its estimate, `|R (theta - theta_hat)|^2`.
pub(in crate::run) struct Metric<'a> {
    /// R: the triangular factor of X for LS and WLS, of Z for DIDIM, of `Q^T X` with `Z = Q R_Z` for IV, whitened.
    pub(in crate::run) triangle: Matrix,
    /// What the parameters multiply in the prediction, unweighted.
    pub(in crate::run) design: &'a Matrix,
}

/// The metric of a method.
///
/// # Errors
/// [`EstimationError::NoInstruments`].
pub(in crate::run) fn metric<'a>(
    method: Method,
    regression: &'a Regression,
    instruments: Option<&'a Matrix>,
) -> Result<Metric<'a>, EstimationError> {
    let z = instruments.ok_or(EstimationError::NoInstruments);
    let design = match method.design() {
        DesignMatrix::Measured => regression.x.as_ref(),
        DesignMatrix::Simulated => z.clone()?,
    };
    let whitened: Cow<'_, Matrix> = regression.whiten_matrix(design);
    let triangle = match (method.needs(), method.design()) {
        (Needs::Measurement | Needs::Sensitivities, _) | (Needs::Instruments, DesignMatrix::Simulated) => {
            whitened.triangular_factor()
        }
        (Needs::Instruments, DesignMatrix::Measured) => {
            let basis = PivotedQr::with_equal_columns(&regression.whiten_matrix(z?)).thin_q();
            let iv = InstrumentalVariables::new(basis, &whitened, PivotedQr::with_equal_columns);
            iv.projected.triangular_factor()
        }
    };
    Ok(Metric { triangle, design })
}

/// A regression whose folds are left out in turn.
pub(in crate::run) struct LeftOut<'a> {
    pub(in crate::run) regression: &'a Regression,
    pub(in crate::run) base: &'a BaseParameters,
    pub(in crate::run) design: &'a Matrix,
    pub(in crate::run) others: Vec<Others>,
}

impl LeftOut<'_> {
    /// The squared weighted error of all folds, each predicted by the consistent estimate of the others; none if one
    /// has none.
    pub(in crate::run) fn squared_error(&self, set: &ConsistentSet, prior: Prior) -> Option<f64> {
        let count = set.parameter_table().len();
        let mut sum = 0.0;
        for others in &self.others {
            let data = LeastSquares::in_base(&others.triangle, others.right_side.clone(), self.base, count).ok()?;
            let theta = self.base.from_standard(&fit(set, &data, prior, None).ok()?.standard);
            let residual = self.regression.residual(&self.design.times(&theta));
            let weighted = self.regression.whiten(&residual);
            sum += others.rows.iter().map(|&k| weighted[k] * weighted[k]).sum::<f64>();
        }
        Some(sum)
    }
}
