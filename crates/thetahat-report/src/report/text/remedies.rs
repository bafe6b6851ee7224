//! Remedies for the terminal: how they are applied, and what a run with them changed.

use crate::{
    report::{
        number::{NONE, estimate, significant},
        wrap::{TextWidth, labelled, wrap},
    },
    results::{NOMINAL, Remedy, Results, RunResult, Unseen},
};
use thetahat_ground::visible::visible;

/// Columns of the labels.
const LABEL: usize = 12;
/// Remedies that are named, and values that moved.
const MOST: usize = 3;
const MOST_VALUES: usize = 12;

/// The commands that apply the remedies of the verdict's reasons, from the command without its codes; empty where there is none.
#[must_use]
pub fn remedies_text(results: &Results, command: &str, width: TextWidth) -> String {
    let wanted = |remedy: &&Remedy| results.verdict_reasons.iter().any(|r| r.remedies.contains(&remedy.code));
    let all: Vec<&Remedy> = results.remedies.iter().filter(wanted).collect();
    let line = |(k, remedy): (usize, &&Remedy)| {
        let label = if k == 0 { "to apply" } else { "" };
        // A command that is broken into lines cannot be copied.
        let does = wrap(&visible(&remedy.label), &" ".repeat(LABEL), width);
        format!("{label:<LABEL$}{command} {}\n{does}", remedy.code)
    };
    let mut text: String = all.iter().take(MOST).enumerate().map(line).collect();
    if all.len() > MOST {
        let codes: Vec<&str> = all[MOST..].iter().map(|remedy| remedy.code.as_str()).collect();
        text += &labelled("", &format!("further codes: {}", codes.join(", ")), LABEL, width);
    }
    text
}

/// What a run with remedies changed against the run before: the verdict, the error on data not used, and values that moved.
#[must_use]
pub fn change_text(before: &Results, after: &Results, width: TextWidth) -> String {
    let sides = [before, after];
    let estimates = sides.map(shown_run);
    let verdict = sides.map(|results| results.verdict.map_or_else(|| NONE.to_owned(), |v| v.to_string()));
    let unseen = [0, 1].map(|k| {
        let unseen = estimates[k].as_ref().and_then(|run| sides[k].unseen(run)).map(Unseen::percent);
        unseen.map_or_else(|| NONE.to_owned(), |percent| format!("{} %", significant(percent, 3)))
    });
    let mut text = wrap("What the remedies changed", "", width);
    for (label, [old, new]) in [("verdict", verdict), ("unseen error", unseen)] {
        text += &labelled(&format!("  {label}"), &format!("{new}, before {old}"), LABEL + 4, width);
    }
    if let [Some(old), Some(new)] = &estimates {
        text += &values(old, new, width);
    }
    text
}

/// The model as it is quoted, or the run that is recommended, or else the first.
fn shown_run(results: &Results) -> Option<RunResult> {
    let model = results.model.as_ref().map(|model| model.quoted(NOMINAL));
    let first = || results.recommended_run().or_else(|| results.runs.iter().find(|run| run.case == NOMINAL));
    model.or_else(|| first().cloned())
}

/// Values that are beyond the half widths of both of their intervals together, the furthest first.
fn values(old: &RunResult, new: &RunResult, width: TextWidth) -> String {
    let mut moved: Vec<(f64, String)> = Vec::new();
    for after in &new.parameters {
        let Some(before) = old.parameter(&after.name) else { continue };
        let half = before.farther_end().unwrap_or(0.0).hypot(after.farther_end().unwrap_or(0.0));
        let far = (after.estimate - before.estimate).abs() / half;
        if half > 0.0 && far > 1.0 {
            let [was, is] = [before, after].map(|p| estimate(p.estimate, p.farther_end()));
            moved.push((far, format!("{} {is} {}, before {was}", after.name, after.unit)));
        }
    }
    moved.sort_by(|a, b| b.0.total_cmp(&a.0));
    let count = moved.len();
    let of = new.parameters.len();
    let head = format!("{count} of {of} values moved beyond their intervals{}", if count > 0 { ":" } else { "" });
    let lines = moved.iter().take(MOST_VALUES).map(|(_, line)| wrap(line, "    ", width));
    let more = count.saturating_sub(MOST_VALUES);
    let more = (more > 0).then(|| wrap(&format!("and {more} others"), "    ", width));
    [wrap(&head, "  ", width)].into_iter().chain(lines).chain(more).collect()
}
