//! Collects the measures and findings of the checks.

use super::{
    finding::{Code, Finding, Measure, Severity},
    remedy_step::{OrderedStep, RemedyStep},
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
    /// From zero; `None` if the evidence is about all coordinates.
    pub(super) coordinate: Option<usize>,
    pub(super) value: f64,
    pub(super) unit: &'static str,
    pub(super) limit: f64,
}

/// The text of a finding.
pub(super) struct FindingText {
    /// What was found.
    message: String,
    /// What to do.
    remedy: String,
    /// The parameters it is about.
    parameters: Vec<String>,
    /// The change of the settings that does it.
    step: Option<RemedyStep>,
}

impl FindingText {
    pub(super) fn new(message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { message: message.into(), remedy: remedy.into(), parameters: Vec::new(), step: None }
    }

    /// The same with the change of the settings that does what the remedy says.
    pub(super) fn with_step(self, step: impl Into<Option<RemedyStep>>) -> Self {
        Self { step: step.into(), ..self }
    }

    /// The same, about these parameters.
    pub(super) fn about(self, parameters: Vec<String>) -> Self {
        Self { parameters, ..self }
    }
}

impl<'a> Examination<'a> {
    pub(super) fn new(subject: &'a Subject<'a>) -> Self {
        Self { subject, findings: Vec::new(), measures: Vec::new() }
    }

    /// Notes the evidence, and raises a finding if it is above its limit. Returns whether it is.
    pub(super) fn judge(&mut self, evidence: Evidence, severity: Severity, text: impl FnOnce() -> FindingText) -> bool {
        self.note_measure(evidence);
        let raised = evidence.value.is_finite() && evidence.value > evidence.limit;
        if raised {
            self.raise(evidence, severity, text());
        }
        raised
    }

    /// Raises a finding if the evidence is above its limit, in place of one of the same code and joint. Returns whether it is.
    pub(super) fn replace(
        &mut self,
        evidence: Evidence,
        severity: Severity,
        text: impl FnOnce() -> FindingText,
    ) -> bool {
        let joint = evidence.coordinate.map(|c| self.subject.joint_number(c));
        let raised = evidence.value > evidence.limit;
        if raised {
            self.findings.retain(|finding| finding.code != evidence.code || finding.joint != joint);
            self.raise(evidence, severity, text());
        }
        raised
    }

    /// Notes the evidence without a finding.
    pub(super) fn note_measure(&mut self, Evidence { code, coordinate, value, limit, .. }: Evidence) {
        let joint = coordinate.map(|c| self.subject.joint_number(c));
        self.measures.push(Measure { code, joint, value, limit });
    }

    /// Raises a finding, whatever its limit.
    pub(super) fn raise(&mut self, evidence: Evidence, severity: Severity, text: FindingText) {
        let Evidence { code, coordinate, value, unit, limit } = evidence;
        let FindingText { message, remedy, parameters, step } = text;
        let order = self.findings.len();
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
            step: step.map(|step| OrderedStep { order, step }),
        });
    }

    /// Whether there is a problem or a warning of one of these codes.
    pub(super) fn has(&self, codes: &[Code]) -> bool {
        self.findings.iter().any(|f| codes.contains(&f.code) && f.severity < Severity::Note)
    }

    /// Whether there is a problem of a code.
    pub(super) fn has_problem(&self, code: Code) -> bool {
        self.findings.iter().any(|f| f.code == code && f.severity == Severity::Problem)
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
