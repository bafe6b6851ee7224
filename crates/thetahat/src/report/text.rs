//! The report for the terminal: tables of at most [`TEXT_WIDTH`](super::TEXT_WIDTH) columns, without colour.

use super::{
    closed_loop, diagnosis, facts,
    findings::{findings_text, of_runs_text},
    payload, physical,
    published::Published,
    sections,
    table::Table,
    tables::{self, Detail},
    terms,
    wrap::wrap,
};
use crate::results::Results;

/// Widest label of the head.
const LABEL: usize = 17;

/// The whole report.
#[must_use]
pub fn all(results: &Results, published: Option<&Published>) -> String {
    let findings = findings_text(&results.findings);
    let mut parts = vec![head(results), findings, summary(results), self::diagnosis(results)];
    parts.push(of_runs_text(&results.runs));
    for case in results.cases() {
        parts.push(parameters(results, case));
        parts.push(truth(results, case));
        parts.extend(published.map(|p| self::published(results, p, case)));
    }
    parts.push(physical::text(results));
    parts.extend(payload::tables(results).iter().map(Table::to_text));
    parts.push(terms::text(results));
    parts.extend(published.map(|p| published_runs(results, p)));
    parts.extend([joint_errors(results), tests(results), convergence(results), simulation_errors(results)]);
    parts.retain(|part| !part.is_empty());
    parts.join("\n")
}

/// Title, advice, record, filters, reference, seed.
#[must_use]
pub fn head(results: &Results) -> String {
    let line = |(label, value): (&str, String)| {
        let indent = " ".repeat(LABEL);
        let text = wrap(&value, &indent);
        format!("{label:<LABEL$}{}", text.trim_start())
    };
    let facts = facts::head(results).into_iter().map(line);
    [wrap(&results.title, "")].into_iter().chain(facts).collect()
}

/// One row for each run.
#[must_use]
pub fn summary(results: &Results) -> String {
    tables::summary(results).to_text()
}

/// What tells the methods apart, and what the residuals say; empty where nothing was diagnosed.
#[must_use]
pub fn diagnosis(results: &Results) -> String {
    let tables = [
        diagnosis::comparisons(results),
        diagnosis::explanations(results),
        closed_loop::approximation(results),
        closed_loop::loop_parameters(results),
        diagnosis::residuals(results),
    ];
    let tables = tables.into_iter().flatten().map(|t| t.to_text());
    let notes: String = diagnosis::notes(results).iter().map(|line| wrap(line, "")).collect();
    tables.chain([notes]).filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

/// The shown parameters of a case, the methods side by side, and why a method has no estimate.
#[must_use]
pub fn parameters(results: &Results, case: &str) -> String {
    tables::parameters(results, case).to_text()
}

/// The estimates of a case beside the true values; empty where none are known.
#[must_use]
pub fn truth(results: &Results, case: &str) -> String {
    tables::truth(results, case).map(|t| t.to_text()).unwrap_or_default()
}

/// The published estimates of a case beside ours; empty where none are published.
#[must_use]
pub fn published(results: &Results, published: &Published, case: &str) -> String {
    tables::published(results, published, case, Detail::Estimates).map(|t| t.to_text()).unwrap_or_default()
}

/// Published relative errors and the like beside ours; empty where none are published.
#[must_use]
pub fn published_runs(results: &Results, published: &Published) -> String {
    tables::published_runs(results, published).map(|t| t.to_text()).unwrap_or_default()
}

/// Relative error of each joint; empty for a single joint.
#[must_use]
pub fn joint_errors(results: &Results) -> String {
    tables::joint_errors(results).map(|t| t.to_text()).unwrap_or_default()
}

/// Elimination and F-tests, whether they reject or not; empty where there are none.
#[must_use]
pub fn tests(results: &Results) -> String {
    sections::tests(results).iter().map(|line| wrap(line, "")).collect()
}

/// Every iteration; empty where nothing was iterated.
#[must_use]
pub fn convergence(results: &Results) -> String {
    tables::convergence(results).map(|t| t.to_text()).unwrap_or_default()
}

/// Errors of the closed-loop simulations; empty where nothing was simulated.
#[must_use]
pub fn simulation_errors(results: &Results) -> String {
    tables::simulation_errors(results).map(|t| t.to_text()).unwrap_or_default()
}
