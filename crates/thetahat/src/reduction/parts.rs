//! What the parts of a long recording show together.

use std::collections::BTreeMap;

use thetahat_estimation::checks::{Code, Finding, Severity};

/// What was found in one part.
pub(super) struct PartFindings {
    /// From and to, s.
    pub span_s: [f64; 2],
    pub findings: Vec<Finding>,
}

/// A finding with the part in which it was made.
type FoundInPart<'a> = (&'a PartFindings, &'a Finding);

/// One finding for each code and joint, the one with the largest evidence of those that are as severe as most parts say.
///
/// What is seen in fewer than half of the parts is one degree less severe; what says that nothing moves or changes there is
/// a note, since a robot may rest for a part of a recording.
pub(super) fn findings_of_parts(parts: &[PartFindings]) -> Vec<Finding> {
    let mut by_kind: BTreeMap<(Code, Option<usize>), Vec<FoundInPart<'_>>> = BTreeMap::new();
    for part in parts {
        for finding in &part.findings {
            by_kind.entry((finding.code, finding.joint)).or_default().push((part, finding));
        }
    }
    let mut findings: Vec<Finding> = by_kind.values().map(|found| of_kind(found, parts.len())).collect();
    findings.sort_by_key(|f| (f.severity, f.code, f.joint));
    findings
}

fn of_kind(found: &[FoundInPart<'_>], parts: usize) -> Finding {
    let severity = severity(found.iter().map(|(_, finding)| *finding), parts);
    let worst = found
        .iter()
        .min_by(|(_, a), (_, b)| a.severity.cmp(&b.severity).then_with(|| b.value.abs().total_cmp(&a.value.abs())));
    let (part, finding) = worst.unwrap_or(&found[0]);
    let [from_s, to_s] = part.span_s;
    let seen = format!("{} of {parts} parts, worst from {from_s:.1} to {to_s:.1} s", found.len());
    Finding { severity, message: format!("{} ({seen})", finding.message), ..Finding::clone(finding) }
}

/// The severity that at least half of the parts find.
fn severity<'f>(found: impl Iterator<Item = &'f Finding> + Clone, parts: usize) -> Severity {
    let at_least = |severity: Severity| 2 * found.clone().filter(|f| f.severity <= severity).count() >= parts;
    let worst = found.clone().map(|f| f.severity).min().unwrap_or(Severity::Note);
    let is_rest = found.clone().any(|f| says_that_nothing_happens(f.code));
    match worst {
        Severity::Problem if at_least(Severity::Problem) => Severity::Problem,
        Severity::Problem | Severity::Warning if is_rest && !at_least(Severity::Warning) => Severity::Note,
        Severity::Problem => Severity::Warning,
        Severity::Warning if at_least(Severity::Warning) => Severity::Warning,
        Severity::Warning | Severity::Note => Severity::Note,
    }
}

/// Whether a finding is of joints that rest, and of what a rest lacks.
fn says_that_nothing_happens(code: Code) -> bool {
    use Code as C;
    matches!(code, C::JointStill | C::StillPeriod | C::NotExcited | C::TorqueConstant | C::TorqueIdle | C::JointDither)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(code: Code, severity: Severity, value: f64) -> Finding {
        Finding {
            code,
            severity,
            joint: Some(1),
            joint_name: None,
            value,
            unit: String::new(),
            limit: Some(1.0),
            message: "seen".to_owned(),
            remedy: "mend".to_owned(),
            parameters: Vec::new(),
            step: None,
        }
    }

    fn parts(found: &[Option<Finding>]) -> Vec<PartFindings> {
        let part = |(k, finding): (usize, &Option<Finding>)| PartFindings {
            span_s: [k as f64, k as f64 + 1.0],
            findings: finding.iter().cloned().collect(),
        };
        found.iter().enumerate().map(part).collect()
    }

    #[test]
    fn what_most_parts_find_counts_as_they_say() {
        let negated = |value| Some(finding(Code::TorqueSign, Severity::Problem, value));
        let found = findings_of_parts(&parts(&[negated(2.0), negated(5.0), None]));
        assert_eq!((found.len(), found[0].severity, found[0].value), (1, Severity::Problem, 5.0));
        assert_eq!(found[0].message, "seen (2 of 3 parts, worst from 1.0 to 2.0 s)");
        assert_eq!(findings_of_parts(&parts(&[negated(2.0), None, None]))[0].severity, Severity::Warning);
    }

    #[test]
    fn a_rest_of_one_part_is_a_note() {
        let still = Some(finding(Code::JointStill, Severity::Problem, 2.0));
        assert_eq!(findings_of_parts(&parts(&[still.clone(), None, None]))[0].severity, Severity::Note);
        assert_eq!(findings_of_parts(&parts(&[still.clone(), still]))[0].severity, Severity::Problem);
    }
}
