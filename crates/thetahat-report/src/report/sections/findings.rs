//! The findings of the checks, for the terminal and the page.

use crate::{
    report::{
        number::significant,
        wrap::{TextWidth, labelled, wrap, wrap_to},
    },
    results::{Filter, FilterChoice, Finding, RecordingFindings, Results, RunResult, Severity},
};

/// Lines of a note on the first screen, and their indent below its code.
const LINES: usize = 2;
const INDENT: &str = "           ";

const SEVERITIES: [Severity; 3] = [Severity::Problem, Severity::Warning, Severity::Note];

/// The findings of every recording, each with its remedy.
#[must_use]
pub fn findings_text(recordings: &[RecordingFindings], width: TextWidth) -> String {
    let mut text = format!("Checks: {}\n", count(recordings));
    for recording in recordings.iter().filter(|r| !r.findings.is_empty()) {
        if recordings.len() > 1 {
            text += &wrap(&format!("{}:", name(recording)), "", width);
        }
        let cause = recording.findings.iter().find(|f| f.severity != Severity::Note && !f.code.is_consequence());
        for group in groups(&recording.findings) {
            let first = group[0];
            text +=
                &wrap(&format!("{} [{}] {}", label(first.severity), first.code, seen_together(&group)), "  ", width);
            text += &wrap(&format!("-> {}", first.remedy), "     ", width);
            if let Some(cause) = cause.filter(|_| first.code.is_consequence()) {
                text += &wrap(&format!("see to {} first: this may be a consequence of it", cause.code), "     ", width);
            }
        }
    }
    text
}

/// One line for each code of the recordings and of the estimates.
pub(in crate::report) fn brief(results: &Results, width: TextWidth) -> String {
    let several = results.findings.len() > 1;
    let of_recordings = results.findings.iter().flat_map(|r| {
        let prefix = if several { format!("{}: ", name(r)) } else { String::new() };
        groups(&r.findings).into_iter().map(move |group| (group[0], format!("{prefix}{}", in_short(&group))))
    });
    let mut lines: Vec<(Severity, String)> = Vec::new();
    for (finding, text) in of_recordings.chain(of_estimates(&results.runs)) {
        lines.push((finding.severity, in_lines(finding, &text, width)));
    }
    lines.sort_by_key(|(severity, _)| SEVERITIES.iter().position(|s| s == severity));
    let lines: String = lines.into_iter().map(|(_, line)| line).collect();
    if lines.is_empty() {
        "Findings: none\n".to_owned()
    } else {
        format!("Findings (--full shows the remedies)\n{lines}")
    }
}

/// Severity and code, with the text next to them, or below on a narrow terminal.
fn in_lines(finding: &Finding, text: &str, width: TextWidth) -> String {
    let named = format!("  {:<8} {:<20} ", label(finding.severity), finding.code.to_string());
    let column = named.chars().count();
    if width.columns() >= 2 * column {
        return labelled(&named, &first_lines(finding.severity, text, width.columns() - column), column, width);
    }
    format!(
        "{}\n{}",
        named.trim_end(),
        wrap(&first_lines(finding.severity, text, width.columns() - INDENT.len()), INDENT, width)
    )
}

/// A text; of a note the first lines of at most this many characters.
fn first_lines(severity: Severity, text: &str, columns: usize) -> String {
    let lines = wrap_to(text, columns);
    if severity != Severity::Note || lines.len() <= LINES {
        return lines.join(" ");
    }
    let last = &lines[LINES - 1];
    let kept =
        if last.chars().count() < columns { last.as_str() } else { last.rsplit_once(' ').map_or("", |(kept, _)| kept) };
    [&lines[..LINES - 1], &[format!("{kept}\u{2026}")]].concat().join(" ")
}

/// The joints, and the message of the largest value without its joint.
fn in_short(group: &[&Finding]) -> String {
    let most = group.iter().max_by(|a, b| a.value.abs().total_cmp(&b.value.abs())).unwrap_or(&group[0]);
    let joints: Vec<String> = group.iter().filter_map(|f| f.joint).map(|j| j.to_string()).collect();
    match joints.as_slice() {
        [] | [_] => seen(most),
        [_, ..] => format!("joints {}: {}", joints.join(" "), without_joint(&most.message)),
    }
}

/// A message without its leading joint.
fn without_joint(message: &str) -> &str {
    let named = message.split_once(": ").filter(|(start, _)| start.starts_with("joint "));
    named.map_or(message, |(_, text)| text)
}

