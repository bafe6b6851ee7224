//! The tables of the report.

use super::{
    number::{NONE, estimate, fixed, given, optional, signed, significant, with_deviation, with_percent},
    published::{Agreement, Published, PublishedValue},
    table::{Group, Table, strings},
};
use crate::results::{Grade, IterationResult, ParameterResult, Results, RunResult, Status, Unseen};

/// Errors in standard deviations that count as within.
const WITHIN: f64 = 3.0;

/// Quantities of a simulation's relative errors, in the order shown.
const SIMULATED: [&str; 4] = ["position", "velocity", "acceleration", "torque"];

/// Figures of a run that a publication may print: name in the file of published figures, and heading.
const RUN_FIGURES: [(&str, &str); 3] = [
    ("relative_error_percent", "relative error %"),
    ("cross_validation_relative_error_percent", "validation %"),
    ("condition_number", "condition number"),
];

pub(super) fn runs_of<'a>(results: &'a Results, case: &str) -> Vec<&'a RunResult> {
    results.runs.iter().filter(|r| r.case == case).collect()
}

/// One row for each run.
pub(super) fn summary(results: &Results) -> Table {
    let row = |r: &RunResult| {
        vec![
            r.case.clone(),
            r.method.name().to_owned(),
            r.status.name().to_owned(),
            r.iterations.to_string(),
            r.simulations.to_string(),
            optional(r.relative_error_percent, 3),
            optional(r.cross_validation_relative_error_percent, 3),
            optional(r.condition_number, 3),
            significant(r.seconds, 2),
        ]
    };
    Table {
        title: "Runs".to_owned(),
        lead: 3,
        head: strings(&["case", "method", "status", "iter", "sims", "error %", "validation %", "cond", "s"]),
        rows: results.runs.iter().map(row).collect(),
        notes: vec![format!("error: relative error 100 |y - y_hat| / |y|{}.", validation_note(results))],
        ..Table::default()
    }
}

/// The data of the validation; none without validation.
pub(super) fn validation(results: &Results) -> Option<&'static str> {
    let unseen = results.runs.iter().find_map(|r| results.unseen(r))?;
    Some(match unseen {
        Unseen::HeldBack(_) => "error on recordings held back",
        Unseen::LeftOut(_) => "error on parts of the recording left out in turn",
    })
}

fn validation_note(results: &Results) -> String {
    validation(results).map_or_else(String::new, |text| format!("; validation: {text}"))
}

/// The parameters of some runs, in the order in which they appear.
fn parameters_in<'a>(runs: &[&'a RunResult], is_shown: impl Fn(&ParameterResult) -> bool) -> Vec<&'a ParameterResult> {
    let mut parameters: Vec<&ParameterResult> = Vec::new();
    for parameter in runs.iter().flat_map(|r| &r.parameters).filter(|p| is_shown(p)) {
        if !parameters.iter().any(|p| p.name == parameter.name) {
            parameters.push(parameter);
        }
    }
    parameters
}

/// The cell of a parameter of a run: the status of the run without an estimate.
fn cell(run: &RunResult, name: &str, show: impl Fn(&ParameterResult) -> String) -> String {
    let absent = if run.parameters.is_empty() { run.status.name() } else { NONE };
    run.parameter(name).map_or_else(|| absent.to_owned(), show)
}

/// Why runs did not converge, and what they simulated differently from the files.
pub(super) fn reasons(runs: &[&RunResult]) -> Vec<String> {
    let reason = |r: &&RunResult| {
        let why = r.reason.as_deref().or((r.status != Status::Converged).then_some("no reason given"))?;
        Some(format!("{} {}: {why}", r.method.name(), r.status.name()))
    };
    let noted =
        |r: &&RunResult| -> Vec<String> { r.notes.iter().map(|n| format!("{}: {n}", r.method.name())).collect() };
    runs.iter().filter_map(reason).chain(runs.iter().flat_map(noted)).collect()
}

