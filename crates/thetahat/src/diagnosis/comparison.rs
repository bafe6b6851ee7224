use crate::preparation::Problem;
use thetahat_report::results::{Comparison, ParameterDifference};

/// Level of the tests.
pub(super) const SIGNIFICANCE: f64 = 0.05;
/// Average difference of two estimates, in standard deviations, that starts to matter: an estimate that is off by so much
/// lies within its 95 % interval 92 % of the time.
pub(super) const HARMLESS_BELOW: f64 = 0.5;
/// Parameters that a comparison names.
const NAMED: usize = 5;

/// The verdict of a test and of the size of the difference that it found.
pub(super) fn comparison(rejected: bool, average_difference: f64) -> Comparison {
    match (rejected, average_difference >= HARMLESS_BELOW) {
        (false, _) => Comparison::Agree,
        (true, false) => Comparison::SmallDifference,
        (true, true) => Comparison::Alarm,
    }
}

/// The parameters that differ most, in standard deviations.
pub(super) fn largest(problem: &Problem, difference: &[f64], deviation: &[f64]) -> Vec<ParameterDifference> {
    let named = problem.estimated.parameters().iter().zip(difference.iter().zip(deviation));
    let mut all: Vec<ParameterDifference> = named
        .map(|(p, (d, sd))| ParameterDifference { name: p.name.clone(), difference: *d, deviations: d / sd })
        .collect();
    all.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    all.truncate(NAMED);
    all
}
