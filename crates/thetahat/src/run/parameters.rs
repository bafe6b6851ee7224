use crate::preparation::{LoopParameters, Problem, Settings};
use thetahat_estimation::identification::{DependentColumn, Fit, Uncertainty};
use thetahat_model::base_parameters::{BaseParameter, BaseParameters};
use thetahat_report::results::{EliminationResult, LoopParameterResult, NotSeparated, ParameterResult};

/// The elimination of a problem with the names of its parameters, where essential ones were sought.
pub(super) fn elimination_result(problem: &Problem) -> Option<EliminationResult> {
    let names = |columns: &[usize]| columns.iter().map(|&c| problem.base.parameters()[c].name.clone()).collect();
    problem.elimination.as_ref().map(|elimination| EliminationResult {
        kept: names(&elimination.kept),
        eliminated: names(&elimination.eliminated),
        f_test: elimination.f_test,
    })
}

/// The parameters that the motion does not separate from others, which are left out.
pub(super) fn not_separated(problem: &Problem) -> Vec<NotSeparated> {
    let name = |column: usize| problem.base.parameters()[column].name.clone();
    let of = |dependent: &DependentColumn| NotSeparated {
        parameter: name(dependent.column),
        with: dependent.spanned_by.iter().map(|&column| name(column)).collect(),
    };
    problem.dependent.iter().map(of).collect()
}

/// The estimates without deviations where they include another parameter: they are sums.
pub(super) fn without_deviations_of_sums(problem: &Problem, parameters: Vec<ParameterResult>) -> Vec<ParameterResult> {
    let shown = |p: ParameterResult| match problem.includes_another(&p.name) {
        false => p,
        true => ParameterResult {
            standard_deviation: None,
            relative_standard_deviation_percent: None,
            standard_deviation_robust: None,
            interval_95: None,
            ..p
        },
    };
    parameters.into_iter().map(shown).collect()
}

/// The estimates of a run with their deviations, intervals and true values.
pub(super) fn parameter_results(
    settings: &Settings,
    estimated: &BaseParameters,
    fit: &Fit,
    uncertainty: Option<&Uncertainty>,
    truth: Option<&[f64]>,
) -> Vec<ParameterResult> {
    let relative = |sd: f64, value: f64| (value != 0.0).then(|| 100.0 * sd / value.abs());
    let result = |(i, p): (usize, &BaseParameter)| ParameterResult {
        name: p.name.clone(),
        estimate: fit.theta[i],
        standard_deviation: Some(fit.standard_deviation[i]),
        relative_standard_deviation_percent: relative(fit.standard_deviation[i], fit.theta[i]),
        true_value: truth.map(|t| t[i]),
        unit: p.unit.to_string(),
        expression: p.expression.clone(),
        shown: settings.shows(&p.name),
        standard_deviation_robust: uncertainty.map(|u| u.standard_deviation[i]),
        interval_95: uncertainty.map(|u| u.interval_95[i]),
    };
    estimated.parameters().iter().enumerate().map(result).collect()
}

/// The lower triangle, row by row, of the covariance of estimates: classical correlations with the deviations of the results,
/// those with correlated errors where there are any.
pub(super) fn covariance_of(fit: &Fit, parameters: &[ParameterResult]) -> Vec<f64> {
    let factor = |(i, p): (usize, &ParameterResult)| {
        let classical = fit.standard_deviation[i];
        let deviation = p.deviation().unwrap_or(classical);
        if classical > 0.0 { deviation / classical } else { 1.0 }
    };
    let factors: Vec<f64> = parameters.iter().enumerate().map(factor).collect();
    let entry = |i: usize, j: usize| factors[i] * factors[j] * fit.covariance.at(i, j);
    (0..factors.len()).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect()
}

/// The quantities of the loop that were estimated after `before` parameters of the robot.
pub(super) fn loop_parameter_results(
    (loop_parameters, sign_velocity_scale): (&LoopParameters, f64),
    before: usize,
    fit: &Fit,
    uncertainty: Option<&Uncertainty>,
) -> Vec<LoopParameterResult> {
    let result = |(i, name): (usize, String)| {
        let place = before + i;
        let (value, sd) = (*fit.theta.get(place)?, fit.standard_deviation[place]);
        let interval = uncertainty.map(|u| u.interval_95[place]);
        let unit = loop_parameters.unit(i, sign_velocity_scale);
        Some(LoopParameterResult {
            name,
            estimate: unit.value(value),
            standard_deviation: unit.slope(value) * sd,
            interval_95: interval.map(|ends| ends.map(|end| unit.value(end))),
            unit: unit.symbol().to_owned(),
        })
    };
    loop_parameters.names().into_iter().enumerate().filter_map(result).collect()
}
