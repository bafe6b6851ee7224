use crate::{
    base_parameters::{BaseParameter, BaseParameters},
    identification::{Fit, Uncertainty},
    preparation::Settings,
    results::ParameterResult,
};

/// The estimates of a run with their deviations, intervals and true values.
pub(crate) fn parameter_results(
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
        unit: p.unit.to_owned(),
        expression: p.expression.clone(),
        shown: settings.shows(&p.name),
        standard_deviation_robust: uncertainty.map(|u| u.standard_deviation[i]),
        interval_95: uncertainty.map(|u| u.interval_95[i]),
    };
    estimated.parameters().iter().enumerate().map(result).collect()
}
