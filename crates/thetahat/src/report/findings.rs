//! What the checks found, for the terminal and the page.

use super::wrap::wrap;
use crate::results::{Filter, FilterChoice, Finding, RecordingFindings, RunResult, Severity};

const SEVERITIES: [Severity; 3] = [Severity::Problem, Severity::Warning, Severity::Note];

/// The findings of every recording: what was seen, and what to do.
#[must_use]
pub fn findings_text(recordings: &[RecordingFindings]) -> String {
    let mut text = format!("Checks: {}\n", count(recordings));
    for recording in recordings.iter().filter(|r| !r.findings.is_empty()) {
        if recordings.len() > 1 {
            text += &wrap(&format!("{}:", name(recording)), "");
        }
        for finding in &recording.findings {
            text += &wrap(&format!("{} [{}] {}", label(finding.severity), finding.code, seen(finding)), "  ");
            text += &wrap(&format!("-> {}", finding.remedy), "     ");
        }
    }
    text
}

/// What the experiment's filter and others do to the estimates.
#[must_use]
pub fn filter_text(choice: &FilterChoice) -> String {
    let mut text = String::from("\nFilter: ");
    let own = choice.own.and_then(|own| Some((own.filter, choice.over_best(own.error?)?)));
    text += &match own {
        Some((Filter { cutoff_hz, decimation }, over)) => format!(
            "with cutoff_hz = {cutoff_hz} and decimation = {decimation} the estimates' error is {over:.2} times the least\n"
        ),
        None => "the experiment's gives no estimate on a twin of the record\n".to_owned(),
    };
    let Filter { cutoff_hz, decimation } = choice.best;
    let best = format!(
        "least with cutoff_hz = {cutoff_hz}, decimation = {decimation}, found on a twin of the record with its noise; errors \
         over the least, by decimation and cutoff_hz:"
    );
    text += &wrap(&best, "  ");
    choice.lines().iter().for_each(|line| text += &format!("    {line}\n"));
    text
}

/// What was found in the estimates of the runs, for the terminal; empty where nothing was.
pub(super) fn of_runs_text(runs: &[RunResult]) -> String {
    let line = |r: &RunResult, f: &Finding| {
        let seen = format!("{} [{}] {} {}: {}", label(f.severity), f.code, r.case, r.method, seen(f));
        wrap(&seen, "  ") + &wrap(&format!("-> {}", f.remedy), "     ")
    };
    let lines: String = runs.iter().flat_map(|r| of_run(r).map(move |f| line(r, f))).collect();
    if lines.is_empty() { lines } else { format!("Found in the estimates:\n{lines}") }
}

/// The same for the page, a paragraph for each.
pub(super) fn lines_of_runs(runs: &[RunResult]) -> Vec<String> {
    let line = |r: &RunResult, f: &Finding| {
        format!("{} {}: {} [{}] {}. \u{2192} {}.", r.case, r.method, label(f.severity), f.code, seen(f), f.remedy)
    };
    runs.iter().flat_map(|r| of_run(r).map(move |f| line(r, f))).collect()
}

fn of_run(run: &RunResult) -> impl Iterator<Item = &Finding> {
    run.findings.iter().chain(run.physical.iter().flat_map(|p| &p.findings))
}

/// How many findings there are of each severity, in words.
pub(super) fn count(recordings: &[RecordingFindings]) -> String {
    let of = |severity| recordings.iter().flat_map(|r| &r.findings).filter(|f| f.severity == severity).count();
    let part = |severity: Severity| match of(severity) {
        0 => None,
        1 => Some(format!("1 {severity}")),
        n => Some(format!("{n} {severity}s")),
    };
    let parts: Vec<String> = SEVERITIES.into_iter().filter_map(part).collect();
    match (recordings, parts.is_empty()) {
        ([], _) => "none made".to_owned(),
        (_, true) => "nothing found".to_owned(),
        _ => parts.join(", "),
    }
}

/// A paragraph for each finding, for the page: what was seen, and what to do.
pub(super) fn lines(recordings: &[RecordingFindings]) -> Vec<String> {
    let several = recordings.len() > 1;
    let line = |r: &RecordingFindings, f: &Finding| {
        let place = if several { format!("{}: ", name(r)) } else { String::new() };
        format!("{place}{} [{}] {}. \u{2192} {}.", label(f.severity), f.code, seen(f), f.remedy)
    };
    recordings.iter().flat_map(|r| r.findings.iter().map(move |f| line(r, f))).collect()
}

fn label(severity: Severity) -> &'static str {
    match severity {
        Severity::Problem => "PROBLEM",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

fn name(recording: &RecordingFindings) -> String {
    let held_back = if recording.held_back { " (held back)" } else { "" };
    format!("{}{held_back}", recording.recording)
}

/// The message, with the joint in front where it is about one and does not begin with it.
fn seen(finding: &Finding) -> String {
    match (finding.joint, &finding.joint_name) {
        (Some(joint), _) if finding.message.contains(&format!("oint {joint}")) => finding.message.clone(),
        (Some(joint), Some(name)) => format!("joint {joint} ({name}): {}", finding.message),
        (Some(joint), None) => format!("joint {joint}: {}", finding.message),
        (None, _) => finding.message.clone(),
    }
}
