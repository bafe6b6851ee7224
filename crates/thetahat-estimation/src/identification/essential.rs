use serde::Deserialize;

use super::{
    estimators::idim_ls,
    fit::{Divisor, EstimationError, Fit},
};
use crate::{
    regression::Regression,
    statistics::{FTest, f_test},
};
use thetahat_ground::linear_algebra::Matrix;

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
    let mut left = Remaining::new(regression, &full);
    let mut state = Elimination { kept: left.kept.clone(), eliminated: Vec::new(), f_test: None };
    let mut held = Vec::new();
    let limit = rule.relative_standard_deviation_percent;
    while let Some(worst) = left.worst_parameter(limit, |column| !held.contains(&column)) {
        if left.kept.len() == 1 {
            break;
        }
        let removed = left.kept[worst];
        let without = left.without(worst);
        let squares = [without.squares(), regression.residual_sum_of_squares(&full.prediction)];
        let counts = [without.kept.len(), full.theta.len()];
        let test = f_test(squares[0], counts[0], squares[1], counts[1], regression.rows_represented());
        if test.is_none_or(|t| t.p_value < rule.significance) {
            break;
        }
        if !is_possible(&without.kept, &without.theta) {
            held.push(removed);
            continue;
        }
        state.eliminated.push(removed);
        state.f_test = test;
        left = without;
    }
    state.kept = left.kept;
    Ok(state)
}

/// The least squares with the columns that remain.
///
/// Without parameter w, `theta_i - C_iw theta_w / C_ww`, `C_ij - C_iw C_wj / C_ww` and squares larger by `theta_w^2 / C_ww` are the estimates
/// anew: a step costs the square of their number, where new factors cost its third power.
struct Remaining<'a> {
    regression: &'a Regression,
    kept: Vec<usize>,
    theta: Vec<f64>,
    /// C, the covariance for rows of variance one.
    unit_covariance: Matrix,
    /// Of the weighted residual.
    weighted_squares: f64,
}

impl<'a> Remaining<'a> {
    fn new(regression: &'a Regression, full: &Fit) -> Self {
        let residual = regression.residual(&full.prediction);
        let weighted_squares: f64 = regression.whiten(&residual).iter().map(|e| e * e).sum();
        let size = full.theta.len();
        let variance = weighted_squares / Self::freedom(regression, size);
        let unit = |i: usize, j: usize| full.covariance.at(i, j) / variance;
        Self {
            regression,
            kept: (0..size).collect(),
            theta: full.theta.clone(),
            unit_covariance: Matrix::from_fn(size, size, unit),
            weighted_squares,
        }
    }

    fn freedom(regression: &Regression, parameters: usize) -> f64 {
        regression.rows_represented().saturating_sub(parameters).max(1) as f64
    }

    /// The same without one of the parameters.
    fn without(&self, w: usize) -> Self {
        let c = &self.unit_covariance;
        let factor = |i: usize| c.at(i, w) / c.at(w, w);
        let others: Vec<usize> = (0..self.kept.len()).filter(|&i| i != w).collect();
        let entry = |i: usize, j: usize| c.at(others[i], others[j]) - factor(others[i]) * c.at(w, others[j]);
        Self {
            regression: self.regression,
            kept: others.iter().map(|&i| self.kept[i]).collect(),
            theta: others.iter().map(|&i| self.theta[i] - factor(i) * self.theta[w]).collect(),
            unit_covariance: Matrix::from_fn(others.len(), others.len(), entry),
            weighted_squares: self.weighted_squares + self.theta[w] * self.theta[w] / c.at(w, w),
        }
    }

    /// The sum of squares of the residual, without weights.
    fn squares(&self) -> f64 {
        let mut residual = self.regression.y.to_vec();
        for (&column, theta) in self.kept.iter().zip(&self.theta) {
            let x = self.regression.x.column(column);
            residual.iter_mut().zip(x).for_each(|(e, x)| *e -= theta * x);
        }
        residual.iter().map(|e| e * e).sum()
    }

    /// The index of the most uncertain of the parameters that may be removed.
    fn worst_parameter(&self, limit_percent: f64, may_go: impl Fn(usize) -> bool) -> Option<usize> {
        let variance = self.weighted_squares / Self::freedom(self.regression, self.kept.len());
        let deviation = |i: usize| (variance * self.unit_covariance.at(i, i)).sqrt();
        let relative = |i: usize| 100.0 * deviation(i) / self.theta[i].abs();
        let uncertain = (0..self.kept.len()).filter(|&i| relative(i) > limit_percent && may_go(self.kept[i]));
        uncertain.max_by(|&a, &b| relative(a).total_cmp(&relative(b)))
    }
}

/// The F-test of a fit with some of the columns against the fit with all of them.
#[must_use]
pub fn nested_f_test(regression: &Regression, reduced: &Fit, full: &Fit) -> Option<FTest> {
    let squares = |fit: &Fit| regression.residual_sum_of_squares(&fit.prediction);
    let (reduced_count, full_count) = (reduced.theta.len(), full.theta.len());
    f_test(squares(reduced), reduced_count, squares(full), full_count, regression.rows_represented())
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn estimates_without_parameters_are_those_of_new_least_squares() {
        let x = Matrix::from_fn(300, 6, |k, j| (0.037 * (k * (j + 1)) as f64).sin() + 0.5 * (0.02 * k as f64).cos());
        let y: Vec<f64> = (0..300).map(|k| x.at(k, 0) - 2.0 * x.at(k, 4) + (7.3 * k as f64).sin()).collect();
        let weights = (0..300).map(|k| if k < 100 { 2.0 } else { 1.0 }).collect();
        for regression in [
            Regression::single_series(x.clone(), y.clone()),
            Regression::single_series(x, y).with_weights(Some(weights)),
        ] {
            let full = idim_ls(&regression, Divisor::default()).unwrap();
            let left = Remaining::new(&regression, &full).without(1).without(3);
            assert_eq!(left.kept, [0, 2, 3, 5]);
            let anew = idim_ls(&regression.with_columns(&left.kept), Divisor::default()).unwrap();
            let variance = left.weighted_squares / 296.0;
            for i in 0..4 {
                assert!((left.theta[i] - anew.theta[i]).abs() < 1e-11);
                let found = (variance * left.unit_covariance.at(i, i)).sqrt();
                assert!((found / anew.standard_deviation[i] - 1.0).abs() < 1e-10);
            }
            let squares = regression.residual_sum_of_squares(&anew.prediction);
            assert!((left.squares() / squares - 1.0).abs() < 1e-11);
        }
    }
}