fn estimate_with_percent(run: &RunResult, p: &ParameterResult) -> String {
    if run.grade(p) == Grade::NotIdentified {
        return Grade::NotIdentified.name().to_owned();
    }
    with_percent(&estimate(p.estimate, p.standard_deviation), p.relative_standard_deviation_percent)
}

/// The shown parameters of a case, the methods side by side.
pub(super) fn parameters(results: &Results, case: &str) -> Table {
    let runs = runs_of(results, case);
    let row = |p: &ParameterResult| {
        let estimates = runs.iter().map(|r| cell(r, &p.name, |p| estimate_with_percent(r, p)));
        [p.name.clone(), p.unit.clone()].into_iter().chain(estimates).collect()
    };
    Table {
        title: format!("{case}: estimates (relative standard deviation)"),
        lead: 2,
        head: strings(&["name", "unit"]).into_iter().chain(method_names(&runs)).collect(),
        rows: parameters_in(&runs, |p| p.shown).into_iter().map(row).collect(),
        notes: reasons(&runs).into_iter().chain(widening(&runs)).collect(),
        ..Table::default()
    }
}

/// The ratio of the deviations of the intervals to the classical ones.
fn widening(runs: &[&RunResult]) -> Option<String> {
    let of_run =
        |r: &&RunResult| Some(format!("{} times these for {}", significant(r.widening()?, 2), r.method.name()));
    let times: Vec<String> = runs.iter().filter_map(of_run).collect();
    let note = "Classical deviations. The 95 % intervals (interval_95) allow for errors that are correlated from row to row: \
                their deviations are, in the median,";
    (!times.is_empty()).then(|| format!("{note} {}.", times.join(", ")))
}

fn method_names<'a>(runs: &'a [&RunResult]) -> impl Iterator<Item = String> + 'a {
    runs.iter().map(|r| r.method.name().to_owned())
}

fn method_groups(runs: &[&RunResult], columns: usize) -> Vec<Group> {
    method_names(runs).map(|label| Group { label, columns }).collect()
}

/// A heading for leading columns, then the same columns for each run.
fn repeated_head(lead: &[&str], each: &[&str], runs: usize) -> Vec<String> {
    let repeated = (0..runs).flat_map(|_| strings(each));
    strings(lead).into_iter().chain(repeated).collect()
}

/// The 95 % interval, to two digits of its half width.
fn interval(p: &ParameterResult) -> String {
    let text = |[low, high]: [f64; 2]| {
        let [low, high] = [low, high].map(|v| estimate(v, Some(0.5 * (high - low))));
        format!("{low} to {high}")
    };
    p.interval_95.map_or_else(|| NONE.to_owned(), text)
}

/// Every parameter of a case with unit, classical standard deviations and intervals, and in the first case the formula.
pub(super) fn formulas(results: &Results, case: &str) -> Table {
    let runs = runs_of(results, case);
    let is_first = results.cases().first() == Some(&case);
    let head: &[&str] = if is_first { &["name", "unit", "formula"] } else { &["name", "unit"] };
    let cells = |r: &&RunResult, name: &str| {
        let percent = |p: &ParameterResult| optional(p.relative_standard_deviation_percent, 3);
        [
            cell(r, name, |p| with_deviation(p.estimate, p.standard_deviation)),
            r.parameter(name).map_or_else(|| NONE.to_owned(), percent),
            r.parameter(name).map_or_else(|| NONE.to_owned(), interval),
        ]
    };
    let row = |p: &ParameterResult| {
        let lead = [p.name.clone(), p.unit.clone(), p.expression.clone()];
        lead.into_iter().take(head.len()).chain(runs.iter().flat_map(|r| cells(r, &p.name))).collect()
    };
    Table {
        title: format!("{case}: all parameters"),
        lead: head.len(),
        groups: method_groups(&runs, 3),
        head: repeated_head(head, &["estimate±sd", "sd %", "95 % interval"], runs.len()),
        rows: parameters_in(&runs, |_| true).into_iter().map(row).collect(),
        notes: reasons(&runs),
    }
}

/// Error of an estimate in its standard deviations.
fn error_in_deviations(p: &ParameterResult) -> Option<f64> {
    let error = p.estimate - p.true_value?;
    p.standard_deviation.filter(|sd| *sd > 0.0).map(|sd| error / sd)
}

