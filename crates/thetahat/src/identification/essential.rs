use serde::Deserialize;

use super::{Divisor, EstimationError, Fit, idim_ls};
use crate::{
    linear_algebra::Matrix,
    statistics::{FTest, f_test},
};

/// When a parameter is not essential.
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

/// What an elimination leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct Elimination {
    /// Columns kept, in order.
    pub kept: Vec<usize>,
    /// Columns taken out, in the order in which they went.
    pub eliminated: Vec<usize>,
    /// The fit of those kept.
    pub fit: Fit,
    /// The F-test of those kept against all.
    pub f_test: Option<FTest>,
}

/// Essential parameters: takes out the parameter with the largest relative standard deviation, estimates again, and goes
/// on until all are below the rule's limit or the F-test of the rest against the full model rejects (A. Janot, P. O.
/// Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial robot identification", 2014).
///
/// # Errors
/// [`EstimationError`] where the full set cannot be estimated.
pub fn eliminate(x: &Matrix, y: &[f64], rule: EliminationRule) -> Result<Elimination, EstimationError> {
    let full = idim_ls(x, y, None, Divisor::default())?;
    let full_squares = full.residual_sum_of_squares(y);
    let mut kept: Vec<usize> = (0..x.columns()).collect();
    let mut state = Elimination { kept: kept.clone(), eliminated: Vec::new(), fit: full, f_test: None };
    while let Some(worst) = worst_parameter(&state.fit, rule.relative_standard_deviation_percent) {
        if kept.len() == 1 {
            break;
        }
        let removed = kept.remove(worst);
        let fit = idim_ls(&x.select_columns(&kept), y, None, Divisor::default())?;
        let test = f_test(fit.residual_sum_of_squares(y), kept.len(), full_squares, x.columns(), y.len());
        if test.is_none_or(|t| t.p_value < rule.significance) {
            break;
        }
        state.eliminated.push(removed);
        state = Elimination { kept: kept.clone(), fit, f_test: test, ..state };
    }
    Ok(state)
}

fn worst_parameter(fit: &Fit, limit_percent: f64) -> Option<usize> {
    let relative = |i: usize| 100.0 * fit.standard_deviation[i] / fit.theta[i].abs();
    (0..fit.theta.len()).filter(|&i| relative(i) > limit_percent).max_by(|&a, &b| relative(a).total_cmp(&relative(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_without_effect_go_and_the_others_stay() {
        let noise = |k: usize| ((78.233 * k as f64).sin() * 43758.5453).fract();
        let x = Matrix::from_fn(300, 5, |k, j| (0.037 * (k * (j + 1)) as f64).sin());
        let y: Vec<f64> = (0..300).map(|k| 2.0 * x.at(k, 0) - x.at(k, 3) + 0.1 * noise(k)).collect();
        let result = eliminate(&x, &y, EliminationRule::default()).unwrap();
        assert_eq!(result.kept, vec![0, 3]);
        assert!(result.f_test.unwrap().p_value > 0.05);
    }
}
