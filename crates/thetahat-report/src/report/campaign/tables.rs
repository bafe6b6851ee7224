//! The tables of a campaign.

use crate::{
    report::{
        number::{NONE, fixed, optional, significant},
        table::Table,
    },
    results::{MethodSummary, ParameterSummary, Quantiles},
};

const HEAD: [&str; 11] =
    ["method", "ok", "bias", "spread", "cover %", "dist %", "pos %", "torque %", "iter", "sims", "ms"];

/// What the columns are.
pub(in crate::report) const LEGEND: &str = "ok: runs that converged; all other figures are from these only. bias: rms over the \
    parameters of the mean error in classical standard deviations. spread: rms over the parameters of the estimates' \
    standard deviation over the classical one (1 if that is right). cover: how often the 95 % interval \
    contains the true value. dist: median of |theta - theta_true| / |theta_true|. pos, torque: medians of the relative \
    errors of the loop simulated with the estimate against the true motion. iter, sims: iterations and closed-loop \
    simulations, on average. ms: time from the measurements to the estimate, on average.";

/// One table for each case and noise level, a row for each method.
pub(in crate::report) fn comparison(summaries: &[MethodSummary]) -> Vec<Table> {
    let mut tables: Vec<Table> = Vec::new();
    for summary in summaries {
        let title = format!("{}, {}, {} runs of each method", summary.case, summary.noise, summary.runs);
        match tables.iter_mut().find(|t| t.title == title) {
            Some(table) => table.rows.push(row(summary)),
            None => tables.push(Table {
                title,
                lead: 1,
                head: HEAD.map(str::to_owned).into(),
                rows: vec![row(summary)],
                ..Table::default()
            }),
        }
    }
    tables.iter_mut().for_each(|table| add_failures(table, summaries));
    tables
}

fn row(s: &MethodSummary) -> Vec<String> {
    let median = |q: &Option<Quantiles>| optional(q.map(|q| q.median), 3);
    let one = |v: Option<f64>| v.map_or_else(|| NONE.to_owned(), |v| fixed(v, 1));
    vec![
        s.method.clone(),
        format!("{}/{}", s.converged, s.runs),
        optional(s.bias, 2),
        optional(s.spread, 3),
        one(s.coverage_percent),
        median(&s.distance_percent),
        median(&s.position_error_percent),
        median(&s.torque_error_percent),
        one(s.iterations),
        one(s.simulations),
        s.seconds.map_or_else(|| NONE.to_owned(), |v| fixed(1e3 * v, 0)),
    ]
}

/// Which methods failed, and how.
fn add_failures(table: &mut Table, summaries: &[MethodSummary]) {
    let of_table = |s: &&MethodSummary| table.title.starts_with(&format!("{}, {}, ", s.case, s.noise));
    let failed = summaries.iter().filter(of_table).filter(|s| !s.failures.is_empty());
    let line = |s: &MethodSummary| {
        let counts: Vec<String> = s.failures.iter().map(|(what, count)| format!("{count} {what}")).collect();
        format!("{}: {}", s.method, counts.join(", "))
    };
    let notes: Vec<String> = failed.map(line).collect();
    table.notes.extend(notes);
}

/// Every parameter in the runs of each method: one table for each case, noise level and method.
pub(in crate::report) fn parameters(summaries: &[MethodSummary]) -> Vec<Table> {
    let table = |s: &MethodSummary| Table {
        title: format!("{}, {}, {}", s.case, s.noise, s.method),
        lead: 2,
        head: [
            "parameter",
            "unit",
            "true",
            "mean",
            "error",
            "sd of estimates",
            "mean classical sd",
            "cover %",
            "classical %",
        ]
        .map(str::to_owned)
        .into(),
        rows: s.parameters.iter().map(parameter).collect(),
        ..Table::default()
    };
    summaries.iter().map(table).filter(|t| !t.rows.is_empty()).collect()
}

fn parameter(p: &ParameterSummary) -> Vec<String> {
    vec![
        p.name.clone(),
        p.unit.clone(),
        significant(p.truth, 4),
        significant(p.mean, 4),
        significant(p.mean - p.truth, 2),
        optional(p.spread, 2),
        significant(p.deviation, 2),
        fixed(p.coverage_percent, 1),
        fixed(p.classical_coverage_percent, 1),
    ]
}
