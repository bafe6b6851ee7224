/// The value below which a part of the values lies; zero without values.
#[doc(hidden)]
pub fn quantile(x: &[f64], part: f64) -> f64 {
    let mut sorted = x.to_vec();
    let index = (sorted.len().saturating_sub(1) as f64 * part).round() as usize;
    if sorted.is_empty() { 0.0 } else { *sorted.select_nth_unstable_by(index, f64::total_cmp).1 }
}

/// The middle value; zero without values.
#[doc(hidden)]
pub fn median(x: &[f64]) -> f64 {
    quantile(x, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_and_an_empty_list_has_zero() {
        let x = [-3.0, 1.0, 2.0, -5.0, 4.0];
        assert_eq!([0.0, 0.25, 1.0].map(|part| quantile(&x, part)), [-5.0, -3.0, 4.0]);
        assert_eq!((median(&x), median(&[])), (1.0, 0.0));
    }
}
