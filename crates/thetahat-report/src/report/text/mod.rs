//! The report for the terminal: lines that fit, without colour.

pub(in crate::report) mod brief;
pub(in crate::report) mod card;
pub(in crate::report) mod contents;
pub(in crate::report) mod grades;
pub(in crate::report) mod model_text;
pub(in crate::report) mod remedies;

use super::{
    published::Published,
    sections::{
        self, closed_loop, diagnosis, facts,
        findings::{findings_text, of_runs_text},
        hidden_bias, model, payload, physical, terms, user_runs,
    },
    tables::{self, Detail},
    wrap::{TextWidth, labelled, wrap},
};
use crate::results::Results;

/// Widest label of the head.
const LABEL: usize = 17;

/// The whole report.
#[must_use]
pub fn all(results: &Results, published: Option<&Published>, width: TextWidth) -> String {
    let findings = findings_text(&results.findings, width);
    let mut parts = vec![head(results, width), findings, summary(results, width), self::diagnosis(results, width)];
    parts.push(of_runs_text(&results.runs, width));
    for case in results.cases() {
        parts.push(parameters(results, case, width));
        parts.push(truth(results, case, width));
        parts.extend(published.map(|p| self::published(results, p, case, width)));
    }
    parts.push(user_runs::text(results, width));
    parts.push(model::text(results, width));
    parts.push(physical::text(results, width));
    parts.extend(payload::tables(results).iter().map(|table| table.to_text(width)));
    parts.push(terms::text(results, width));
    parts.extend(published.map(|p| published_runs(results, p, width)));
    let last = [joint_errors, tests, convergence, simulation_errors];
    parts.extend(last.map(|part| part(results, width)));
    parts.retain(|part| !part.is_empty());
    parts.join("\n")
}

/// Title, advice, recordings, filters, reference, seed.
#[must_use]
pub fn head(results: &Results, width: TextWidth) -> String {
    let line = |(label, value): (&str, String)| labelled(label, &value, LABEL, width);
    let facts = facts::head(results).into_iter().map(line);
    [wrap(&results.title, "", width)].into_iter().chain(facts).collect()
}

/// One row for each run.
#[must_use]
pub fn summary(results: &Results, width: TextWidth) -> String {
    tables::summary(results).to_text(width)
}

/// Comparisons of the methods and tests of the residuals; may be empty.
#[must_use]
pub fn diagnosis(results: &Results, width: TextWidth) -> String {
    let tables = [
        diagnosis::comparisons(results),
        diagnosis::explanations(results),
        closed_loop::approximation(results),
        closed_loop::loop_parameters(results),
        diagnosis::residuals(results),
        hidden_bias::table(results),
    ];
    let tables = tables.into_iter().flatten().map(|t| t.to_text(width));
    let notes: String = diagnosis::notes(results).iter().map(|line| wrap(line, "", width)).collect();
    tables.chain([notes]).filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

/// The shown parameters of a case by method, and why a method has no estimate.
#[must_use]
pub fn parameters(results: &Results, case: &str, width: TextWidth) -> String {
    tables::parameters(results, case).to_text(width)
}

/// The estimates of a case with the true values; empty without true values.
#[must_use]
pub fn truth(results: &Results, case: &str, width: TextWidth) -> String {
    tables::truth(results, case).map(|t| t.to_text(width)).unwrap_or_default()
}

/// The published estimates of a case compared with ours; may be empty.
#[must_use]
pub fn published(results: &Results, published: &Published, case: &str, width: TextWidth) -> String {
    tables::published(results, published, case, Detail::Estimates).map(|t| t.to_text(width)).unwrap_or_default()
}

/// Published figures of the runs compared with ours; may be empty.
#[must_use]
pub fn published_runs(results: &Results, published: &Published, width: TextWidth) -> String {
    tables::published_runs(results, published).map(|t| t.to_text(width)).unwrap_or_default()
}

/// Relative error of each joint; empty for a single joint.
#[must_use]
pub fn joint_errors(results: &Results, width: TextWidth) -> String {
    tables::joint_errors(results).map(|t| t.to_text(width)).unwrap_or_default()
}

/// Elimination and F-tests, whether they reject or not; may be empty.
#[must_use]
pub fn tests(results: &Results, width: TextWidth) -> String {
    sections::tests(results).iter().map(|line| wrap(line, "", width)).collect()
}

/// Every iteration; may be empty.
#[must_use]
pub fn convergence(results: &Results, width: TextWidth) -> String {
    tables::convergence(results).map(|t| t.to_text(width)).unwrap_or_default()
}

/// Errors of the closed-loop simulations; may be empty.
#[must_use]
pub fn simulation_errors(results: &Results, width: TextWidth) -> String {
    tables::simulation_errors(results).map(|t| t.to_text(width)).unwrap_or_default()
}
