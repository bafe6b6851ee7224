use super::{
    Code, Finding, Measure, Severity, Subject, chain::Chain, controller, cutoff, excitation, fault, friction, gear,
    lag, motion, reference, repeats, resolution, signals::Signals, spikes, stamps, torque, velocity,
};

/// What the checks find in a recording: most severe first, then by code and joint.
///
/// Every check stands by itself; those of the fit look at the record as it is after the faults that were found are
/// corrected, so that a fault is named once. A record too short for the filters has no findings of the fit.
///
/// # Panics
/// If the series differ in length or channels, or the window is not in them.
#[must_use]
pub fn examine(subject: &Subject<'_>) -> Vec<Finding> {
    let mut findings = examination(subject).findings;
    findings.sort_by_key(|f| (f.severity, f.code, f.joint));
    findings
}

/// The numbers behind the findings, and those that were below their limits.
///
/// # Panics
/// As [`examine`].
#[must_use]
pub fn measure(subject: &Subject<'_>) -> Vec<Measure> {
    let mut measures = examination(subject).measures;
    measures.sort_by_key(|m| (m.code, m.joint));
    measures
}

fn examination<'a>(subject: &'a Subject<'a>) -> Examination<'a> {
    let mut exam = Examination { subject, findings: Vec::new(), measures: Vec::new() };
    exam.samples();
    if let Ok(signals) = Signals::new(subject, subject.signal.cutoff_hz) {
        exam.motion(&signals);
        if let Ok(chain) = Chain::new(subject, subject.signal.cutoff_hz) {
            exam.fit(chain);
        }
    }
    exam
}

impl<'a> Examination<'a> {
    /// The samples as recorded.
    fn samples(&mut self) {
        stamps::check(self);
        torque::check(self);
        spikes::check(self);
    }

    /// The band-passed motion, and what was recorded beside it.
    fn motion(&mut self, signals: &Signals) {
        motion::check(self, signals);
        if !self.has(&[Code::PositionSpikes]) {
            repeats::check(self, signals);
        }
        resolution::check(self, signals);
        velocity::check(self, signals);
        reference::check(self);
        if !self.has(&[Code::ReferenceMismatch]) {
            controller::check(self, signals);
        }
    }

    /// The fit. What a defect that was found makes meaningless is left out.
    fn fit(&mut self, mut chain: Chain<'a>) {
        let blind = self.has(&[Code::TorqueConstant, Code::JointStill]);
        if !blind {
            fault::check(self, &mut chain);
            friction::check(self, &mut chain);
            cutoff::check(self, &chain);
        }
        excitation::check(self, &chain);
        if !blind && !self.has(&[Code::PoorFit, Code::CutoffLow]) && chain.has_full_rank() {
            lag::check(self, &mut chain);
            gear::check(self, &mut chain);
        }
    }

    /// Whether one of these was found to matter.
    fn has(&self, codes: &[Code]) -> bool {
        self.findings.iter().any(|f| codes.contains(&f.code) && f.severity < Severity::Note)
    }
}

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
    /// From zero.
    pub(super) joint: Option<usize>,
    pub(super) value: f64,
    pub(super) unit: &'static str,
    pub(super) limit: f64,
}

impl Examination<'_> {
    /// Notes the evidence, and raises a finding where it is above its limit. `words` are message and remedy.
    pub(super) fn judge(
        &mut self,
        evidence: Evidence,
        severity: Severity,
        words: impl FnOnce() -> (String, String),
    ) -> bool {
        self.judge_with(evidence, severity, || (words(), Vec::new()))
    }

    /// The same with the parameters concerned.
    pub(super) fn judge_with(
        &mut self,
        evidence: Evidence,
        severity: Severity,
        words: impl FnOnce() -> ((String, String), Vec<String>),
    ) -> bool {
        self.note_measure(evidence);
        let raised = evidence.value.is_finite() && evidence.value > evidence.limit;
        if raised {
            let (words, parameters) = words();
            self.raise(evidence, severity, words, parameters);
        }
        raised
    }

    /// Notes the evidence alone.
    pub(super) fn note_measure(&mut self, Evidence { code, joint, value, limit, .. }: Evidence) {
        self.measures.push(Measure { code, joint: joint.map(|j| j + 1), value, limit });
    }

    /// A finding without further question.
    pub(super) fn raise(
        &mut self,
        Evidence { code, joint, value, unit, limit }: Evidence,
        severity: Severity,
        (message, remedy): (String, String),
        parameters: Vec<String>,
    ) {
        self.findings.push(Finding {
            code,
            severity,
            joint: joint.map(|j| j + 1),
            joint_name: joint.and_then(|j| self.subject.robot.joints.get(j)).map(|j| j.name.clone()),
            value,
            unit: unit.to_owned(),
            limit: Some(limit).filter(|l| l.is_finite()),
            message,
            remedy,
            parameters,
        });
    }

    /// The estimated parameters of link, joint and motor `j`.
    pub(super) fn own_parameters(&self, j: usize) -> Vec<String> {
        let table = self.subject.model.parameter_table();
        let own = |p: &&crate::base_parameters::BaseParameter| table.get(p.kept).number == j + 1;
        self.subject.base.parameters().iter().filter(own).map(|p| p.name.clone()).collect()
    }
}
