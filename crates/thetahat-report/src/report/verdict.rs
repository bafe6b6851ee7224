//! The verdict and its reasons, as lines of the head of a report.

use super::wrap::{TextWidth, wrap};
use crate::results::{ReasonCode, Results, Verdict, VerdictReason};

/// The verdict, and a line for each reason; none without a verdict.
pub(super) fn lines(results: &Results) -> Vec<(&'static str, String)> {
    let Some(verdict) = results.verdict else { return Vec::new() };
    let reasons = results.verdict_reasons.iter().map(|r| ("because", because(r)));
    std::iter::once(("verdict", in_words(verdict, results.verdict_reasons.len()))).chain(reasons).collect()
}

/// The verdict on the results that a prediction uses, for the terminal.
pub(super) fn inherited(verdict: Verdict, reasons: &[VerdictReason], width: TextWidth) -> String {
    let head = wrap(&format!("verdict on its results: {}", in_words(verdict, reasons.len())), "", width);
    reasons.iter().map(|r| wrap(&because(r), "  ", width)).fold(head, |text, line| text + &line)
}

fn in_words(verdict: Verdict, reasons: usize) -> String {
    let count = if reasons == 1 { "one reason".to_owned() } else { format!("{reasons} reasons") };
    match verdict {
        Verdict::Good => "good: use the recommended numbers".to_owned(),
        Verdict::Care => format!("use the recommended numbers with care, for {count}"),
        Verdict::DoNotUse => format!("DO NOT USE the numbers, for {count}"),
    }
}

fn because(reason: &VerdictReason) -> String {
    let mark = match (reason.verdict, reason.code) {
        (Verdict::DoNotUse, ReasonCode::CheckProblem) => "PROBLEM ",
        (Verdict::Good | Verdict::Care | Verdict::DoNotUse, _) => "",
    };
    format!("{mark}[{}] {}", reason.code, reason.text)
}
