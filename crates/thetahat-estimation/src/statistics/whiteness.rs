use super::{ChiSquaredTest, chi_squared_test};

/// Most lags of a test, and fewest rows per lag.
const MOST_LAGS: usize = 10;
const ROWS_PER_LAG: usize = 5;

/// The usual number of lags: ten, or a fifth of the rows if that is less (R. J. Hyndman, G. Athanasopoulos,
/// "Forecasting: principles and practice", section 5.4).
#[must_use]
pub fn usual_lags(rows: usize) -> usize {
    MOST_LAGS.min(rows / ROWS_PER_LAG)
}

/// The autocorrelation at each lag from 1.
///
/// Products never cross from one segment to the next; mean and variance are those of all segments.
#[must_use]
pub fn autocorrelation(segments: &[&[f64]], lags: usize) -> Vec<f64> {
    let rows: usize = segments.iter().map(|s| s.len()).sum();
    let mean = segments.iter().flat_map(|s| s.iter()).sum::<f64>() / rows.max(1) as f64;
    let product = |s: &[f64], k: usize| -> f64 { s.iter().zip(&s[k..]).map(|(a, b)| (a - mean) * (b - mean)).sum() };
    let at = |k: usize| segments.iter().filter(|s| s.len() > k).map(|s| product(s, k)).sum::<f64>();
    let variance = at(0);
    (1..=lags).map(|k| at(k) / variance).collect()
}

/// The Ljung-Box test of white rows: `Q = n (n + 2) sum_k r_k^2 / (n - k)`, chi-squared with as many degrees of freedom as
/// lags, summed over the segments (G. M. Ljung, G. E. P. Box, "On a measure of lack of fit in time series models", 1978).
///
/// `None` if every segment is too short, or does not vary.
#[must_use]
pub fn ljung_box(segments: &[&[f64]], lags: usize) -> Option<ChiSquaredTest> {
    let long: Vec<&[f64]> = segments.iter().copied().filter(|s| s.len() > lags).collect();
    let of_segment = |s: &&[f64]| {
        let n = s.len() as f64;
        let r = autocorrelation(&[s], lags);
        let terms = r.iter().enumerate().map(|(i, r)| r * r / (n - (i + 1) as f64));
        n * (n + 2.0) * terms.sum::<f64>()
    };
    let statistic = long.iter().map(of_segment).sum();
    chi_squared_test(statistic, lags * long.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(crate) fn series(n: usize, a: f64, b: f64) -> Vec<f64> {
        (0..n).map(|k| k as f64).map(|k| (a * k).sin() + 0.5 * (b * k * k).cos()).collect()
    }

    /// statsmodels 0.15.0, `acorr_ljungbox(x, lags=[10])`.
    #[test]
    fn the_statistic_is_that_of_statsmodels() {
        let x = series(60, 0.7, 0.31);
        let test = ljung_box(&[&x], 10).unwrap();
        assert!((test.statistic / 175.367_071_232_861_58 - 1.0).abs() < 1e-12, "{}", test.statistic);
        assert!((test.p_value / 2.142_995_794_094e-32 - 1.0).abs() < 1e-6, "{}", test.p_value);
    }

    #[test]
    fn segments_add_up_and_short_ones_are_left_out() {
        let (a, b) = (series(60, 0.7, 0.31), series(40, 1.1, 0.17));
        let both = ljung_box(&[&a, &b, &[1.0, 2.0]], 5).unwrap();
        let sum = ljung_box(&[&a], 5).unwrap().statistic + ljung_box(&[&b], 5).unwrap().statistic;
        assert!((both.statistic - sum).abs() < 1e-9);
        assert_eq!(both.freedom, 10);
        assert!(ljung_box(&[&[0.0; 20]], 5).is_none());
    }
}
