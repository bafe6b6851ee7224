//! Comparisons of numbers.

use libtest_mimic::Failed;

/// Fails unless `|a - b| <= tolerance * max(1, |b|)`.
pub fn assert_close(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{what}: {a} against {b}");
}

/// Fails with a message unless the condition holds.
///
/// # Errors
/// The message.
pub fn ensure(holds: bool, message: impl Into<String>) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(message.into().into()) }
}

/// Fails unless `value` is the printed number, to half a unit of its last digit.
///
/// # Errors
/// Both numbers, or a text that is no number.
pub fn ensure_printed(value: f64, printed: &str, what: &str) -> Result<(), Failed> {
    let decimals = printed.split_once('.').map_or(0, |(_, d)| d.len() as i32);
    let number: f64 = printed.parse()?;
    let half_digit = 0.5 * 10f64.powi(-decimals) * (1.0 + 1e-9);
    ensure((value - number).abs() <= half_digit, format!("{what}: {value} is not {printed}"))
}
