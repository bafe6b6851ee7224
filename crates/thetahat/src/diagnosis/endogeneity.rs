use super::{
    comparison::{SIGNIFICANCE, comparison, largest},
    estimated::Whitened,
};
use crate::preparation::Problem;
use thetahat_estimation::statistics::wu_hausman;
use thetahat_report::results::EndogeneityResult;

/// LS against IV, by the Durbin-Wu-Hausman test.
pub(super) fn endogeneity(problem: &Problem, iv: &Whitened<'_>) -> Option<EndogeneityResult> {
    let test = wu_hausman(&iv.z, &iv.x, &iv.y, iv.layout)?;
    Some(EndogeneityResult {
        classical: test.classical,
        robust: test.robust,
        average_difference: test.average_difference,
        parameters: largest(problem, &test.difference, &test.iv_deviation),
        verdict: comparison(test.robust.p_value < SIGNIFICANCE, test.average_difference),
    })
}
