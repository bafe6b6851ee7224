use thetahat_report::results::{ReasonCode, ReasonSubject, Verdict, VerdictReason};

/// What a reason says: what was seen, and what to do about it.
pub(super) struct ReasonText {
    pub(super) seen: String,
    pub(super) remedy: String,
}

impl ReasonText {
    pub(super) fn new(seen: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { seen: seen.into(), remedy: remedy.into() }
    }
}

/// A reason with its numbers by name; those that are none are left out, since JSON has no form for them.
pub(super) fn reason(
    code: ReasonCode,
    verdict: Verdict,
    numbers: &[(&str, Option<f64>)],
    concerned: ReasonSubject,
    ReasonText { seen, remedy }: ReasonText,
) -> VerdictReason {
    let finite = |(name, value): &(&str, Option<f64>)| Some(((*name).to_owned(), value.filter(|v| v.is_finite())?));
    let numbers = numbers.iter().filter_map(finite).collect();
    VerdictReason {
        code,
        verdict,
        numbers,
        subject: concerned,
        text: format!("{seen}; {remedy}."),
        remedy,
        remedies: Vec::new(),
    }
}
