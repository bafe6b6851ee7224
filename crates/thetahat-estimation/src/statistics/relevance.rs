use thetahat_ground::linear_algebra::{Matrix, PivotedQr};

/// How strongly instruments determine a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InstrumentStrength {
    /// F statistic of the first stage of this parameter alone: how much the instruments explain of the part of its column that
    /// the other columns do not explain.
    pub f_statistic: f64,
}

/// The conditional first-stage F statistic of each column of X with as many instruments Z as columns (E. Sanderson, F.
/// Windmeijer, "A weak instrument F-test in linear IV models with multiple endogenous variables", 2016).
///
/// With `Z = Q R` and `G = ((Q^T X)^T Q^T X)^-1`, the part of column j that the others leave is `u = X G_j / G_jj`; of its
/// squares the instruments explain `1 / G_jj` with one degree of freedom, and `F = (1 / G_jj) / ((u^T u - 1 / G_jj) / (r - b))`.
/// `None` if the instruments do not identify the parameters.
#[must_use]
pub fn instrument_strength(z: &Matrix, x: &Matrix) -> Option<Vec<InstrumentStrength>> {
    let (rows, columns) = (x.rows(), x.columns());
    let instruments = PivotedQr::new(z);
    let q = instruments.thin_q();
    let projected = q.transposed_times(x);
    let factor = PivotedQr::new(&projected);
    if rows <= columns || instruments.rank(SINGULAR).min(factor.rank(SINGULAR)) < columns {
        return None;
    }
    let inverse = factor.inverse_gram();
    let left = x.times_matrix(&inverse);
    let strength = |j: usize| {
        let diagonal = inverse.at(j, j);
        let squares: f64 = left.column(j).iter().map(|u| (u / diagonal).powi(2)).sum();
        let unexplained = (squares - 1.0 / diagonal).max(0.0) / (rows - columns) as f64;
        InstrumentStrength { f_statistic: (1.0 / diagonal / unexplained).min(LARGEST) }
    };
    Some((0..columns).map(strength).collect())
}

/// The F statistic if the instruments explain everything, as when they are X itself.
const LARGEST: f64 = 1e300;
/// Relative size of a diagonal entry below which instruments count as dependent.
const SINGULAR: f64 = 1e-10;

#[cfg(test)]
mod tests {
    use super::{
        super::wu_hausman::tests::{Example, example},
        *,
    };

    /// Two regressions by statsmodels 0.15.0 OLS, as the definition has it.
    #[test]
    fn the_statistics_are_those_of_two_regressions() {
        let Example { z, x, .. } = example();
        let found = instrument_strength(&z, &x).unwrap();
        for (f, expected) in found.iter().zip([742.770_910_799_148_5, 812.882_213_357_490_5, 9_391.350_102_538_434]) {
            assert!((f.f_statistic / expected - 1.0).abs() < 1e-9, "{}, expected {expected}", f.f_statistic);
        }
    }

    #[test]
    fn instruments_of_too_low_rank_have_no_strength() {
        let Example { mut z, x, .. } = example();
        let copy = z.column(0).to_vec();
        z.column_mut(1).copy_from_slice(&copy);
        assert!(instrument_strength(&z, &x).is_none());
    }
}
