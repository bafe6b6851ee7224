//! Recordings beside one another.

use super::{
    companion::Companion,
    contradiction,
    finding::{Code, Finding},
    same_recording,
};

/// What the checks find in recordings beside one another: samples that two of them share, and recordings that are
/// explained one by one and not together.
///
/// # Panics
/// As [`super::examine`].
#[must_use]
pub fn compare(companions: &[Companion<'_>]) -> Vec<Finding> {
    let mut findings = same_recording::check(companions);
    findings.extend(contradiction::check(companions));
    findings.sort_by_key(|f| (f.severity, f.code));
    findings
}

/// The numbers behind [`compare`], also of those below their limits: code, value and limit.
#[must_use]
pub fn measure_together(companions: &[Companion<'_>]) -> Vec<(Code, f64, f64)> {
    let mut measures = same_recording::measure(companions);
    measures.extend(contradiction::measure(companions));
    measures
}
