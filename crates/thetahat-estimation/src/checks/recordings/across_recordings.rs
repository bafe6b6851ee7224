//! Checks that compare recordings with each other.

use super::{companion::Companion, contradiction, same_recording};
use crate::checks::finding::{Finding, Measure};

/// The findings of a comparison of recordings: samples that two of them share, and recordings that separate fits explain but a
/// common fit does not.
///
/// # Panics
/// As [`crate::checks::examine`].
#[must_use]
pub fn compare(companions: &[Companion<'_>]) -> Vec<Finding> {
    let mut findings = same_recording::check(companions);
    findings.extend(contradiction::check(companions));
    findings.sort_by_key(|f| (f.severity, f.code));
    findings
}

/// The evidence of [`compare`], whether above or below its limit.
#[must_use]
pub fn measure_across_recordings(companions: &[Companion<'_>]) -> Vec<Measure> {
    let mut measures = same_recording::measure(companions);
    measures.extend(contradiction::measure(companions));
    measures
}
