//! Numbers as text.

/// Printed in place of a missing number.
pub const NONE: &str = "-";

/// The decimal exponent of the leading digit.
pub fn magnitude(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

/// A number with the given number of decimals, without a minus sign before zero.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        _ => text,
    }
}

/// A number with the given number of significant digits; very large and very small ones in exponential notation.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let places = digits.saturating_sub(1);
    match magnitude(value) {
        m @ -4..=5 => fixed(value, usize::try_from(places as i32 - m).unwrap_or(0)),
        _ => format!("{value:.places$e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_keep_large_and_small_numbers_short() {
        assert_eq!(significant(975.446, 3), "975");
        assert_eq!(significant(0.001_077_4, 3), "0.00108");
        assert_eq!(significant(1.5e-9, 3), "1.50e-9");
        assert_eq!(significant(f64::NAN, 3), "-");
    }
}
