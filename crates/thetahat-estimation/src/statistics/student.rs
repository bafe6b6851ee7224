use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Degrees of freedom above which the quantile of Student's t is expanded about the normal quantile: there the quantile of statrs
/// loses digits (3e-6 at 1e5, 0.07 at 1e7), and the expansion is exact to rounding.
const EXPANDED: f64 = 1e4;

/// The quantile of Student's t: the value below which a variable lies with `probability`. The degrees of freedom need not be
/// integers.
///
/// `None` if the probability is not between zero and one, or without degrees of freedom. Above 1e4 degrees of freedom by the
/// expansion of Cornish and Fisher to the third order in 1/freedom (M. Abramowitz, I. Stegun, "Handbook of Mathematical
/// Functions", 26.7.5).
///
/// ```
/// use thetahat_estimation::statistics::t_quantile;
/// let quantile = t_quantile(0.975, 1e7).unwrap_or_default();
/// assert!((quantile - 1.959_964_221_767).abs() < 1e-12);
/// ```
#[must_use]
pub fn t_quantile(probability: f64, freedom: f64) -> Option<f64> {
    let inside = probability > 0.0 && probability < 1.0 && freedom > 0.0;
    if !inside {
        return None;
    }
    if freedom > EXPANDED {
        let normal = Normal::new(0.0, 1.0).ok()?.inverse_cdf(probability);
        return Some(expanded(normal, freedom));
    }
    Some(StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(probability))
}

/// The quantile of t from the normal quantile z.
fn expanded(z: f64, freedom: f64) -> f64 {
    let s = z * z;
    let first = z * (s + 1.0) / 4.0;
    let second = z * ((5.0 * s + 16.0) * s + 3.0) / 96.0;
    let third = z * (((3.0 * s + 19.0) * s + 17.0) * s - 15.0) / 384.0;
    z + (first + (second + third / freedom) / freedom) / freedom
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `scipy.stats.t.ppf(probability, freedom)`, SciPy 1.17.1.
    const SCIPY: [(f64, f64, f64); 17] = [
        (0.975, 1.0, 12.706204736174694),
        (0.975, 1.5, 6.016663104427929),
        (0.975, 2.7, 3.3921483831737507),
        (0.975, 5.0, 2.5705818356363146),
        (0.975, 30.0, 2.0422724563012378),
        (0.975, 120.5, 1.9798467346393642),
        (0.975, 2148.0, 1.9610690058607219),
        (0.975, 9900.0, 1.9602036366973516),
        (0.975, 10100.0, 1.9601988905510108),
        (0.975, 100000.0, 1.9599877075346095),
        (0.975, 1000000.0, 1.959966356814107),
        (0.975, 10000000.0, 1.959964221767205),
        (0.975, 1000000000.0, 1.959963986912325),
        (0.75, 7.3, 0.709573020456991),
        (0.995, 50.0, 2.677793270940844),
        (0.025, 12.0, -2.1788128296672293),
        (0.9, 200000.0, 1.2815557984827084),
    ];

    #[test]
    fn quantiles_are_those_of_scipy_at_any_freedom() {
        for (probability, freedom, expected) in SCIPY {
            let found = t_quantile(probability, freedom).unwrap();
            assert!((found / expected - 1.0).abs() < 1e-11, "t({probability}, {freedom}): {found}, not {expected}");
        }
    }

    #[test]
    fn both_methods_agree_at_the_switch() {
        let (below, above) =
            (t_quantile(0.975, EXPANDED).unwrap(), t_quantile(0.975, EXPANDED * (1.0 + 1e-12)).unwrap());
        assert!((below - above).abs() < 1e-11, "{below} {above}");
    }

    #[test]
    fn outside_its_range_there_is_no_quantile() {
        for (probability, freedom) in [(0.0, 5.0), (1.0, 5.0), (f64::NAN, 5.0), (0.9, 0.0), (0.9, f64::NAN)] {
            assert_eq!(t_quantile(probability, freedom), None);
        }
    }
}
