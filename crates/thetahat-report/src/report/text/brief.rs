//! The results on one screen: findings, runs and the estimates of the recommended method.

use crate::{
    report::{
        number::{self, NONE, estimate, optional},
        sections::{facts, findings, model, payload, physical, terms},
        table::Table,
        tables,
        wrap::{TextWidth, shortened, wrap},
    },
    results::{Grade, LoopParameterResult, NOMINAL, ParameterResult, Results, RunResult, Verdict},
};
use thetahat_ground::visible::visible;

/// Columns between two estimates in a line.
const GAP: usize = 3;

/// The identified robot, findings, runs and the recommended estimates. The verdict card is printed below.
#[must_use]
pub fn brief(results: &Results, width: TextWidth) -> String {
    let of_runs = runs(results, width) + &model::brief(results, width);
    let mut parts = vec![head(results, width), findings::brief(results, width), of_runs];
    parts.push(physical::brief(results, width));
    parts.extend(payload::tables(results).iter().map(|table| table.to_text(width)));
    parts.push(terms::profiled(results).map(|line| wrap(&line, "", width)).collect());
    match &results.model {
        Some(model) => parts.push(estimates(&model.quoted(NOMINAL), "the model", width)),
        None => parts.extend(results.recommended_run().map(|run| estimates(run, run.method.name(), width))),
    }
    parts.retain(|part| !part.is_empty());
    parts.join("\n")
}

fn head(results: &Results, width: TextWidth) -> String {
    let rates: Vec<String> =
        results.recordings.iter().map(|r| format!("{} Hz", number::rate(r.sample_rate_hz))).collect();
    let rate = rates
        .first()
        .filter(|first| rates.iter().all(|r| r == *first))
        .map_or_else(String::new, |r| format!(" at {r}"));
    let several =
        if results.recordings.len() > 1 { format!("{} recordings, ", results.recordings.len()) } else { String::new() };
    let used = format!(
        "{}: {several}{} samples{rate}, {} after decimation",
        results.robot,
        results.samples_used,
        rows(results)
    );
    let locked = facts::locked_joints(results).map(|joints| format!("locked: {joints}"));
    let lines = [Some(results.title.clone()), Some(used), locked];
    lines.iter().flatten().map(|line| wrap(line, "", width)).collect()
}

/// The number of rows, per joint if all joints have the same number: without samples near rest they may differ.
fn rows(results: &Results) -> String {
    let all_rows = results.recordings.iter().all(|r| r.near_rest.is_none());
    let rows = results.decimated_rows;
    match results.runs.iter().map(|r| r.joint_relative_error_percent.len()).max() {
        Some(0 | 1) | None => format!("{rows} rows"),
        Some(joints) if all_rows && rows.is_multiple_of(joints) => format!("{joints} \u{d7} {} rows", rows / joints),
        Some(joints) => format!("{rows} rows of {joints} joints"),
    }
}

/// One row for each run; with the case if there are several.
fn runs(results: &Results, width: TextWidth) -> String {
    let several = results.cases().len() > 1;
    let recommended = results
        .recommended_run()
        .filter(|_| results.verdict != Some(Verdict::DoNotUse) && results.model.is_none())
        .map(|r| (r.case.clone(), r.method));
    let is_recommended =
        |r: &RunResult| recommended.as_ref().is_some_and(|(case, method)| (case, method) == (&r.case, &r.method));
    let row = |r: &RunResult| {
        let case = several.then(|| r.case.clone());
        let figures = [
            if is_recommended(r) { format!("{} *", r.method.name()) } else { r.method.name().to_owned() },
            r.status.name().to_owned(),
            optional(r.relative_error_percent, 3),
            optional(r.cross_validation_relative_error_percent, 3),
        ];
        case.into_iter().chain(figures).collect()
    };
    let head = several.then_some("case").into_iter().chain(["method", "status", "error %", "validation %"]);
    let validation = tables::validation(results);
    let star = if recommended.is_some() { "* recommended. " } else { "" };
    let runs: Vec<&RunResult> = results.runs.iter().collect();
    let table = Table {
        title: "Runs".to_owned(),
        lead: if several { 3 } else { 2 },
        head: head.map(str::to_owned).collect(),
        rows: results.runs.iter().map(row).collect(),
        notes: validation
            .map(|text| format!("{star}validation: {text}."))
            .into_iter()
            .chain(tables::reasons(&runs))
            .collect(),
        ..Table::default()
    };
    table.to_text(width)
}

