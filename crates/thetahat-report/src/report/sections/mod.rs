//! The sections of the page: the torques and the estimates, then details on demand.

pub(in crate::report) mod closed_loop;
pub(in crate::report) mod diagnosis;
pub(in crate::report) mod facts;
pub(in crate::report) mod findings;
pub(in crate::report) mod hidden_bias;
pub(in crate::report) mod model;
pub(in crate::report) mod payload;
pub(in crate::report) mod physical;
pub(in crate::report) mod terms;
pub(in crate::report) mod user_runs;

use super::text::card;
use super::{
    figures,
    number::significant,
    published::Published,
    section::Section,
    table::Table,
    tables::{self, Detail},
};
use crate::results::{FTest, NotSeparated, Results, RunResult, Status, Verdict};
use facts::{facts, weights};

/// Probability below which an F-test rejects.
const SIGNIFICANCE: f64 = 0.05;

/// Every section that is not empty.
pub(super) fn all(results: &Results, published: Option<&Published>) -> Vec<Section> {
    let mut sections = vec![
        torques(results),
        estimates(results, published),
        summary(results),
        user_runs::section(results),
        findings(results),
        residuals(results),
        correlations(results),
        diagnosis(results),
        physical::section(results).folded(physical_hint(results)),
        payload::section(results).folded(""),
        terms::section(results).folded(""),
    ];
    sections.extend(published.map(|p| comparison(results, p)));
    sections.extend([truth(results), formulas(results), convergence(results), tracking(results)]);
    sections.extend([elimination(results), method(results)]);
    sections.retain(|s| !s.is_empty());
    sections
}

/// Whether the recommended estimates are physically consistent.
fn physical_hint(results: &Results) -> &'static str {
    results.card().physical.map_or("", card::physically)
}

/// The case whose figures are shown, and the others.
fn cases(results: &Results) -> (Option<&str>, Vec<&str>) {
    let mut cases = results.cases().into_iter();
    (cases.next(), cases.collect())
}

/// The warning before numbers that must not be used.
fn warning(results: &Results) -> Vec<String> {
    match results.verdict {
        Some(Verdict::DoNotUse) => {
            vec!["Do not use these numbers: they are shown to find out what is wrong.".to_owned()]
        }
        Some(Verdict::Good | Verdict::Care) | None => Vec::new(),
    }
}

fn torques(results: &Results) -> Section {
    let (first, others) = cases(results);
    let figures = |case: &str| [figures::torques(results, case), figures::held_back(results, case)];
    Section {
        id: "torques",
        title: "Torques",
        lines: warning(results),
        figures: first.into_iter().flat_map(figures).flatten().collect(),
        heats: figures::errors(results).into_iter().collect(),
        folded_figures: others.into_iter().filter_map(|case| figures::torques(results, case)).collect(),
        ..Section::default()
    }
}

fn estimates(results: &Results, published: Option<&Published>) -> Section {
    let (first, others) = cases(results);
    let further = first.and_then(|case| figures::not_identified(results, published, case));
    Section {
        id: "estimates",
        title: "Estimates",
        lines: warning(results),
        forests: first.and_then(|case| figures::forest(results, published, case)).into_iter().collect(),
        folded_forests: further
            .into_iter()
            .chain(others.into_iter().filter_map(|case| figures::forest(results, published, case)))
            .collect(),
        folded: results.cases().into_iter().map(|case| tables::parameters(results, case)).collect(),
        ..Section::default()
    }
}

fn summary(results: &Results) -> Section {
    let runs: Vec<&RunResult> = results.runs.iter().collect();
    let section = Section {
        id: "summary",
        title: "Runs",
        lines: tables::reasons(&runs),
        tables: vec![tables::summary(results)],
        ..Section::default()
    };
    let plural = if runs.len() == 1 { "" } else { "s" };
    let converged = runs.iter().filter(|r| r.status == Status::Converged).count();
    let all = if converged == runs.len() { "all".to_owned() } else { converged.to_string() };
    section.folded(format!("{} run{plural}, {all} converged", runs.len()))
}

fn findings(results: &Results) -> Section {
    let count = findings::count(&results.findings);
    let lines = findings::lines(&results.findings);
    let lines = if lines.is_empty() { vec![format!("{count}.")] } else { lines };
    Section { id: "checks", title: "Checks of the recordings", lines, ..Section::default() }.folded(count)
}

fn residuals(results: &Results) -> Section {
    let (first, _) = cases(results);
    Section {
        id: "residuals",
        title: "Residual over other quantities",
        figures: first.map(|case| figures::misfit(results, case)).unwrap_or_default(),
        ..Section::default()
    }
    .folded("autocorrelation, spectrum, velocity, position, load")
}

