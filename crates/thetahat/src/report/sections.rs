//! The sections of the page.

use super::{
    diagnosis,
    facts::{facts, weights},
    figures, findings,
    number::significant,
    payload, physical,
    published::Published,
    section::Section,
    table::Table,
    tables::{self, Detail},
    terms,
};
use crate::results::{FTest, Results, RunResult};

/// Probability below which an F-test rejects.
const SIGNIFICANCE: f64 = 0.05;

/// Every section that has something to show.
pub(super) fn all(results: &Results, published: Option<&Published>) -> Vec<Section> {
    let mut sections = vec![
        summary(results),
        findings(results),
        diagnosis::section(results),
        estimates(results),
        physical::section(results),
        payload::section(results),
        terms::section(results),
    ];
    sections.extend(published.map(|p| comparison(results, p)));
    sections.extend([truth(results), formulas(results), torques(results)]);
    sections.extend([convergence(results), tracking(results), elimination(results), method(results)]);
    sections.retain(|s| !s.is_empty());
    sections
}

fn summary(results: &Results) -> Section {
    let runs: Vec<&RunResult> = results.runs.iter().collect();
    let tables = [Some(tables::summary(results)), tables::joint_errors(results)];
    Section {
        id: "summary",
        title: "Summary",
        lines: tables::reasons(&runs),
        tables: tables.into_iter().flatten().collect(),
        ..Section::default()
    }
}

fn findings(results: &Results) -> Section {
    Section {
        id: "checks",
        title: "Checks of the recordings",
        lines: [findings::count(&results.findings) + "."]
            .into_iter()
            .chain(findings::lines(&results.findings))
            .collect(),
        ..Section::default()
    }
}

fn estimates(results: &Results) -> Section {
    let tables = results.cases().into_iter().map(|case| tables::parameters(results, case)).collect();
    let figures = results.cases().into_iter().filter_map(|case| figures::coefficients(results, case)).collect();
    Section { id: "estimates", title: "Estimates", tables, figures, ..Section::default() }
}

fn comparison(results: &Results, published: &Published) -> Section {
    let of_case = |case| tables::published(results, published, case, Detail::Deviations);
    let tables = results.cases().into_iter().filter_map(of_case).chain(tables::published_runs(results, published));
    let tables: Vec<Table> = tables.collect();
    let lines = if tables.is_empty() { Vec::new() } else { vec![published.source.clone()] };
    Section { id: "published", title: "Published figures and ours", lines, tables, ..Section::default() }
}

fn truth(results: &Results) -> Section {
    let tables = results.cases().into_iter().filter_map(|case| tables::truth(results, case)).collect();
    Section { id: "truth", title: "Estimates and true values", tables, ..Section::default() }
}

fn formulas(results: &Results) -> Section {
    let folded = results.cases().into_iter().map(|case| tables::formulas(results, case)).collect();
    Section { id: "formulas", title: "All parameters, with their formulas", folded, ..Section::default() }
}

fn torques(results: &Results) -> Section {
    let of_case = |case| [figures::torques(results, case), figures::residuals(results, case)];
    let figures = results.cases().into_iter().flat_map(of_case).flatten().collect();
    Section { id: "torques", title: "Torques and residuals", figures, ..Section::default() }
}

fn convergence(results: &Results) -> Section {
    let figures = results.cases().into_iter().filter_map(|case| figures::convergence(results, case)).collect();
    let folded = tables::convergence(results).into_iter().collect();
    Section { id: "convergence", title: "Convergence", figures, folded, ..Section::default() }
}

fn tracking(results: &Results) -> Section {
    let figures = results.cases().into_iter().filter_map(|case| figures::tracking(results, case)).collect();
    let tables = tables::simulation_errors(results).into_iter().collect();
    Section { id: "simulation", title: "Closed-loop simulation", tables, figures, ..Section::default() }
}

fn elimination(results: &Results) -> Section {
    Section { id: "tests", title: "Elimination and F-tests", lines: tests(results), ..Section::default() }
}

fn method(results: &Results) -> Section {
    let files = [("Experiment", &results.experiment_description), ("Robot", &results.robot_description)];
    Section {
        id: "method",
        title: "What was done",
        facts: facts(results).into_iter().chain(weights(results).map(|w| ("weights", w))).collect(),
        files: files.map(|(title, text)| (title, text.clone())).into(),
        ..Section::default()
    }
}

/// What the elimination did and what the F-tests say, whether they reject or not.
pub(super) fn tests(results: &Results) -> Vec<String> {
    let mut lines = Vec::new();
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