/// The estimates of a run by grade, in as many columns as fit; of parameters not identified only the names.
fn estimates(run: &RunResult, of: &str, width: TextWidth) -> String {
    let is_regrouped = run.parameters.iter().any(|p| p.name.ends_with('r'));
    let regrouped = if is_regrouped { " (r: sum with others)" } else { "" };
    let head = format!("Estimates of {of} \u{b1} farther end of the 95 % interval{regrouped}");
    let mut text = wrap(&head, "", width);
    let (moved, wide): (Vec<_>, Vec<_>) = run.graded(Grade::Rough).partition(|p| run.may_be_moved(p).is_some());
    for (grade, what, known) in [
        (Grade::Precise, "the interval is within 20 % of the estimate", run.graded(Grade::Precise).collect()),
        (Grade::Rough, "the interval is wider, and excludes zero", wide),
        (Grade::Rough, "friction near rest or a delay may shift them by the last number", moved),
        (Grade::Impossible, "a motor inertia or friction below zero", run.graded(Grade::Impossible).collect()),
    ] {
        if !known.is_empty() {
            text += &wrap(&format!("{}: {what}", grade.name()), "  ", width);
            text += &side_by_side(&cells(run, &known), width);
        }
    }
    let names: Vec<&str> = run.graded(Grade::NotIdentified).map(|p| p.name.as_str()).collect();
    if !names.is_empty() {
        let moved = run.parameters.iter().any(|p| run.may_be_moved(p).is_some());
        let or_moved = if moved { ", or would after such a shift" } else { "" };
        text += &wrap(&format!("not identified by the recordings{or_moved}"), "  ", width);
        text += &wrap(&names.join(" "), "    ", width);
    }
    if !run.loop_parameters.is_empty() {
        text += &wrap("of the simulated loop", "  ", width);
        text += &side_by_side(&run.loop_parameters.iter().map(of_loop).collect::<Vec<_>>(), width);
    }
    let held = tables::interval_counts(&[run]);
    text + &held.map_or_else(String::new, |line| wrap(&line, "  ", width))
}

/// Name, value, distance to the farther end of the interval and unit of an estimated quantity of the loop.
fn of_loop(p: &LoopParameterResult) -> String {
    let half = p.interval_95.map(|[low, high]| (p.estimate - low).max(high - p.estimate));
    let width = half.map_or_else(|| NONE.to_owned(), |half| estimate(half, Some(half)));
    let unit = if p.unit.is_empty() { "times" } else { &p.unit };
    format!("{} {} \u{b1}{width} {unit}", p.name, estimate(p.estimate, half))
}

/// Name, value, distance to the farther end of the interval and unit of each parameter, in columns of the same width, and its possible shift.
fn cells(run: &RunResult, parameters: &[&ParameterResult]) -> Vec<String> {
    let texts: Vec<[String; 5]> = parameters.iter().map(|p| texts(run, p)).collect();
    let widest = |c: usize| texts.iter().map(|t| t[c].chars().count()).max().unwrap_or(0);
    let [name, value, half, unit, moved] = [0, 1, 2, 3, 4].map(widest);
    let cell = |[n, v, h, u, m]: &[String; 5]| format!("{n:<name$} {v:>value$} \u{b1}{h:<half$} {u:<unit$}{m:<moved$}");
    texts.iter().map(cell).collect()
}

fn texts(run: &RunResult, p: &ParameterResult) -> [String; 5] {
    let half = p.farther_end();
    let width = half.map_or_else(|| NONE.to_owned(), |half| estimate(half, Some(half)));
    let moved = run.may_be_moved(p).map(|shift| format!(", by {}", number::significant(shift, 2))).unwrap_or_default();
    [visible(&p.name).into_owned(), estimate(p.estimate, half), width, p.unit.clone(), moved]
}

/// Texts of the same width in as many columns as fit, ordered down the columns.
fn side_by_side(texts: &[String], width: TextWidth) -> String {
    const INDENT: &str = "    ";
    let room = width.columns() - INDENT.len();
    let each = texts.iter().map(|t| t.chars().count()).max().unwrap_or(1).max(1);
    let columns = ((room + GAP) / (each + GAP)).max(1);
    let rows = texts.len().div_ceil(columns);
    let line = |row: usize| {
        let cells: Vec<&str> = texts.iter().skip(row).step_by(rows).map(String::as_str).collect();
        shortened(cells.join(&" ".repeat(GAP)).trim_end(), room)
    };
    (0..rows).map(|row| format!("{INDENT}{}\n", line(row))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_arranged_in_as_many_columns_as_fit() {
        let texts: Vec<String> = ["a1234567", "b1234567", "c1234567", "d1234567", "e1234567"].map(str::to_owned).into();
        let expected = "    a1234567   c1234567   e1234567\n    b1234567   d1234567\n";
        assert_eq!(side_by_side(&texts, TextWidth::new(40)), expected);
        let long = vec!["x".repeat(60)];
        assert_eq!(side_by_side(&long, TextWidth::new(40)), format!("    {}…\n", "x".repeat(35)));
    }
}
