use serde::Deserialize;

use super::{
    estimators::idim_ls,
    fit::{Divisor, EstimationError, Fit},
};
use crate::{
    regression::Regression,
    statistics::{FTest, f_test},
};

/// The rule by which parameters are not essential.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EliminationRule {
    /// Relative standard deviation in percent above which the worst parameter is a candidate.
    pub relative_standard_deviation_percent: f64,
    /// Level of the F-test: the elimination ends before it rejects.
    pub significance: f64,
}

impl Default for EliminationRule {
    fn default() -> Self {
        Self { relative_standard_deviation_percent: 30.0, significance: 0.05 }
    }
}

/// The result of an elimination.
#[derive(Debug, Clone, PartialEq)]
pub struct Elimination {
    /// Columns kept, in order.
    pub kept: Vec<usize>,
    /// Columns removed, in the order of removal.
    pub eliminated: Vec<usize>,
    /// The F-test of the kept columns against all.
    pub f_test: Option<FTest>,
}

/// Essential parameters: removes the parameter with the largest relative standard deviation, estimates again, and
/// continues until all are below the rule's limit or the F-test of the rest against the full model rejects (A. Janot, P. O.
/// Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial robot identification", 2014).
///
/// A parameter stays if `is_possible` rejects the columns and estimates that remain without it: a parameter that a simulation needs is
/// essential, however uncertain it is.
///
/// # Errors
/// [`EstimationError`] where the full set cannot be estimated.
pub fn eliminate(
    regression: &Regression,
    rule: EliminationRule,
    is_possible: &dyn Fn(&[usize], &[f64]) -> bool,
) -> Result<Elimination, EstimationError> {
    let full = idim_ls(regression, Divisor::default())?;
    let mut state = Elimination { kept: (0..full.theta.len()).collect(), eliminated: Vec::new(), f_test: None };
    let mut fit = full.clone();
    let mut held = Vec::new();
    let limit = rule.relative_standard_deviation_percent;
    while let Some(worst) = worst_parameter(&fit, limit, |i| !held.contains(&state.kept[i])) {
        if state.kept.len() == 1 {
            break;
        }
        let mut kept = state.kept.clone();
        let removed = kept.remove(worst);
        let without = idim_ls(&regression.with_columns(&kept), Divisor::default())?;
        let test = nested_f_test(regression, &without, &full);
        if test.is_none_or(|t| t.p_value < rule.significance) {
            break;
        }
        if !is_possible(&kept, &without.theta) {
            held.push(removed);
            continue;
        }
        state.eliminated.push(removed);
        (state.kept, state.f_test, fit) = (kept, test, without);
    }
    Ok(state)
}

/// The F-test of a fit with some of the columns against the fit with all of them.
#[must_use]
pub fn nested_f_test(regression: &Regression, reduced: &Fit, full: &Fit) -> Option<FTest> {
    let squares = |fit: &Fit| regression.residual_sum_of_squares(&fit.prediction);
    let (reduced_count, full_count) = (reduced.theta.len(), full.theta.len());
    f_test(squares(reduced), reduced_count, squares(full), full_count, regression.rows_represented())
}

/// The index of the most uncertain of the parameters that may be removed.
fn worst_parameter(fit: &Fit, limit_percent: f64, may_go: impl Fn(usize) -> bool) -> Option<usize> {
    let relative = |i: usize| 100.0 * fit.standard_deviation[i] / fit.theta[i].abs();
    let uncertain = (0..fit.theta.len()).filter(|&i| relative(i) > limit_percent && may_go(i));
    uncertain.max_by(|&a, &b| relative(a).total_cmp(&relative(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_ground::linear_algebra::Matrix;

    #[test]
    fn parameters_without_effect_go_and_the_others_stay() {
        let noise = |k: usize| ((78.233 * k as f64).sin() * 43758.5453).fract();
        let x = Matrix::from_fn(300, 5, |k, j| (0.037 * (k * (j + 1)) as f64).sin());
        let y: Vec<f64> = (0..300).map(|k| 2.0 * x.at(k, 0) - x.at(k, 3) + 0.1 * noise(k)).collect();
        let regression = Regression::single_series(x, y);
        let result = eliminate(&regression, EliminationRule::default(), &|_, _| true).unwrap();
        assert_eq!(result.kept, vec![0, 3]);
        assert!(result.f_test.unwrap().p_value > 0.05);
        let result = eliminate(&regression, EliminationRule::default(), &|kept, _| kept.contains(&4)).unwrap();
        assert_eq!(result.kept, vec![0, 3, 4]);
    }
}
