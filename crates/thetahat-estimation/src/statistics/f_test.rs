use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// The F-test of a reduced model against the full one that contains it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FTest {
    /// `((SSR_reduced - SSR_full) / (p_full - p_reduced)) / (SSR_full / (r - p_full))`.
    pub statistic: f64,
    /// Degrees of freedom of the numerator, `p_full - p_reduced`.
    pub numerator_freedom: usize,
    /// Degrees of freedom of the denominator, `r - p_full`.
    pub denominator_freedom: usize,
    /// Probability of a statistic at least as large if the reduced model is true.
    pub p_value: f64,
}

/// The F-test from sums of squared residuals, numbers of parameters and the number of rows.
///
/// It assumes independent, normal rows of equal variance. `None` without degrees of freedom.
#[must_use]
pub fn f_test(
    reduced_squares: f64,
    reduced_parameters: usize,
    full_squares: f64,
    full_parameters: usize,
    rows: usize,
) -> Option<FTest> {
    let numerator_freedom = full_parameters.checked_sub(reduced_parameters).filter(|d| *d > 0)?;
    let denominator_freedom = rows.checked_sub(full_parameters).filter(|d| *d > 0)?;
    let (d1, d2) = (numerator_freedom as f64, denominator_freedom as f64);
    let statistic = ((reduced_squares - full_squares) / d1) / (full_squares / d2);
    let p_value = f_probability(statistic, d1, d2)?;
    Some(FTest { statistic, numerator_freedom, denominator_freedom, p_value })
}

/// Probability that an F variable with these degrees of freedom, which need not be integers, is at least as large.
#[must_use]
pub fn f_probability(statistic: f64, numerator_freedom: f64, denominator_freedom: f64) -> Option<f64> {
    Some(FisherSnedecor::new(numerator_freedom, denominator_freedom).ok()?.sf(statistic.max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The 5 % point of F(3, 20) is 3.0984 (any table).
    #[test]
    fn the_five_percent_point_of_the_tables() {
        let (d2, f) = (20.0, 3.0984);
        let test = f_test(d2 + 3.0 * f, 2, d2, 5, 25).unwrap();
        assert!((test.statistic - f).abs() < 1e-12);
        assert!((test.p_value - 0.05).abs() < 1e-5, "{}", test.p_value);
    }

    #[test]
    fn without_freedom_there_is_no_test() {
        assert!(f_test(1.0, 3, 1.0, 3, 10).is_none());
        assert!(f_test(1.0, 2, 1.0, 3, 3).is_none());
    }
}
