use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A test whose statistic is chi-squared under the null hypothesis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ChiSquaredTest {
    /// The statistic.
    pub statistic: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Probability of a statistic at least as large under the null hypothesis.
    pub p_value: f64,
}

/// The test of a statistic; `None` without degrees of freedom, or if the statistic is not a number.
#[must_use]
pub fn chi_squared_test(statistic: f64, freedom: usize) -> Option<ChiSquaredTest> {
    let distribution = ChiSquared::new(freedom as f64).ok()?;
    let p_value = distribution.sf(statistic.max(0.0));
    (!statistic.is_nan()).then_some(ChiSquaredTest { statistic, freedom, p_value })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The 5 % point of 10 degrees of freedom is 18.307 (any table).
    #[test]
    fn the_five_percent_point_of_the_tables() {
        assert!((chi_squared_test(18.307, 10).unwrap().p_value - 0.05).abs() < 1e-5);
        assert!(chi_squared_test(1.0, 0).is_none());
        assert!(chi_squared_test(f64::NAN, 3).is_none());
    }
}
