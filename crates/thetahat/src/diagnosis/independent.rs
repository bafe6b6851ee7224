use thetahat_estimation::statistics::autocorrelation;

/// Autocorrelation of residuals below which they count as independent, and the part of the rows that is looked at.
const INDEPENDENT: f64 = 0.05;
const ROWS_PER_LAG: usize = 5;

/// How many independent rows a joint's residual is worth, given by its stretches of time: the rows over `1 + 2 sum_k r_k`,
/// with the autocorrelations r until they are small.
pub(crate) fn independent_rows(stretches: &[&[f64]]) -> f64 {
    let rows: usize = stretches.iter().map(|s| s.len()).sum();
    let lags = autocorrelation(stretches, rows / stretches.len().max(1) / ROWS_PER_LAG);
    let sum: f64 = lags.iter().take_while(|r| **r > INDEPENDENT).sum();
    rows as f64 / (1.0 + 2.0 * sum)
}
