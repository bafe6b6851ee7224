//! What estimators of the user's own found, beside the method that is taken: apart from the methods of thetahat, and said to be so.

use super::{
    number::{NONE, estimate, optional, signed, significant, with_percent},
    section::Section,
    table::{Group, Table, strings},
    wrap::{TextWidth, wrap},
};
use crate::results::{ParameterResult, Results, RunResult, UserRun};

/// What is said of them wherever they are shown.
const WHOSE: &str =
    "Estimators of the user's own, which thetahat has not examined: verdict, advice and exports know nothing of them.";

pub(super) fn section(results: &Results) -> Section {
    if results.user_runs.is_empty() {
        return Section::default();
    }
    Section {
        id: "user-estimators",
        title: "Estimators of the user's own",
        lines: lines(results),
        tables: vec![errors(results), parameters(results)],
        ..Section::default()
    }
}

/// The same for the terminal; empty where there are none.
pub(super) fn text(results: &Results, width: TextWidth) -> String {
    if results.user_runs.is_empty() {
        return String::new();
    }
    let lines: String = lines(results).iter().map(|line| wrap(line, "", width)).collect();
    [lines, errors(results).to_text(width), parameters(results).to_text(width)].join("\n")
}

fn lines(results: &Results) -> Vec<String> {
    let without = |run: &UserRun| format!("{} gave no covariance: its estimates have no intervals.", run.name);
    let bare = results.user_runs.iter().filter(|run| run.covariance.is_empty());
    [WHOSE.to_owned()].into_iter().chain(bare.map(without)).collect()
}

fn errors(results: &Results) -> Table {
    let row = |run: &UserRun| {
        vec![
            run.name.clone(),
            if run.has_instruments { "X, y, Z" } else { "X, y" }.to_owned(),
            optional(Some(run.relative_error_percent), 3),
            optional(run.cross_validation_relative_error_percent, 3),
            significant(run.seconds, 2),
        ]
    };
    Table {
        title: "Errors of the user's estimators".to_owned(),
        lead: 1,
        head: strings(&["estimator", "given", "error %", "unseen %", "s"]),
        rows: results.user_runs.iter().map(row).collect(),
        notes: strings(&["error and unseen: as of the methods, of X theta. s: of one estimate of all rows."]),
        ..Table::default()
    }
}

fn parameters(results: &Results) -> Table {
    let taken = results.recommended_run();
    let named = &results.user_runs[0].parameters;
    let group = |run: &UserRun| Group { label: run.name.clone(), columns: 2 };
    let of_taken = taken.map(|run| Group { label: run.method.name().to_owned(), columns: 1 });
    let row = |p: &ParameterResult| {
        let theirs = results.user_runs.iter().flat_map(|run| cells(run, taken, &p.name));
        let ours = taken.map(|run| run.parameter(&p.name).map_or_else(|| NONE.to_owned(), shown));
        [p.name.clone(), p.unit.clone()].into_iter().chain(ours).chain(theirs).collect()
    };
    let figures = results.user_runs.iter().flat_map(|_| strings(&["estimate", "apart"]));
    Table {
        title: "Estimates of the user's estimators".to_owned(),
        lead: 2,
        groups: of_taken.into_iter().chain(results.user_runs.iter().map(group)).collect(),
        head: strings(&["name", "unit"])
            .into_iter()
            .chain(taken.map(|_| "estimate".to_owned()))
            .chain(figures)
            .collect(),
        rows: named.iter().filter(|p| p.shown).map(row).collect(),
        notes: strings(&[
            "Behind estimates: relative standard deviation. apart: difference from the method that is taken, in its robust deviations.",
        ]),
    }
}

fn shown(p: &ParameterResult) -> String {
    with_percent(&estimate(p.estimate, p.standard_deviation), p.relative_standard_deviation_percent)
}

/// The estimate of a parameter, and how far it is from the method that is taken.
fn cells(run: &UserRun, taken: Option<&RunResult>, name: &str) -> [String; 2] {
    let Some(own) = run.parameter(name) else { return [NONE.to_owned(), NONE.to_owned()] };
    let ours = taken.and_then(|run| run.parameter(name));
    let apart = ours.and_then(|ours| Some((own.estimate - ours.estimate) / ours.deviation().filter(|sd| *sd > 0.0)?));
    [shown(own), apart.map_or_else(|| NONE.to_owned(), signed)]
}
