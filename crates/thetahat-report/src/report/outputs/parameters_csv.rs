//! `parameters.csv`: one row for each parameter and run; for a user's own estimator, the method is `user:` and its name.

use super::output::Output;
use crate::{
    report::{error::ReportError, published::Published},
    results::{NOMINAL, ParameterResult, Results},
};
use thetahat_ground::output::FileKind;
use thetahat_ground::visible::cell;

pub(super) const OUTPUT: Output = Output { name: "parameters.csv", kind: FileKind::Parameters, render };

const PARAMETER_COLUMNS: [&str; 12] = [
    "case",
    "method",
    "name",
    "estimate",
    "standard_deviation",
    "relative_standard_deviation_percent",
    "true_value",
    "unit",
    "expression",
    "standard_deviation_robust",
    "interval_95_low",
    "interval_95_high",
];

fn render(results: &Results, _: Option<&Published>) -> Result<Vec<u8>, ReportError> {
    let refuse = |source| ReportError::Csv { source };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(PARAMETER_COLUMNS).map_err(refuse)?;
    for run in &results.runs {
        for parameter in &run.parameters {
            writer.write_record(record([&run.case, run.method.name()], parameter)).map_err(refuse)?;
        }
    }
    if let Some(model) = &results.model {
        for parameter in &model.as_run(NOMINAL).parameters {
            writer.write_record(record([NOMINAL, "model"], parameter)).map_err(refuse)?;
        }
    }
    for run in &results.user_runs {
        for parameter in &run.parameters {
            writer.write_record(record([NOMINAL, &format!("user:{}", run.name)], parameter)).map_err(refuse)?;
        }
    }
    writer.into_inner().map_err(|e| refuse(e.into_error().into()))
}

fn record([case, method]: [&str; 2], parameter: &ParameterResult) -> [String; 12] {
    let number = |v: Option<f64>| v.map(|v| v.to_string()).unwrap_or_default();
    [
        cell(case).into_owned(),
        cell(method).into_owned(),
        cell(&parameter.name).into_owned(),
        number(Some(parameter.estimate)),
        number(parameter.standard_deviation),
        number(parameter.relative_standard_deviation_percent),
        number(parameter.true_value),
        cell(&parameter.unit).into_owned(),
        cell(&parameter.expression).into_owned(),
        number(parameter.standard_deviation_robust),
        number(parameter.interval_95.map(|[low, _]| low)),
        number(parameter.interval_95.map(|[_, high]| high)),
    ]
}
