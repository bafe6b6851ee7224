use crate::results::{Concerned, ReasonCode, Verdict, VerdictReason};

/// A reason with its numbers by name; those that are none are left out, since JSON has no form for them.
pub(super) fn reason(
    code: ReasonCode,
    verdict: Verdict,
    numbers: &[(&str, Option<f64>)],
    concerned: Concerned,
    text: String,
) -> VerdictReason {
    let finite = |(name, value): &(&str, Option<f64>)| Some(((*name).to_owned(), value.filter(|v| v.is_finite())?));
    VerdictReason { code, verdict, numbers: numbers.iter().filter_map(finite).collect(), concerned, text }
}
