//! The sections of the page, and the facts that the terminal shows too.

use serde::Serialize;

use super::{
    Published, Table, diagnosis,
    figures::{self, Figure},
    findings,
    number::{given, optional, significant},
    tables::{self, Detail},
};
use crate::{
    results::{RecordingResult, Results, RunResult},
    statistics::FTest,
};

/// Probability below which an F-test rejects.
const SIGNIFICANCE: f64 = 0.05;

/// A section of the page.
#[derive(Debug, Default, Serialize)]
pub(super) struct Section {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) lines: Vec<String>,
    pub(super) facts: Vec<(&'static str, String)>,
    pub(super) tables: Vec<Table>,
    pub(super) figures: Vec<Figure>,
    /// Tables that open on demand.
    pub(super) folded: Vec<Table>,
    /// Files that open on demand, each with its title.
    pub(super) files: Vec<(&'static str, String)>,
}

impl Section {
    pub(super) fn is_empty(&self) -> bool {
        self.tables.is_empty()
            && self.figures.is_empty()
            && self.folded.is_empty()
            && self.files.is_empty()
            && self.lines.is_empty()
    }
}

/// Every section that has something to show.
pub(super) fn all(results: &Results, published: Option<&Published>) -> Vec<Section> {
    let mut sections = vec![summary(results), findings(results), diagnosis::section(results), estimates(results)];
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

/// The head: what to take, then what was recorded and how it was filtered.
pub(super) fn head(results: &Results) -> Vec<(&'static str, String)> {
    diagnosis::advice(results).chain(facts(results)).collect()
}

/// What was recorded and how it was filtered, as labels and texts.
pub(super) fn facts(results: &Results) -> Vec<(&'static str, String)> {
    let rows = format!("{} after decimation", results.decimated_rows);
    let mut facts = vec![("robot", results.robot.clone())];
    facts.extend(recordings("samples used", &results.recordings));
    facts.extend(recordings("held back", &results.validation_recordings));
    facts.push(("rows", rows));
    facts.extend(filters(results));
    facts.extend(references(results).map(|r| ("reference", r)));
    facts.extend(results.seed.map(|seed| ("seed", seed.to_string())));
    facts.push(("thetahat", results.thetahat.clone()));
    facts
}

/// A line for each recording; its name is shown where there are several.
fn recordings(label: &'static str, recordings: &[RecordingResult]) -> Vec<(&'static str, String)> {
    let line = |r: &RecordingResult| {
        let [start, end, rate] = [r.window_s[0], r.window_s[1], r.sample_rate_hz].map(given);
        let name = if recordings.len() > 1 { format!("{}: ", r.name) } else { String::new() };
        let weight = if r.weight == 1.0 { String::new() } else { format!(", weight {}", given(r.weight)) };
        let resampled = r.resampling.map(|j| {
            let [rms, largest] = [j.rms_deviation, j.largest_deviation].map(|d| significant(100.0 * d, 2));
            format!("; resampled, its steps deviate by {rms} % rms, {largest} % at most")
        });
        let window = format!("{} at {rate} Hz, window {start} s to {end} s", r.samples_used);
        (label, format!("{name}{window}{weight}{}", resampled.unwrap_or_default()))
    };
    recordings.iter().map(line).collect()
}

/// One line for each recording's reference.
fn references(results: &Results) -> impl Iterator<Item = String> {
    let several = results.recordings.len() > 1;
    results.recordings.iter().filter_map(move |r| {
        let text = reference(results, r.reference.as_ref()?);
        Some(if several { format!("{}: {text}", r.name) } else { text })
    })
}

fn filters(results: &Results) -> [(&'static str, String); 2] {
    let bandwidth = &results.bandwidth;
    let position = format!(
        "{} Hz asked; measured: positions {}, accelerations {} Hz",
        given(bandwidth.position_cutoff_hz),
        optional(bandwidth.position_measured_hz, 3),
        optional(bandwidth.acceleration_measured_hz, 3),
    );
    let decimation = format!(
        "{} Hz asked; measured: {} Hz",
        given(bandwidth.decimation_cutoff_hz),
        optional(bandwidth.decimation_measured_hz, 3),
    );
    [("position filter", position), ("parallel filter", decimation)]
}

fn reference(results: &Results, reference: &crate::results::ReferenceResult) -> String {
    let moves = reference.moves.map(|m| format!(", {m} moves")).unwrap_or_default();
    let worst = reference.rms_deviation.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    let deviation = worst.map(|(joint, rms)| {
        let unit = if figures::is_prismatic(results, joint) { "mm" } else { "mrad" };
        format!("; worst rms deviation {} {unit}, joint {}", significant(1e3 * rms, 3), joint + 1)
    });
    format!("{}{moves}{}", reference.origin, deviation.unwrap_or_default())
}

/// The weights of each method, from the experiment's text.
fn weights(results: &Results) -> Option<String> {
    let file: toml::Table = results.experiment_description.parse().ok()?;
    let weighting = file.get("estimation").and_then(|e| e.get("weighting"));
    let of_method = |name: &str| weighting.and_then(|w| w.get(name)?.as_str()).unwrap_or("none").to_owned();
    let mut weights: Vec<String> = Vec::new();
    for run in &results.runs {
        let weight = format!("{} {}", run.method.name(), of_method(run.method.name()));
        if !weights.contains(&weight) {
            weights.push(weight);
        }
    }
    Some(weights.join(", "))
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