/// The shown parameters of a case with their true values; none without true values.
pub(super) fn truth(results: &Results, case: &str) -> Option<Table> {
    let runs = runs_of(results, case);
    let known = parameters_in(&runs, |p| p.shown && p.true_value.is_some());
    let error = |p: &ParameterResult| error_in_deviations(p).map_or_else(|| NONE.to_owned(), signed);
    let cells = |r: &&RunResult, name: &str| {
        [
            cell(r, name, |p| with_deviation(p.estimate, p.standard_deviation)),
            r.parameter(name).map_or_else(|| NONE.to_owned(), error),
        ]
    };
    let row = |p: &&ParameterResult| {
        let lead = [p.name.clone(), p.true_value.map_or_else(|| NONE.to_owned(), given)];
        lead.into_iter().chain(runs.iter().flat_map(|r| cells(r, &p.name))).collect()
    };
    (!known.is_empty()).then(|| Table {
        title: format!("{case}: truth and estimates, error in standard deviations"),
        lead: 2,
        groups: method_groups(&runs, 2),
        head: repeated_head(&["name", "truth"], &["estimate±sd", "err/sd"], runs.len()),
        rows: known.iter().map(row).collect(),
        notes: truth_counts(&runs),
    })
}

fn truth_counts(runs: &[&RunResult]) -> Vec<String> {
    let count = |r: &&RunResult, is_counted: fn(&ParameterResult) -> bool| {
        let errors: Vec<f64> = r.parameters.iter().filter(|p| is_counted(p)).filter_map(error_in_deviations).collect();
        let within = errors.iter().filter(|e| e.abs() <= WITHIN).count();
        format!("{} {within} of {}", r.method.name(), errors.len())
    };
    let line = |what: &str, is_counted: fn(&ParameterResult) -> bool| {
        let estimated = runs.iter().filter(|r| !r.parameters.is_empty());
        let counts: Vec<String> = estimated.map(|r| count(r, is_counted)).collect();
        format!("within 3 standard deviations{what}: {}", counts.join(", "))
    };
    let hidden = runs.iter().any(|r| r.parameters.iter().any(|p| !p.shown));
    let all = hidden.then(|| line(", of all parameters", |_| true));
    [line("", |p| p.shown)].into_iter().chain(all).chain(interval_counts(runs)).collect()
}

/// How many intervals contain the true value; none without intervals.
pub(super) fn interval_counts(runs: &[&RunResult]) -> Option<String> {
    let holds = |p: &ParameterResult| p.interval_95.zip(p.true_value).map(|([a, b], t)| (a..=b).contains(&t));
    let count = |r: &&RunResult| {
        let held: Vec<bool> = r.parameters.iter().filter_map(holds).collect();
        let of = held.iter().filter(|h| **h).count();
        (!held.is_empty()).then(|| format!("{} {of} of {}", r.method.name(), held.len()))
    };
    let counts: Vec<String> = runs.iter().filter_map(count).collect();
    let what = "95 % intervals that contain the truth, of all parameters";
    (!counts.is_empty()).then(|| format!("{what}: {}", counts.join(", ")))
}

/// Level of detail of a published parameter table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detail {
    /// Estimates alone.
    Estimates,
    /// Estimates and their relative standard deviations.
    Deviations,
}

/// Published estimates of a case compared with ours; none if nothing is published for it.
pub(super) fn published(results: &Results, published: &Published, case: &str, detail: Detail) -> Option<Table> {
    let printed = |r: &RunResult| published.values.iter().any(|v| v.case == case && v.method == r.method);
    let runs: Vec<&RunResult> = runs_of(results, case).into_iter().filter(|r| printed(r)).collect();
    let names = published_names(published, case);
    let row = |name: &&str| {
        let cells = runs.iter().flat_map(|r| compared(published.value(case, r.method, name), r, name, detail));
        [(*name).to_owned()].into_iter().chain(cells).collect()
    };
    (!runs.is_empty() && !names.is_empty()).then(|| Table {
        title: format!("{case}: published figures and ours"),
        lead: 1,
        groups: method_groups(&runs, 3),
        head: repeated_head(&["name"], &["printed", "ours", "diff/sd"], runs.len()),
        rows: names.iter().map(row).collect(),
        notes: agreements(published, &runs),
    })
}

