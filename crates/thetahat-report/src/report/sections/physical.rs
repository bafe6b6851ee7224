//! Physical consistency of the estimates, and consistent estimates.

use super::findings;
use crate::{
    report::{
        number::{NONE, estimate, optional, significant},
        section::Section,
        table::{Group, Table, strings},
        tables::runs_of,
        wrap::{TextWidth, wrap},
    },
    results::{ConsistentEstimate, ConsistentParameter, PhysicalResult, Results, RunResult},
};

/// Names that a cell lists.
const LISTED: usize = 1;

pub(in crate::report) fn section(results: &Results) -> Section {
    let cases = results.cases();
    let of_cases =
        |table: fn(&Results, &str) -> Option<Table>| cases.iter().filter_map(move |case| table(results, case));
    Section {
        id: "physical",
        title: "Physical consistency",
        lines: findings::lines_of_runs(&results.runs).into_iter().chain(lines(results)).collect(),
        tables: [examined(results), consistent(results)].into_iter().flatten().collect(),
        folded: of_cases(base_parameters).chain(of_cases(standard_parameters)).collect(),
        ..Section::default()
    }
}

fn is_requested(results: &Results) -> bool {
    results.runs.iter().any(|r| r.physical.as_ref().is_some_and(|p| p.estimate.is_some() || p.reason.is_some()))
}

/// The conclusions on consistency; empty if consistent estimates were not requested.
pub(in crate::report) fn brief(results: &Results, width: TextWidth) -> String {
    if is_requested(results) {
        lines(results).iter().map(|line| wrap(line, "", width)).collect()
    } else {
        String::new()
    }
}

/// The consistent estimates for the terminal; empty if they were not requested.
pub(in crate::report) fn text(results: &Results, width: TextWidth) -> String {
    if !is_requested(results) {
        return String::new();
    }
    let tables = [examined(results), consistent(results)].into_iter().flatten().map(|t| t.to_text(width));
    let lines: String = lines(results).iter().map(|line| wrap(line, "", width)).collect();
    let cases = results.cases();
    let parameters = cases.iter().filter_map(|case| base_parameters(results, case)).map(|t| t.to_text(width));
    tables.chain([lines]).chain(parameters).filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

fn with_estimate(results: &Results) -> impl Iterator<Item = (&RunResult, &ConsistentEstimate)> {
    results.runs.iter().filter_map(|r| Some((r, r.physical.as_ref()?.estimate.as_ref()?)))
}

/// One row for each free estimate.
fn examined(results: &Results) -> Option<Table> {
    let row = |r: &RunResult| {
        let physical = r.physical.as_ref()?;
        Some(vec![
            r.case.clone(),
            r.method.name().to_owned(),
            if physical.consistent { "yes" } else { "no" }.to_owned(),
            significant(physical.smallest_eigenvalue, 3),
            optional(physical.deviations, 2),
            inconsistent(physical),
        ])
    };
    let rows: Vec<Vec<String>> = results.runs.iter().filter_map(row).collect();
    (!rows.is_empty()).then(|| Table {
        title: "Physical consistency of the estimates".to_owned(),
        lead: 2,
        head: strings(&["case", "method", "physical", "eigenvalue", "sd", "inconsistent: violation"]),
        rows,
        notes: strings(&[
            "eigenvalue: the smallest of the pseudo-inertia matrices of all links, at the standard parameters with these base \
             parameters and the smallest violation. sd: distance from the consistent set in standard deviations, with correlated errors. Violations of links are in kg m^2.",
        ]),
        ..Table::default()
    })
}

fn inconsistent(physical: &PhysicalResult) -> String {
    let all = physical.inconsistent.iter().zip(&physical.violations);
    let mut cells: Vec<String> =
        all.take(LISTED).map(|(name, violation)| format!("{name}: {}", significant(*violation, 2))).collect();
    match physical.inconsistent.len().saturating_sub(LISTED) {
        0 => {}
        more => cells.push(format!("{more} more")),
    }
    if cells.is_empty() { NONE.to_owned() } else { cells.join(", ") }
}

/// One row for each consistent estimate.
fn consistent(results: &Results) -> Option<Table> {
    let row = |(r, e): (&RunResult, &ConsistentEstimate)| {
        let test = e.test;
        vec![
            r.case.clone(),
            r.method.name().to_owned(),
            significant(e.squared_residual_free, 5),
            significant(e.squared_residual, 5),
            optional(r.relative_error_percent, 3),
            significant(e.relative_error_percent, 3),
            optional(test.map(|t| t.statistic), 3),
            optional(test.map(|t| t.numerator_freedom), 2),
            optional(test.map(|t| t.p_value), 2),
            significant(e.smallest_eigenvalue, 2),
            significant(1e3 * e.seconds, 2),
        ]
    };
    let rows: Vec<Vec<String>> = with_estimate(results).map(row).collect();
    (!rows.is_empty()).then(|| Table {
        title: "Physically consistent estimates".to_owned(),
        lead: 2,
        groups: [("squared residual", 2), ("error %", 2), ("test", 3), ("consistent", 2)]
            .map(|(label, columns)| Group { label: label.to_owned(), columns })
            .into(),
        head: strings(&["case", "method", "free", "cons.", "free", "cons.", "F", "k", "p", "eigenvalue", "ms"]),
        rows,
        notes: strings(&[
            "F: squared distance from the unconstrained estimate in the metric of the method, over the k parameters that the conditions fix \
             and the variance of the error, correlated in time; p: probability of an F at least as large if a consistent \
             robot made the recording.",
        ]),
    })
}

/// The assumptions, and the result of the test for each estimate.
fn lines(results: &Results) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some((_, e)) = with_estimate(results).next() {
        let weight = significant(e.prior_weight, 2);
        let known = if e.known.is_empty() { String::new() } else { format!(" Known: {}.", e.known.join("; ")) };
        lines.push(format!(
            "Consistent estimates are regularized towards the a-priori parameters by a {} distance with weight {weight}, in variances of the \
             error.{known}",
            e.prior
        ));
    }
    lines.extend(with_estimate(results).map(|(r, e)| verdict(r, e)));
    let failed = |r: &RunResult| {
        let reason = r.physical.as_ref()?.reason.as_ref()?;
        Some(format!("{} {}: no consistent estimate: {reason}.", r.case, r.method.name()))
    };
    lines.extend(results.runs.iter().filter_map(failed));
    lines
}