fn correlations(results: &Results) -> Section {
    let (first, _) = cases(results);
    let run = results.recommended_run();
    let hint = match run.map(|r| figures::confounded(r).len()) {
        None => "",
        Some(0) => "no confounded pairs",
        Some(_) => "confounded pairs",
    };
    Section {
        id: "correlations",
        title: "Parameters that the motion cannot separate",
        figures: first.and_then(|case| figures::correlation(results, case)).into_iter().collect(),
        ..Section::default()
    }
    .folded(hint)
}

/// The advice recommends a method: it is not shown if no number can be used.
fn diagnosis(results: &Results) -> Section {
    let advice: Vec<String> = match results.verdict {
        Some(Verdict::DoNotUse) => Vec::new(),
        Some(Verdict::Good | Verdict::Care) | None => diagnosis::advice(results).map(|(_, text)| text).collect(),
    };
    let section = diagnosis::section(results);
    let lines = advice.into_iter().chain(section.lines).collect();
    Section { lines, ..section }.folded("which method to use, and why")
}

fn comparison(results: &Results, published: &Published) -> Section {
    let of_case = |case| tables::published(results, published, case, Detail::Deviations);
    let tables = results.cases().into_iter().filter_map(of_case).chain(tables::published_runs(results, published));
    let tables: Vec<Table> = tables.collect();
    let lines = if tables.is_empty() { Vec::new() } else { vec![published.source.clone()] };
    Section { id: "published", title: "Published figures and ours", lines, tables, ..Section::default() }.folded("")
}

fn truth(results: &Results) -> Section {
    let tables = results.cases().into_iter().filter_map(|case| tables::truth(results, case)).collect();
    Section { id: "truth", title: "Estimates and true values", tables, ..Section::default() }.folded("")
}

fn formulas(results: &Results) -> Section {
    let tables = results.cases().into_iter().map(|case| tables::formulas(results, case)).collect();
    Section { id: "formulas", title: "All parameters, with their formulas", tables, ..Section::default() }.folded("")
}

fn convergence(results: &Results) -> Section {
    let figures = results.cases().into_iter().filter_map(|case| figures::convergence(results, case)).collect();
    let folded = tables::convergence(results).into_iter().collect();
    Section { id: "convergence", title: "Convergence", figures, folded, ..Section::default() }.folded("")
}

fn tracking(results: &Results) -> Section {
    let (first, _) = cases(results);
    let figures = first.and_then(|case| figures::tracking(results, case)).into_iter().collect();
    let tables = tables::simulation_errors(results).into_iter().collect();
    Section { id: "simulation", title: "Closed-loop simulation", tables, figures, ..Section::default() }.folded("")
}

fn elimination(results: &Results) -> Section {
    Section { id: "tests", title: "Elimination and F-tests", lines: tests(results), ..Section::default() }.folded("")
}

fn method(results: &Results) -> Section {
    let files = [("Experiment", &results.experiment_description), ("Robot", &results.robot_description)];
    Section {
        id: "method",
        title: "Data and method",
        facts: facts(results).into_iter().chain(weights(results).map(|w| ("weights", w))).collect(),
        files: files.map(|(title, text)| (title, text.clone())).into(),
        ..Section::default()
    }
    .folded("recordings, filters, weights, files")
}
fn not_separated(NotSeparated { parameter, with }: &NotSeparated) -> String {
    if with.is_empty() {
        return format!("Left out: {parameter}, which has no effect in this motion.");
    }
    let all = with.join(" ");
    format!("Left out: {parameter}, which this motion does not separate from {all}; their estimates include it.")
}

/// What was left out, and the F-tests whether they reject or not.
pub(super) fn tests(results: &Results) -> Vec<String> {
    let mut lines: Vec<String> = results.not_separated.iter().map(not_separated).collect();
    if let Some(elimination) = &results.elimination {
        lines.push(format!("Kept, {}: {}.", elimination.kept.len(), elimination.kept.join(" ")));
        let taken = elimination.eliminated.join(" ");
        lines.push(format!("Eliminated in this order, {}: {taken}.", elimination.eliminated.len()));
        lines.extend(elimination.f_test.as_ref().map(|t| verdict("the parameters kept", t)));
    }
    let of_run = |r: &RunResult| {
        let what = format!("the parameters of {} {}", r.case, r.method.name());
        r.f_test.as_ref().map(|t| verdict(&what, t))
    };
    lines.extend(results.runs.iter().filter_map(of_run));
    lines
}

fn verdict(what: &str, test: &FTest) -> String {
    let FTest { statistic, numerator_freedom, denominator_freedom, p_value } = test;
    let outcome = if *p_value < SIGNIFICANCE { "rejected" } else { "not rejected" };
    format!(
        "F-test of {what} against all base parameters: F({numerator_freedom}, {denominator_freedom}) = {}, p = {}: \
         {outcome} at 5 %.",
        significant(*statistic, 4),
        significant(*p_value, 2),
    )
}