fn is_run_figure(name: &str) -> bool {
    RUN_FIGURES.iter().any(|(figure, _)| *figure == name)
}

fn published_names<'a>(published: &'a Published, case: &str) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for value in published.values.iter().filter(|v| v.case == case && !is_run_figure(&v.parameter)) {
        if !names.contains(&value.parameter.as_str()) {
            names.push(&value.parameter);
        }
    }
    names
}

/// The printed figure, ours, and the difference; a star marks what does not agree.
fn compared(printed: Option<&PublishedValue>, run: &RunResult, name: &str, detail: Detail) -> [String; 3] {
    let detailed = detail == Detail::Deviations;
    let ours = cell(run, name, |p| {
        let percent = p.relative_standard_deviation_percent.filter(|_| detailed);
        with_percent(&like_printed(p, printed), percent)
    });
    let text = printed.map(|v| match v.deviation_text.as_str() {
        deviation if detailed && !deviation.is_empty() => format!("{} ({deviation} %)", v.text),
        _ => v.text.clone(),
    });
    let difference = printed.zip(run.parameter(name)).map(|(v, p)| difference(v, p.estimate));
    [text.unwrap_or_else(|| NONE.to_owned()), ours, difference.unwrap_or_else(|| NONE.to_owned())]
}

/// Our estimate with one digit more than the printed one.
fn like_printed(ours: &ParameterResult, printed: Option<&PublishedValue>) -> String {
    let alone = || estimate(ours.estimate, ours.standard_deviation);
    printed.and_then(more_digits).map_or_else(alone, |decimals| fixed(ours.estimate, decimals))
}

/// One decimal more than the printed ones.
fn more_digits(printed: &PublishedValue) -> Option<usize> {
    usize::try_from(printed.decimals() + 1).ok().filter(|d| *d <= 7)
}

/// The difference in printed standard deviations.
fn difference(printed: &PublishedValue, estimate: f64) -> String {
    let deviations = printed.standard_deviation().filter(|sd| *sd > 0.0).map(|sd| (estimate - printed.estimate) / sd);
    let text = deviations.map_or_else(|| NONE.to_owned(), signed);
    if printed.agrees_with(estimate) { text } else { format!("* {text}") }
}

fn agreements(published: &Published, runs: &[&RunResult]) -> Vec<String> {
    let count = |r: &&RunResult| {
        let Agreement { within, compared } = published.agreement(r);
        format!("{} {within} of {compared}", r.method.name())
    };
    let counts: Vec<String> = runs.iter().filter(|r| !r.parameters.is_empty()).map(count).collect();
    let rule = "within 3 printed standard deviations or one unit of the last printed digit";
    [format!("{rule}: {}; * marks those that are not", counts.join(", "))].into_iter().chain(reasons(runs)).collect()
}

/// Published figures of the runs compared with ours, such as relative errors.
pub(super) fn published_runs(results: &Results, published: &Published) -> Option<Table> {
    let printed = |name: &str| published.values.iter().any(|v| v.parameter == name);
    let figures: Vec<_> = RUN_FIGURES.into_iter().filter(|(name, _)| printed(name)).collect();
    let cells = |r: &RunResult, name: &str| {
        let value = published.value(&r.case, r.method, name);
        let figure = |f: f64| value.and_then(more_digits).map_or_else(|| significant(f, 4), |d| fixed(f, d));
        let ours = run_figure(r, name).map_or_else(|| NONE.to_owned(), figure);
        [value.map_or_else(|| NONE.to_owned(), |v| v.text.clone()), ours]
    };
    let row = |r: &RunResult| {
        let lead = [r.case.clone(), r.method.name().to_owned()];
        lead.into_iter().chain(figures.iter().flat_map(|(name, _)| cells(r, name))).collect()
    };
    let has_any = |r: &&RunResult| figures.iter().any(|(n, _)| published.value(&r.case, r.method, n).is_some());
    let rows: Vec<Vec<String>> = results.runs.iter().filter(has_any).map(row).collect();
    (!rows.is_empty()).then(|| Table {
        title: "Published figures of the runs and ours".to_owned(),
        lead: 2,
        groups: figures.iter().map(|(_, label)| Group { label: (*label).to_owned(), columns: 2 }).collect(),
        head: repeated_head(&["case", "method"], &["printed", "ours"], figures.len()),
        rows,
        notes: Vec::new(),
    })
}

