//! What the checks found, for the terminal and the page.

use super::{
    Table,
    number::{optional, significant},
    text::wrap,
};
use crate::{
    checks::{Finding, Severity},
    experiment::RecordingFindings,
};

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

/// How many findings there are of each severity, in words.
pub(super) fn count(recordings: &[RecordingFindings]) -> String {
    let of = |severity| recordings.iter().flat_map(|r| &r.findings).filter(|f| f.severity == severity).count();
    let part = |severity: Severity| match of(severity) {
        0 => None,
        1 => Some(format!("1 {severity}")),
        n => Some(format!("{n} {severity}s")),
    };
    let parts: Vec<String> = SEVERITIES.into_iter().filter_map(part).collect();
    if parts.is_empty() { "nothing found".to_owned() } else { parts.join(", ") }
}

/// A table for the page; none where nothing was found.
pub(super) fn table(recordings: &[RecordingFindings]) -> Option<Table> {
    let row = |r: &RecordingFindings, f: &Finding| {
        vec![
            label(f.severity).to_owned(),
            f.code.to_string(),
            name(r),
            seen(f),
            f.remedy.clone(),
            format!("{} {}", significant(f.value, 3), f.unit),
            optional(f.limit, 3),
        ]
    };
    let rows: Vec<Vec<String>> = recordings.iter().flat_map(|r| r.findings.iter().map(move |f| row(r, f))).collect();
    let head = ["severity", "check", "recording", "seen", "what to do", "evidence", "limit"];
    (!rows.is_empty()).then(|| Table {
        title: "Findings".to_owned(),
        lead: 5,
        head: head.map(str::to_owned).to_vec(),
        rows,
        ..Table::default()
    })
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
