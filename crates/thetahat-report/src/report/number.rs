//! Estimates and their deviations as text.

pub(super) use thetahat_ground::number::{NONE, fixed, magnitude, significant};

/// A given number, unchanged if it is short.
pub(super) fn given(value: f64) -> String {
    let text = value.to_string();
    if text.len() <= 8 { text } else { significant(value, 4) }
}

/// A sample rate, Hz: unchanged if it is short, otherwise with six digits.
pub(super) fn rate(hz: f64) -> String {
    let text = hz.to_string();
    if text.len() <= 8 {
        return text;
    }
    let six = significant(hz, 6);
    if six.contains('.') && !six.contains('e') {
        six.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        six
    }
}

/// A number with this many significant digits, or a dash.
pub(super) fn optional(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| NONE.to_owned(), |v| significant(v, digits))
}

/// Decimals that show two significant digits of a standard deviation.
fn decimals_of(deviation: f64) -> Option<usize> {
    let usable = deviation.is_finite() && deviation > 0.0;
    usable.then(|| 1 - magnitude(deviation)).filter(|d| *d <= 9).map(|d| usize::try_from(d).unwrap_or(0))
}

/// An estimate to two significant digits of its standard deviation.
pub(super) fn estimate(value: f64, deviation: Option<f64>) -> String {
    match deviation.and_then(decimals_of) {
        Some(decimals) if value.abs() < 1e6 => fixed(value, decimals),
        _ => significant(value, 4),
    }
}

/// A difference in standard deviations, with its sign.
pub(super) fn signed(deviations: f64) -> String {
    let text = fixed(deviations, 1);
    if deviations > 0.0 && text != "0.0" { format!("+{text}") } else { text }
}

/// An estimate and its standard deviation, `1.244±0.012`.
pub(super) fn with_deviation(value: f64, deviation: Option<f64>) -> String {
    let Some(deviation) = deviation else { return estimate(value, None) };
    format!("{}±{}", estimate(value, Some(deviation)), estimate(deviation, Some(deviation)))
}

/// An estimate and its relative standard deviation as papers print them, `1.25 (1.04 %)`.
pub(super) fn with_percent(estimate: &str, percent: Option<f64>) -> String {
    percent.map_or_else(|| estimate.to_owned(), |p| format!("{estimate} ({} %)", significant(p, 3)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_from_time_stamps_has_six_digits() {
        assert_eq!(
            [125.000_000_004_5, 99.999_949, 499.999_055, 1000.0, 5e3].map(rate),
            ["125", "99.9999", "499.999", "1000", "5000"]
        );
    }

    #[test]
    fn digits_follow_the_standard_deviation() {
        assert_eq!(with_deviation(1.244_43, Some(0.012_2)), "1.244±0.012");
        assert_eq!(with_deviation(203.503, Some(1.146)), "203.5±1.1");
        assert_eq!(estimate(-0.000_1, Some(0.02)), "0.000");
        assert_eq!(with_percent("-0.03", Some(23.2)), "-0.03 (23.2 %)");
    }
}
