//! What the residual of a run depends on: itself, frequency, velocity, position and torque.

use thetahat_estimation::{
    regression::Regression,
    signal::Spectrum,
    statistics::{autocorrelation, quantile},
};
use thetahat_ground::{linear_algebra::Matrix, series::Series};
use thetahat_report::results::{Bin, ResidualCurves};

/// Most lags of the autocorrelation, and the part of the rows that they may be.
const MOST_LAGS: usize = 40;
const ROWS_PER_LAG: usize = 4;
/// Most frequencies of a spectrum.
const FREQUENCIES: usize = 120;
/// Ranges into which another quantity is divided, and fewest rows that one holds.
const BINS: usize = 24;
const ROWS_OF_BIN: usize = 5;
/// Standard deviations on both sides that hold 95 % of a normal distribution.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// What the residuals of joints may depend on, one vector for each joint in the order of its rows.
pub(in crate::run) struct Motion {
    pub(in crate::run) position: Vec<Vec<f64>>,
    pub(in crate::run) velocity: Vec<Vec<f64>>,
    /// Rows per second.
    pub(in crate::run) rate_hz: f64,
}

/// The curves of each joint's residual.
pub(in crate::run) fn residual_curves(
    regression: &Regression,
    prediction: &[f64],
    motion: &Motion,
) -> Vec<ResidualCurves> {
    let residual = regression.residual(prediction);
    let runs = regression.layout.runs(&residual);
    let (of_joint, torque) = (regression.layout.by_joint(&residual), regression.layout.by_joint(prediction));
    let used = |j: usize| used_rows(regression, j);
    let curves = |j: usize| {
        let (residual, used) = (&of_joint[j], used(j));
        let over = |quantity: Option<&Vec<f64>>| quantity.map_or_else(Vec::new, |q| bins(q, residual, &used));
        let rows: usize = runs[j].iter().map(|run| run.len()).sum();
        ResidualCurves {
            autocorrelation: autocorrelation(&runs[j], MOST_LAGS.min(rows / ROWS_PER_LAG)),
            band: NORMAL_95 / (rows.max(1) as f64).sqrt(),
            spectrum: spectrum(residual, motion.rate_hz),
            over_velocity: over(motion.velocity.get(j)),
            over_position: over(motion.position.get(j)),
            over_torque: over(torque.get(j)),
        }
    };
    (0..of_joint.len()).map(curves).collect()
}

/// Which of a joint's rows a mask leaves.
fn used_rows(regression: &Regression, joint: usize) -> Vec<bool> {
    let layout = &regression.layout;
    let used: std::collections::BTreeSet<usize> = layout.used_rows_of_joint(joint).collect();
    layout.rows_of_joint(joint).map(|row| used.contains(&row)).collect()
}

/// The spectral density, neighbouring frequencies taken together where there are many.
fn spectrum(residual: &[f64], rate_hz: f64) -> Vec<[f64; 2]> {
    let found = Spectrum::of(&Series::shaped(1, residual.to_vec()), rate_hz);
    let all: Vec<[f64; 2]> = found.frequencies_hz().zip(&found.density[0]).map(|(f, d)| [f, *d]).skip(1).collect();
    let together = all.len().div_ceil(FREQUENCIES).max(1);
    let mean = |part: &[[f64; 2]]| [0, 1].map(|i: usize| part.iter().map(|p| p[i]).sum::<f64>() / part.len() as f64);
    all.chunks(together).map(mean).collect()
}

/// The residual in equal ranges of another quantity.
fn bins(quantity: &[f64], residual: &[f64], used: &[bool]) -> Vec<Bin> {
    let rows: Vec<(f64, f64)> = quantity
        .iter()
        .copied()
        .zip(residual.iter().copied())
        .zip(used)
        .filter(|(_, u)| **u)
        .map(|(row, _)| row)
        .collect();
    let (low, high) = rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (q, _)| (l.min(*q), h.max(*q)));
    if low >= high {
        return Vec::new();
    }
    let mut parts: Vec<Vec<(f64, f64)>> = vec![Vec::new(); BINS];
    rows.iter()
        .for_each(|row| parts[((row.0 - low) / (high - low) * BINS as f64).min(BINS as f64 - 1.0) as usize].push(*row));
    parts.iter().filter(|part| part.len() >= ROWS_OF_BIN).map(|part| bin(part)).collect()
}

fn bin(rows: &[(f64, f64)]) -> Bin {
    let count = rows.len() as f64;
    let residuals: Vec<f64> = rows.iter().map(|(_, r)| *r).collect();
    Bin {
        at: rows.iter().map(|(q, _)| q).sum::<f64>() / count,
        mean: residuals.iter().sum::<f64>() / count,
        spread: [0.1, 0.9].map(|part| quantile(&residuals, part)),
    }
}

/// Correlations from a covariance, a row for each parameter.
pub(in crate::run) fn correlations(covariance: &Matrix) -> Vec<Vec<f64>> {
    let deviation = |i: usize| covariance.at(i, i).sqrt();
    let of = |i: usize, j: usize| covariance.at(i, j) / (deviation(i) * deviation(j));
    (0..covariance.rows()).map(|i| (0..covariance.columns()).map(|j| of(i, j)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Friction that changes sign with the velocity: 0.5 forwards, -0.5 backwards; a masked row does not count.
    #[test]
    fn the_residual_is_averaged_where_the_velocity_is_alike() {
        let velocity: Vec<f64> = (0..480).map(|k| f64::from(k) / 240.0 - 1.0).collect();
        let mut residual: Vec<f64> = velocity.iter().map(|v| if *v < 0.0 { -0.5 } else { 0.5 }).collect();
        residual[0] = 1e6;
        let mut used = vec![true; 480];
        used[0] = false;
        let bins = bins(&velocity, &residual, &used);
        assert_eq!(bins.len(), BINS);
        assert!(bins.iter().all(|b| b.mean == 0.5_f64.copysign(b.at) && b.spread == [b.mean; 2]), "{bins:?}");
        assert!(super::bins(&[1.0; 9], &[0.0; 9], &[true; 9]).is_empty());
    }

    #[test]
    fn correlations_are_covariances_in_deviations() {
        let covariance = Matrix::from_fn(2, 2, |i, j| [[4.0, -3.0], [-3.0, 9.0]][i][j]);
        assert_eq!(correlations(&covariance), [[1.0, -0.5], [-0.5, 1.0]]);
    }

    #[test]
    fn a_long_spectrum_keeps_its_power() {
        let sine: Vec<f64> = (0..5000).map(|k| (0.2 * f64::from(k)).sin()).collect();
        let found = spectrum(&sine, 100.0);
        assert!(found.len() <= FREQUENCIES, "{}", found.len());
        let power = found.windows(2).map(|w| 0.5 * (w[0][1] + w[1][1]) * (w[1][0] - w[0][0])).sum::<f64>();
        assert!((power - 0.5).abs() < 0.02, "{power}");
    }
}
