use super::{ChiSquaredTest, chi_squared_test};

/// The Jarque-Bera test of normal rows, from their skewness S and kurtosis K: `n / 6 (S^2 + (K - 3)^2 / 4)`, chi-squared
/// with two degrees of freedom (C. M. Jarque, A. K. Bera, "A test for normality of observations and regression
/// residuals", 1987).
///
/// It assumes independent rows. `None` if they do not vary.
#[must_use]
pub fn jarque_bera(rows: &[f64]) -> Option<ChiSquaredTest> {
    let n = rows.len() as f64;
    let mean = rows.iter().sum::<f64>() / n;
    let moment = |power: i32| rows.iter().map(|v| (v - mean).powi(power)).sum::<f64>() / n;
    let variance = moment(2);
    let skewness = moment(3) / variance.powf(1.5);
    let excess = moment(4) / variance.powi(2) - 3.0;
    chi_squared_test(n / 6.0 * (skewness.powi(2) + 0.25 * excess.powi(2)), 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SciPy 1.17.1, `jarque_bera`.
    #[test]
    fn the_statistic_is_that_of_scipy() {
        let x: Vec<f64> = (0..60).map(f64::from).map(|k| (0.7 * k).sin() + 0.5 * (0.31 * k * k).cos()).collect();
        let test = jarque_bera(&x).unwrap();
        assert!((test.statistic - 3.706_120_846_702_741).abs() < 1e-12);
        assert!((test.p_value - 0.156_756_689_624_197_7).abs() < 1e-12);
        assert!(jarque_bera(&[1.0; 9]).is_none());
    }
}