/// The most serious finding of the runs for each code, with the methods that have one of the same severity.
fn of_estimates(runs: &[RunResult]) -> Vec<(&Finding, String)> {
    let mut all: Vec<(&Finding, Vec<&str>)> = Vec::new();
    for severity in SEVERITIES {
        let found = runs.iter().flat_map(|r| of_run(r).map(move |f| (r.method.name(), f)));
        for (method, finding) in found.filter(|(_, f)| f.severity == severity) {
            match all.iter_mut().find(|(first, _)| first.code == finding.code) {
                Some((first, methods)) if first.severity == severity && !methods.contains(&method) => {
                    methods.push(method)
                }
                Some(_) => {}
                None => all.push((finding, vec![method])),
            }
        }
    }
    all.into_iter().map(|(finding, methods)| (finding, format!("{}: {}", methods.join(" "), seen(finding)))).collect()
}

/// The errors of the estimates with the experiment's filter and others.
#[must_use]
pub fn filter_text(choice: &FilterChoice, width: TextWidth) -> String {
    let mut text = String::from("\nFilter: ");
    let own = choice.own.and_then(|own| Some((own.filter, choice.over_best(own.error?)?)));
    text += &match own {
        Some((Filter { cutoff_hz, decimation }, over)) => format!(
            "with cutoff_hz = {cutoff_hz} and decimation = {decimation} the error of the estimates is {over:.2} times the smallest\n"
        ),
        None => "the filter of the experiment gives no estimate on a simulated twin of the recording\n".to_owned(),
    };
    let Filter { cutoff_hz, decimation } = choice.best;
    let best = format!(
        "smallest with cutoff_hz = {cutoff_hz}, decimation = {decimation}, on a simulated twin of the recording with its noise; errors \
         relative to the smallest, by decimation and cutoff_hz:"
    );
    text += &wrap(&best, "  ", width);
    choice.lines().iter().for_each(|line| text += &format!("    {line}\n"));
    text
}

/// The findings in the estimates of the runs, for the terminal.
pub(in crate::report) fn of_runs_text(runs: &[RunResult], width: TextWidth) -> String {
    let line = |r: &RunResult, f: &Finding| {
        let seen = format!("{} [{}] {} {}: {}", label(f.severity), f.code, r.case, r.method, seen(f));
        wrap(&seen, "  ", width) + &wrap(&format!("-> {}", f.remedy), "     ", width)
    };
    let lines: String = runs.iter().flat_map(|r| of_run(r).map(move |f| line(r, f))).collect();
    if lines.is_empty() { lines } else { format!("Findings in the estimates:\n{lines}") }
}

/// The same for the page, a paragraph for each.
pub(in crate::report) fn lines_of_runs(runs: &[RunResult]) -> Vec<String> {
    let line = |r: &RunResult, f: &Finding| {
        format!("{} {}: {} [{}] {}. \u{2192} {}.", r.case, r.method, label(f.severity), f.code, seen(f), f.remedy)
    };
    runs.iter().flat_map(|r| of_run(r).map(move |f| line(r, f))).collect()
}

fn of_run(run: &RunResult) -> impl Iterator<Item = &Finding> {
    run.findings.iter().chain(run.physical.iter().flat_map(|p| &p.findings))
}

/// Findings that share a line: the same finding and remedy at several joints.
fn groups(findings: &[Finding]) -> Vec<Vec<&Finding>> {
    let mut groups: Vec<Vec<&Finding>> = Vec::new();
    for finding in findings {
        let same = |f: &Finding| {
            let alike = (f.severity, f.code, &f.unit, &f.remedy);
            f.joint.is_some() && alike == (finding.severity, finding.code, &finding.unit, &finding.remedy)
        };
        match groups.iter_mut().find(|group| finding.joint.is_some() && same(group[0])) {
            Some(group) => group.push(finding),
            None => groups.push(vec![finding]),
        }
    }
    groups
}

/// The message; for several joints their numbers and values, and the message of the largest value.
fn seen_together(group: &[&Finding]) -> String {
    let by_size = |a: &&&Finding, b: &&&Finding| a.value.abs().total_cmp(&b.value.abs());
    let (Some(least), Some(most)) = (group.iter().min_by(by_size), group.iter().max_by(by_size)) else {
        return String::new();
    };
    if group.len() == 1 {
        return seen(most);
    }
    let joints: Vec<String> = group.iter().filter_map(|f| f.joint).map(|j| j.to_string()).collect();
    let [least, largest] = [least.value, most.value].map(|value| significant(value, 2));
    let (joints, unit) = (joints.join(" "), &most.unit);
    let sizes =
        if least == largest { format!("{largest} {unit} each") } else { format!("{least} to {largest} {unit}") };
    format!("joints {joints}: {sizes}; largest: {}", seen(most))
}