fn verdict(run: &RunResult, e: &ConsistentEstimate) -> String {
    let (case, method) = (&run.case, run.method.name());
    let more = 100.0 * (e.squared_residual / e.squared_residual_free - 1.0);
    let cost = format!("the squared residual changes by {} %", significant(more, 2));
    let boundary = match e.at_boundary.as_slice() {
        [] => String::new(),
        names => format!(" At the boundary: {}.", names.join(", ")),
    };
    let rejected = run.physical.as_ref().and_then(PhysicalResult::rejects);
    let conclusion = match (e.converged, rejected) {
        (false, _) => "the solver did not reach its accuracy; use the numbers with caution".to_owned(),
        (true, Some(true)) => format!(
            "the data reject consistency ({cost}): more than noise explains. Look at what the model leaves out (elasticity, \
             friction that depends on load), at signs, gains and units of the torques, and at the geometry"
        ),
        (true, Some(false) | None) => {
            format!("the data do not reject consistency ({cost}): use the consistent estimate")
        }
    };
    format!("{case} {method}: {conclusion}.{boundary}")
}

/// Free and consistent base parameters of a case, the methods side by side.
fn base_parameters(results: &Results, case: &str) -> Option<Table> {
    let cells = |e: &ConsistentEstimate, k: usize| -> Vec<String> {
        let Some(p) = e.parameters.get(k) else { return vec![NONE.to_owned(); 4] };
        // As many digits as the interval, or the change where that is larger.
        let width = p.interval_95.map_or(0.0, |[low, high]| 0.5 * (high - low));
        let change = p.reference_value.map_or(0.0, |free| 0.1 * (free - p.estimate).abs());
        let digits = Some(width.max(change)).filter(|d| *d > 0.0);
        let number = |v: Option<f64>| v.map_or_else(|| NONE.to_owned(), |v| estimate(v, digits));
        let [low, high] = [0, 1].map(|end: usize| p.interval_95.map(|ends| ends[end]));
        [p.reference_value, Some(p.estimate), low, high].map(number).to_vec()
    };
    let title = format!("{case}: free and consistent base parameters, with 95 % intervals");
    table_of(results, case, title, |e| &e.parameters, cells, &["free", "consistent", "low", "high"])
}

/// All standard parameters of a case with their a-priori values.
fn standard_parameters(results: &Results, case: &str) -> Option<Table> {
    let cells = |e: &ConsistentEstimate, k: usize| -> Vec<String> {
        let Some(p) = e.standard.get(k) else { return vec![NONE.to_owned(); 2] };
        vec![optional(p.reference_value, 4), significant(p.estimate, 4)]
    };
    let title = format!("{case}: standard parameters of the consistent estimates");
    table_of(results, case, title, |e| &e.standard, cells, &["a priori", "consistent"])
}

fn table_of(
    results: &Results,
    case: &str,
    title: String,
    of: fn(&ConsistentEstimate) -> &Vec<ConsistentParameter>,
    cells: impl Fn(&ConsistentEstimate, usize) -> Vec<String>,
    each: &[&str],
) -> Option<Table> {
    let estimate = |r: &&'_ RunResult| r.physical.as_ref().and_then(|p| p.estimate.as_ref()).is_some();
    let runs: Vec<&RunResult> = runs_of(results, case).into_iter().filter(estimate).collect();
    let estimates: Vec<&ConsistentEstimate> =
        runs.iter().filter_map(|r| r.physical.as_ref()?.estimate.as_ref()).collect();
    let row = |(k, p): (usize, &ConsistentParameter)| {
        let names = [p.name.clone(), p.unit.clone()];
        names.into_iter().chain(estimates.iter().flat_map(|e| cells(e, k))).collect()
    };
    let rows: Vec<Vec<String>> = of(estimates.first()?).iter().enumerate().map(row).collect();
    let heads = runs.iter().flat_map(|_| strings(each));
    Some(Table {
        title,
        lead: 2,
        groups: runs.iter().map(|r| Group { label: r.method.name().to_owned(), columns: each.len() }).collect(),
        head: strings(&["name", "unit"]).into_iter().chain(heads).collect(),
        rows,
        ..Table::default()
    })
}
