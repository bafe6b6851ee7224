//! The one verdict on all results: on the model, or where there is none on the estimates, by the rules of `docs/reference/verdict.md`: from the results alone, so that it can be repeated
//! on any `results.json`.

mod comparisons;
mod estimates;
mod judged;
mod model;
mod reason;
mod recordings;

use std::cmp::Reverse;

use thetahat_report::results::{Results, Verdict, VerdictReason};

/// Writes the verdict and its reasons into results: the gravest first, and among them problems of the checks.
pub(crate) fn judge(results: &mut Results) -> Verdict {
    results.verdict_reasons = reasons(results);
    let verdict = results.verdict_reasons.iter().map(|r| r.verdict).max().unwrap_or(Verdict::Good);
    results.verdict = Some(verdict);
    let uses = results.model.as_ref().map(|model| model::uses(results, model));
    if let Some((model, uses)) = results.model.as_mut().zip(uses) {
        model.uses = uses;
    }
    verdict
}

fn reasons(results: &Results) -> Vec<VerdictReason> {
    let mut reasons = recordings::reasons(results);
    match &results.model {
        Some(model) => {
            reasons.extend(model::reasons(results, model));
            reasons.extend(comparisons::of_model(results));
        }
        None => {
            reasons.extend(comparisons::reasons(results));
            reasons.extend(estimates::reasons(results));
        }
    }
    reasons.sort_by_key(|r| (Reverse(r.verdict), r.code));
    reasons
}

#[cfg(test)]
mod tests;