/// The number of lines of each severity, in words.
pub(in crate::report) fn count(recordings: &[RecordingFindings]) -> String {
    let of = |severity| {
        let lines = recordings.iter().flat_map(|r| groups(&r.findings));
        lines.filter(|group| group[0].severity == severity).count()
    };
    let part = |severity: Severity| match of(severity) {
        0 => None,
        1 => Some(format!("1 {severity}")),
        n => Some(format!("{n} {severity}s")),
    };
    let parts: Vec<String> = SEVERITIES.into_iter().filter_map(part).collect();
    match (recordings, parts.is_empty()) {
        ([], _) => "none made".to_owned(),
        (_, true) => "no problems found".to_owned(),
        _ => parts.join(", "),
    }
}

/// A paragraph for each finding with its remedy, for the page.
pub(in crate::report) fn lines(recordings: &[RecordingFindings]) -> Vec<String> {
    let several = recordings.len() > 1;
    let line = |r: &RecordingFindings, group: Vec<&Finding>| {
        let (prefix, first) = (if several { format!("{}: ", name(r)) } else { String::new() }, group[0]);
        let seen = seen_together(&group);
        format!("{prefix}{} [{}] {seen}. \u{2192} {}.", label(first.severity), first.code, first.remedy)
    };
    recordings.iter().flat_map(|r| groups(&r.findings).into_iter().map(move |group| line(r, group))).collect()
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
    let numbered = recording.recording.chars().all(|c| c.is_ascii_digit());
    let what = if numbered { "recording " } else { "" };
    format!("{what}{}{held_back}", recording.recording)
}

/// The message, preceded by the joint unless the message contains it.
fn seen(finding: &Finding) -> String {
    match (finding.joint, &finding.joint_name) {
        (Some(joint), _) if finding.message.contains(&format!("oint {joint}")) => finding.message.clone(),
        (Some(joint), Some(name)) => format!("joint {joint} ({name}): {}", finding.message),
        (Some(joint), None) => format!("joint {joint}: {}", finding.message),
        (None, _) => finding.message.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Code;

    fn of_joint(joint: usize, percent: f64) -> Finding {
        Finding {
            code: Code::ReferenceMismatch,
            severity: Severity::Warning,
            joint: Some(joint),
            joint_name: Some(format!("j{joint}")),
            value: percent,
            unit: "% of the motion".to_owned(),
            limit: Some(5.0),
            message: format!("joint {joint}: the motion is 0.1 rad or m rms off its reference"),
            remedy: "check the reference's column".to_owned(),
            parameters: Vec::new(),
            step: None,
        }
    }

    /// What is about the fit as a whole names the finding that may be its cause, wherever that stands; a note is no cause.
    #[test]
    fn a_finding_that_may_be_a_consequence_names_the_first_cause() {
        let of = |code, severity| Finding { code, severity, joint: None, joint_name: None, ..of_joint(1, 10.0) };
        let text = |findings| {
            let recording = RecordingFindings { recording: "1".to_owned(), held_back: false, findings };
            findings_text(&[recording], TextWidth::default())
        };
        let poor = of(Code::PoorFit, Severity::Problem);
        let said =
            text(vec![poor.clone(), of(Code::RepeatedSamples, Severity::Warning), of(Code::Lag, Severity::Problem)]);
        assert_eq!(said.matches("see to repeated-samples first: this may be a consequence of it").count(), 1, "{said}");
        for alone in [vec![poor.clone()], vec![poor.clone(), poor.clone()], vec![of(Code::Lag, Severity::Note), poor]] {
            assert!(!text(alone).contains("consequence"));
        }
    }

    /// Not seven warnings of two lines each.
    #[test]
    fn the_same_finding_of_seven_joints_is_one_line() {
        let mut findings: Vec<Finding> = (1..=7).map(|j| of_joint(j, 10.0 * j as f64)).collect();
        let recording = |findings| RecordingFindings { recording: "1".to_owned(), held_back: false, findings };
        let text = findings_text(&[recording(findings.clone())], TextWidth::default());
        let expected = "Checks: 1 warning\n  \
            warning [reference-mismatch] joints 1 2 3 4 5 6 7: 10 to 70 % of the motion;\n  \
            largest: joint 7: the motion is 0.1 rad or m rms off its reference\n     \
            -> check the reference's column\n";
        assert_eq!(text, expected);
        findings[3].remedy = "another".to_owned();
        assert_eq!(lines(&[recording(findings.clone())]).len(), 2);
        findings[3].joint = None;
        assert_eq!(count(&[recording(findings)]), "2 warnings");
    }
}
