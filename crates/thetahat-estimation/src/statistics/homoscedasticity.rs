use super::{FTest, f_test};

/// Levene's test of equal variances about the medians: the F-test of equal means of `|x - median|` (M. B. Brown, A. B.
/// Forsythe, "Robust tests for the equality of variances", 1974).
///
/// `None` for fewer than two groups, or groups that do not vary.
#[must_use]
pub fn levene(groups: &[&[f64]]) -> Option<FTest> {
    let deviations: Vec<Vec<f64>> = groups.iter().map(|g| from_median(g)).collect();
    let rows: usize = deviations.iter().map(Vec::len).sum();
    let all: Vec<f64> = deviations.concat();
    let within = deviations.iter().map(|d| squares_about_mean(d)).sum();
    f_test(squares_about_mean(&all), 1, within, groups.len(), rows).filter(|t| t.statistic.is_finite())
}

fn from_median(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    let median = match sorted.len() {
        0 => 0.0,
        n if n % 2 == 1 => sorted[middle],
        _ => 0.5 * (sorted[middle - 1] + sorted[middle]),
    };
    values.iter().map(|v| (v - median).abs()).collect()
}

fn squares_about_mean(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|v| (v - mean).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(scale: f64, a: f64, b: f64) -> Vec<f64> {
        (0..40).map(f64::from).map(|k| scale * ((a * k).sin() + 0.5 * (b * k * k).cos())).collect()
    }

    /// SciPy 1.17.1, `levene(..., center='median')`.
    #[test]
    fn the_statistic_is_that_of_scipy() {
        let groups = [series(1.0, 0.7, 0.31), series(2.0, 1.1, 0.17), series(0.6, 0.3, 0.23)];
        let test = levene(&[&groups[0], &groups[1], &groups[2]]).unwrap();
        assert!((test.statistic - 29.621_522_682_223_716).abs() < 1e-10, "{}", test.statistic);
        assert!((test.p_value / 3.902_308_348_462e-11 - 1.0).abs() < 1e-6, "{}", test.p_value);
        assert!(levene(&[&groups[0]]).is_none());
        assert!(levene(&[&[1.0, 1.0, 1.0], &[2.0, 2.0, 2.0]]).is_none());
    }
}
