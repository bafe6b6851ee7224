//! The estimates of the user's own estimators, compared with the recommended method and kept apart from thetahat's methods.

use crate::{
    report::{
        number::{NONE, estimate, optional, signed, significant, with_percent},
        section::Section,
        table::{Group, Table, strings},
        wrap::{TextWidth, wrap},
    },
    results::{ParameterResult, Results, RunResult, UserRun},
};

/// The note wherever they are shown.
const WHOSE: &str =
    "The user's own estimators, which thetahat has not examined: verdict, advice and exports do not use them.";

pub(in crate::report) fn section(results: &Results) -> Section {
    if results.user_runs.is_empty() {
        return Section::default();
    }
    Section {
        id: "user-estimators",
        title: "The user's own estimators",
        lines: lines(results),
        tables: vec![errors(results), parameters(results)],
        ..Section::default()
    }
}

/// The same for the terminal; may be empty.
pub(in crate::report) fn text(results: &Results, width: TextWidth) -> String {
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
        head: strings(&["estimator", "given", "error %", "validation %", "s"]),
        rows: results.user_runs.iter().map(row).collect(),
        notes: strings(&[
            "error and validation: as for the methods, with X theta. s: time of one estimate of all rows.",
        ]),
        ..Table::default()
    }
}

fn parameters(results: &Results) -> Table {
    let recommended = results.recommended_run();
    let named = &results.user_runs[0].parameters;
    let group = |run: &UserRun| Group { label: run.name.clone(), columns: 2 };
    let of_recommended = recommended.map(|run| Group { label: run.method.name().to_owned(), columns: 1 });
    let row = |p: &ParameterResult| {
        let theirs = results.user_runs.iter().flat_map(|run| cells(run, recommended, &p.name));
        let ours = recommended.map(|run| run.parameter(&p.name).map_or_else(|| NONE.to_owned(), shown));
        [p.name.clone(), p.unit.clone()].into_iter().chain(ours).chain(theirs).collect()
    };
    let figures = results.user_runs.iter().flat_map(|_| strings(&["estimate", "diff/sd"]));
    Table {
        title: "Estimates of the user's estimators".to_owned(),
        lead: 2,
        groups: of_recommended.into_iter().chain(results.user_runs.iter().map(group)).collect(),
        head: strings(&["name", "unit"])
            .into_iter()
            .chain(recommended.map(|_| "estimate".to_owned()))
            .chain(figures)
            .collect(),
        rows: named.iter().filter(|p| p.shown).map(row).collect(),
        notes: strings(&[
            "In brackets: relative standard deviation. diff/sd: difference from the recommended method, in its robust standard deviations.",
        ]),
    }
}

fn shown(p: &ParameterResult) -> String {
    with_percent(&estimate(p.estimate, p.standard_deviation), p.relative_standard_deviation_percent)
}

/// The estimate of a parameter, and its difference from the recommended method.
fn cells(run: &UserRun, recommended: Option<&RunResult>, name: &str) -> [String; 2] {
    let Some(own) = run.parameter(name) else { return [NONE.to_owned(), NONE.to_owned()] };
    let ours = recommended.and_then(|run| run.parameter(name));
    let difference =
        ours.and_then(|ours| Some((own.estimate - ours.estimate) / ours.deviation().filter(|sd| *sd > 0.0)?));
    [shown(own), difference.map_or_else(|| NONE.to_owned(), signed)]
}
