//! Figures of many runs. Failed runs are counted, and their numbers are in no figure.

use super::{CampaignRuns, Row};
use thetahat_report::results::{MethodSummary, ParameterSummary, Quantiles};

/// Standard deviations on both sides that hold 95 % of a normal distribution.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// The five numbers of finite values; none without any.
#[must_use]
pub fn quantiles(values: impl IntoIterator<Item = f64>) -> Option<Quantiles> {
    let mut sorted: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (smallest, largest) = (*sorted.first()?, *sorted.last()?);
    let at = |part: f64| {
        let place = part * (sorted.len() - 1) as f64;
        let (k, rest) = (place as usize, place.fract());
        let next = sorted[(k + 1).min(sorted.len() - 1)];
        sorted[k] + rest * (next - sorted[k])
    };
    Some(Quantiles { smallest, lower: at(0.25), median: at(0.5), upper: at(0.75), largest })
}

/// One summary for each case, noise level and method, in the order of the rows.
#[must_use]
pub fn summarise(runs: &CampaignRuns) -> Vec<MethodSummary> {
    groups(&runs.rows).into_iter().map(|rows| summary_of(runs, &rows)).collect()
}

/// The parameters with a true value in the converged runs of a case, noise level and method.
#[must_use]
pub fn parameter_summaries(runs: &CampaignRuns, case: &str, noise: &str, method: &str) -> Vec<ParameterSummary> {
    let fits = |r: &&Row| r.case == case && r.noise == noise && r.method == method && r.has_converged();
    let rows: Vec<&Row> = runs.rows.iter().filter(fits).collect();
    parameters(runs, &rows)
}

/// Rows of the same case, noise level and method, in the order in which they first come; cases within a noise level.
fn groups(rows: &[Row]) -> Vec<Vec<&Row>> {
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        let same = |g: &&mut Vec<&Row>| {
            g.first().is_some_and(|f| (&f.case, &f.noise, &f.method) == (&row.case, &row.noise, &row.method))
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(row),
            None => groups.push(vec![row]),
        }
    }
    groups
}

fn parameters(runs: &CampaignRuns, converged: &[&Row]) -> Vec<ParameterSummary> {
    let summary = |(i, p): (usize, &super::CampaignParameter)| {
        let pairs = converged.iter().filter_map(|r| r.estimates[i].zip(r.deviations[i]));
        let (estimates, deviations): (Vec<f64>, Vec<f64>) = pairs.unzip();
        let (truth, mean) = (p.truth?, mean(estimates.iter().copied())?);
        let classical = estimates.iter().zip(&deviations).filter(|(e, d)| (*e - truth).abs() <= NORMAL_95 * **d);
        let intervals = || converged.iter().filter_map(|r| r.intervals[i]);
        let holding = |value: f64| intervals().filter(|[low, high]| (*low..=*high).contains(&value)).count();
        let percent = |count: usize| 100.0 * count as f64 / estimates.len() as f64;
        Some(ParameterSummary {
            name: p.name.clone(),
            unit: p.unit.clone(),
            truth,
            mean,
            spread: standard_deviation(&estimates),
            deviation: self::mean(deviations.iter().copied())?,
            coverage_percent: percent(holding(truth)),
            classical_coverage_percent: percent(classical.count()),
            power_percent: percent(intervals().count() - holding(0.0)),
            count: estimates.len(),
        })
    };
    runs.facts.parameters.iter().enumerate().filter_map(summary).collect()
}

fn summary_of(runs: &CampaignRuns, rows: &[&Row]) -> MethodSummary {
    let converged: Vec<&Row> = rows.iter().copied().filter(|r| r.has_converged()).collect();
    let numbers = |f: &dyn Fn(&Row) -> Option<f64>| converged.iter().filter_map(|r| f(r)).collect::<Vec<f64>>();
    let parameters = parameters(runs, &converged);
    let estimates: usize = parameters.iter().map(|p| p.count).sum();
    let pooled = |coverage: fn(&ParameterSummary) -> f64| {
        let covered: f64 = parameters.iter().map(|p| coverage(p) * p.count as f64).sum();
        (estimates > 0).then(|| covered / estimates as f64)
    };
    let size = runs.facts.parameters.iter().filter_map(|p| p.truth).map(|t| t * t).sum::<f64>().sqrt();
    let text = |f: fn(&Row) -> &String| rows.first().map(|r| f(r).clone()).unwrap_or_default();
    MethodSummary {
        case: text(|r| &r.case),
        noise: text(|r| &r.noise),
        method: text(|r| &r.method),
        runs: rows.len(),
        converged: converged.len(),
        bias: root_mean_square(parameters.iter().map(|p| (p.mean - p.truth) / p.deviation)),
        spread: root_mean_square(parameters.iter().filter_map(|p| Some(p.spread? / p.deviation))),
        coverage_percent: pooled(|p| p.coverage_percent),
        classical_coverage_percent: pooled(|p| p.classical_coverage_percent),
        iterations: mean(converged.iter().map(|r| r.iterations as f64)),
        simulations: mean(converged.iter().map(|r| r.simulations as f64)),
        seconds: mean(numbers(&|r| r.seconds)),
        distance_percent: quantiles(numbers(&|r| r.parameter_distance.map(|d| 100.0 * d / size))),
        position_error_percent: quantiles(numbers(&|r| r.position_error_percent)),
        torque_error_percent: quantiles(numbers(&|r| r.torque_error_percent)),
        failures: failures(rows),
        parameters,
    }
}

fn failures(rows: &[&Row]) -> Vec<(String, usize)> {
    let mut failures: std::collections::BTreeMap<&str, usize> = std::collections::BTreeMap::new();
    for row in rows.iter().filter(|r| !r.has_converged()) {
        *failures.entry(super::row::status_name(row.status)).or_default() += 1;
    }
    failures.into_iter().map(|(name, count)| (name.replace('_', " "), count)).collect()
}

fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_usize);
    values.into_iter().for_each(|v| {
        sum += v;
        count += 1;
    });
    (count > 0).then(|| sum / count as f64)
}

fn root_mean_square(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    mean(values.into_iter().map(|v| v * v)).map(f64::sqrt)
}

fn standard_deviation(values: &[f64]) -> Option<f64> {
    let mean = mean(values.iter().copied()).filter(|_| values.len() > 1)?;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    Some((squares / (values.len() - 1) as f64).sqrt())
}
