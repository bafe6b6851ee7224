//! What DIDIM's approximation of the sensitivities leaves out: DIDIM against CLIE.

use super::estimated::MethodEstimate;
use crate::preparation::Problem;
use thetahat_estimation::identification::uncertainty;
use thetahat_ground::linear_algebra::norm;
use thetahat_report::results::{ApproximatedParameter, ApproximationResult};

/// Compares both estimates, and Z with J; none if one of them has no deviations.
pub(super) fn approximation(
    problem: &Problem,
    didim: &MethodEstimate,
    clie: &MethodEstimate,
) -> Option<ApproximationResult> {
    let (approximate, exact) = (didim.outcome.fit.as_ref()?, clie.outcome.fit.as_ref()?);
    let (z, j) = (didim.outcome.instruments.as_ref()?, clie.outcome.instruments.as_ref()?);
    let deviations = uncertainty(clie.method, &clie.regression, Some(j), exact).ok()?.standard_deviation;
    let parameter = |(i, p): (usize, &thetahat_model::base_parameters::BaseParameter)| {
        let difference = approximate.theta[i] - exact.theta[i];
        let left_out: Vec<f64> = z.column(i).iter().zip(j.column(i)).map(|(z, j)| z - j).collect();
        ApproximatedParameter {
            name: p.name.clone(),
            column_percent: 100.0 * norm(&left_out) / norm(j.column(i)),
            difference,
            deviations: difference / deviations[i],
        }
    };
    let parameters: Vec<ApproximatedParameter> =
        problem.estimated.parameters().iter().enumerate().map(parameter).collect();
    let sizes = parameters.iter().map(|p| p.deviations.abs());
    Some(ApproximationResult {
        matters: sizes.clone().any(|size| size > 1.0),
        average_difference: sizes.sum::<f64>() / parameters.len() as f64,
        parameters,
    })
}
