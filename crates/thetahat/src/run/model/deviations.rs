//! Deviations of residuals, and of differences between parts.

use thetahat_ground::linear_algebra::{dot, norm};
use thetahat_model::robot::JointKind;

/// Deviations of all joints that lie between their own and the one that those of their kind have in common: newton and newton
/// metres are not compared.
pub(super) fn weighted(deviations: &[f64], kinds: &[JointKind], power: f64) -> Vec<f64> {
    let common = |kind: JointKind| {
        let same = deviations.iter().zip(kinds).filter(|(_, other)| **other == kind);
        rms(&same.map(|(own, _)| *own).collect::<Vec<_>>())
    };
    deviations.iter().zip(kinds).map(|(own, kind)| own.powf(power) * common(*kind).powf(1.0 - power)).collect()
}

pub(super) fn rms(values: &[f64]) -> f64 {
    norm(values) / (values.len().max(1) as f64).sqrt()
}

/// The deviation of the mean of a series times the root of its length: widened by its autocorrelation with Bartlett's
/// weights (Newey and West, 1987).
pub(super) fn long_run_deviation(residual: &[f64]) -> f64 {
    let count = residual.len();
    let mean = residual.iter().sum::<f64>() / count.max(1) as f64;
    let centred: Vec<f64> = residual.iter().map(|e| e - mean).collect();
    let variance = dot(&centred, &centred);
    if variance == 0.0 {
        return rms(residual);
    }
    let lags = ((4.0 * (count as f64 / 100.0).powf(2.0 / 9.0)) as usize + 4).min(count - 1);
    let part = |k: usize| (1.0 - k as f64 / (lags + 1) as f64) * dot(&centred[k..], &centred[..count - k]) / variance;
    let widening = 1.0 + 2.0 * (1..=lags).map(part).sum::<f64>();
    rms(residual) * widening.max(1.0).sqrt()
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Mean of the differences of two lists, and its standard error.
pub(super) fn mean_and_error(of: &[f64], from: &[f64]) -> [f64; 2] {
    let differences: Vec<f64> = of.iter().zip(from).map(|(a, b)| a - b).collect();
    let (centre, count) = (mean(&differences), differences.len() as f64);
    let spread: f64 = differences.iter().map(|d| (d - centre).powi(2)).sum();
    [centre, (spread / (count - 1.0).max(1.0) / count).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_difference_has_its_standard_error() {
        let [mean, error] = mean_and_error(&[1.0, 2.0, 3.0], &[0.0, 0.0, 0.0]);
        assert!((mean - 2.0).abs() < 1e-15 && (error - (1.0_f64 / 3.0).sqrt()).abs() < 1e-15);
    }

    /// A joint that slides changes nothing of those that turn.
    #[test]
    fn joints_of_one_kind_have_a_deviation_in_common() {
        let [turns, slides] = [JointKind::Revolute, JointKind::Prismatic];
        let alone = weighted(&[4.0, 1.0], &[turns, turns], 0.5);
        let with = weighted(&[4.0, 900.0, 1.0], &[turns, slides, turns], 0.5);
        assert_eq!((with[0], with[2]), (alone[0], alone[1]));
        assert!((with[1] - 900.0).abs() < 1e-9 && alone[1] > 1.0 && alone[1] < 4.0, "{with:?} {alone:?}");
    }

    #[test]
    fn a_series_that_holds_each_value_twice_has_a_larger_deviation_of_its_mean() {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5
        };
        let white: Vec<f64> = (0..400).map(|_| next()).collect();
        let held: Vec<f64> = white.iter().flat_map(|v| [*v, *v]).collect();
        assert!(long_run_deviation(&held) > 1.2 * long_run_deviation(&white));
        assert_eq!(long_run_deviation(&[0.0; 8]), 0.0);
    }
}