fn run_figure(run: &RunResult, name: &str) -> Option<f64> {
    match name {
        "relative_error_percent" => run.relative_error_percent,
        "cross_validation_relative_error_percent" => run.cross_validation_relative_error_percent,
        "condition_number" => run.condition_number,
        _ => None,
    }
}

/// Every iteration of every run that iterates.
pub(super) fn convergence(results: &Results) -> Option<Table> {
    let rows_of = |run: &RunResult| -> Vec<Vec<String>> {
        let row = |(k, i): (usize, &IterationResult)| {
            vec![
                run.case.clone(),
                run.method.name().to_owned(),
                (k + 1).to_string(),
                significant(i.relative_error_percent, 5),
                optional(i.parameter_change, 3),
                optional(i.error_change, 3),
            ]
        };
        run.convergence.iter().enumerate().map(row).collect()
    };
    let rows: Vec<Vec<String>> = results.runs.iter().flat_map(rows_of).collect();
    (!rows.is_empty()).then(|| Table {
        title: "Convergence, every iteration".to_owned(),
        lead: 2,
        head: strings(&["case", "method", "iteration", "error %", "parameter change", "error change"]),
        rows,
        notes: vec![
            "parameter change: the largest of an estimate, in its standard deviations; error change: relative."
                .to_owned(),
        ],
        ..Table::default()
    })
}

/// Relative errors of the simulations with the estimates.
pub(super) fn simulation_errors(results: &Results) -> Option<Table> {
    let rows: Vec<Vec<String>> = results.runs.iter().flat_map(simulation_rows).collect();
    let head = strings(&["case", "method", "recording"]).into_iter().chain(SIMULATED.map(|q| format!("{q} %")));
    (!rows.is_empty()).then(|| Table {
        title: "Closed-loop simulation with the estimates, relative errors".to_owned(),
        lead: 3,
        head: head.collect(),
        rows,
        ..Table::default()
    })
}

fn simulation_rows(run: &RunResult) -> Vec<Vec<String>> {
    let recordings = [
        ("identified", &run.simulation_relative_error_percent),
        ("held back", &run.validation_simulation_relative_error_percent),
    ];
    let row = |(recording, errors): (&str, &Option<std::collections::BTreeMap<String, f64>>)| {
        let errors = errors.as_ref()?;
        let cells = SIMULATED.map(|quantity| optional(errors.get(quantity).copied(), 3));
        let lead = [run.case.clone(), run.method.name().to_owned(), recording.to_owned()];
        Some(lead.into_iter().chain(cells).collect())
    };
    recordings.into_iter().filter_map(row).collect()
}

/// Relative error of each joint's torque.
pub(super) fn joint_errors(results: &Results) -> Option<Table> {
    let joints = results.runs.iter().map(|r| r.joint_relative_error_percent.len()).max().unwrap_or(0);
    let row = |r: &RunResult| {
        let errors = (0..joints).map(|j| optional(r.joint_relative_error_percent.get(j).copied().flatten(), 3));
        [r.case.clone(), r.method.name().to_owned()].into_iter().chain(errors).collect()
    };
    let head = strings(&["case", "method"]).into_iter().chain((1..=joints).map(|j| format!("joint {j}")));
    (joints > 1).then(|| Table {
        title: "Relative error of each joint, %".to_owned(),
        lead: 2,
        head: head.collect(),
        rows: results.runs.iter().map(row).collect(),
        ..Table::default()
    })
}
