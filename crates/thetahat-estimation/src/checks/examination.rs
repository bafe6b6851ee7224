//! The collector of what the checks measure and find.

use super::{
    finding::{Code, Finding, Measure, Severity},
    subject::Subject,
};

/// The findings and measures so far.
pub(super) struct Examination<'a> {
    pub(super) subject: &'a Subject<'a>,
    findings: Vec<Finding>,
    measures: Vec<Measure>,
}

/// Evidence and its limit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Evidence {
    pub(super) code: Code,
    /// From zero; none where it is about all of them.
    pub(super) coordinate: Option<usize>,
    pub(super) value: f64,
    pub(super) unit: &'static str,
    pub(super) limit: f64,
}

/// What a finding says.
pub(super) struct FindingText {
    /// What was seen.
    message: String,
    /// What to do.
    remedy: String,
    /// The parameters concerned.
    parameters: Vec<String>,
}

impl FindingText {
    pub(super) fn new(message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { message: message.into(), remedy: remedy.into(), parameters: Vec::new() }
    }

    /// The same about these parameters.
    pub(super) fn about(self, parameters: Vec<String>) -> Self {
        Self { parameters, ..self }
    }
}

impl<'a> Examination<'a> {
    pub(super) fn new(subject: &'a Subject<'a>) -> Self {
        Self { subject, findings: Vec::new(), measures: Vec::new() }
    }

    /// Notes the evidence, and raises a finding where it is above its limit; whether it is.
    pub(super) fn judge(
        &mut self,
        evidence: Evidence,
        severity: Severity,
        words: impl FnOnce() -> FindingText,
    ) -> bool {
        self.note_measure(evidence);
        let raised = evidence.value.is_finite() && evidence.value > evidence.limit;
        if raised {
            self.raise(evidence, severity, words());
        }
        raised
    }

    /// Notes the evidence alone.
    pub(super) fn note_measure(&mut self, Evidence { code, coordinate, value, limit, .. }: Evidence) {
        let joint = coordinate.map(|c| self.subject.joint_number(c));
        self.measures.push(Measure { code, joint, value, limit });
    }

    /// Raises a finding, whatever its limit.
    pub(super) fn raise(&mut self, evidence: Evidence, severity: Severity, words: FindingText) {
        let Evidence { code, coordinate, value, unit, limit } = evidence;
        let FindingText { message, remedy, parameters } = words;
        self.findings.push(Finding {
            code,
            severity,
            joint: coordinate.map(|c| self.subject.joint_number(c)),
            joint_name: coordinate.map(|c| self.subject.joint(c).name.clone()),
            value,
            unit: unit.to_owned(),
            limit: Some(limit).filter(|l| l.is_finite()),
            message,
            remedy,
            parameters,
        });
    }

    /// Whether one of these was found to matter.
    pub(super) fn has(&self, codes: &[Code]) -> bool {
        self.findings.iter().any(|f| codes.contains(&f.code) && f.severity < Severity::Note)
    }

    /// The findings, most severe first, then by code and joint.
    pub(super) fn into_findings(mut self) -> Vec<Finding> {
        self.findings.sort_by_key(|f| (f.severity, f.code, f.joint));
        self.findings
    }

    /// The measures by code and joint.
    pub(super) fn into_measures(mut self) -> Vec<Measure> {
        self.measures.sort_by_key(|m| (m.code, m.joint));
        self.measures
    }
}
