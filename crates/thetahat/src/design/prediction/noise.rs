//! The noise of a recording: white, or as the residual of an earlier identification shows it.

use std::f64::consts::{PI, TAU};

use thetahat_estimation::signal::Spectrum;
use thetahat_report::results::JointResidual;

/// Noise of the torques, joint by joint.
#[derive(Debug, Clone, Default)]
pub(in crate::design) struct TorqueNoise {
    /// Standard deviation per sample of white noise that changes the rows of y as much, N m or N.
    pub(in crate::design) deviations: Vec<f64>,
    /// The densities, where it is not white.
    pub(in crate::design) spectrum: Option<Spectrum>,
}

/// Row spacing times the cut-off of the parallel filter, which is 0.8 of half the rate of the rows.
const ROWS_PER_CUTOFF: f64 = 0.4;
/// Steps in which densities are given up to the cut-off.
const STEPS: usize = 200;
/// Longest correlation time considered, in spacings of the rows.
const LONGEST: f64 = 100.0;
const HALVINGS: usize = 50;

/// Noise whose rows, after the parallel filter, have the root mean squares and lag-one correlations of residuals: white, or first-order
/// low-pass noise if neighbouring rows correlate more than those of white noise.
pub(in crate::design) fn torque_noise_of_rows(
    rows: &[JointResidual],
    cutoff_hz: f64,
    sample_rate_hz: f64,
) -> TorqueNoise {
    let times: Vec<f64> = rows.iter().map(|row| correlation_time_s(row.autocorrelation, cutoff_hz)).collect();
    let per_row = (0.5 * sample_rate_hz / cutoff_hz).max(1.0).sqrt();
    let step_hz = cutoff_hz / STEPS as f64;
    let count = (0.5 * sample_rate_hz / step_hz).ceil() as usize + 1;
    let density = |(row, time_s): (&JointResidual, &f64)| -> Vec<f64> {
        let scale = row.rms.powi(2) / integral(*time_s, cutoff_hz, |_| 1.0);
        (0..count).map(|i| scale * shape(*time_s, i as f64 * step_hz)).collect()
    };
    let is_white = times.iter().all(|time_s| *time_s == 0.0);
    TorqueNoise {
        deviations: rows.iter().map(|row| row.rms * per_row).collect(),
        spectrum: (!is_white).then(|| Spectrum { step_hz, density: rows.iter().zip(&times).map(density).collect() }),
    }
}

/// The density of a first-order low-pass, one at zero.
fn shape(time_s: f64, frequency_hz: f64) -> f64 {
    1.0 / (1.0 + (TAU * time_s * frequency_hz).powi(2))
}

/// The integral of its density times a weight up to the cut-off.
fn integral(time_s: f64, cutoff_hz: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let step = cutoff_hz / STEPS as f64;
    (0..STEPS).map(|k| (k as f64 + 0.5) * step).map(|f| step * shape(time_s, f) * weight(f)).sum()
}

/// The time constant of noise whose neighbouring rows have this correlation; zero if white noise has as much.
fn correlation_time_s(correlation: f64, cutoff_hz: f64) -> f64 {
    let spacing_s = ROWS_PER_CUTOFF / cutoff_hz;
    let of = |time_s: f64| {
        integral(time_s, cutoff_hz, |f| (2.0 * PI * f * spacing_s).cos()) / integral(time_s, cutoff_hz, |_| 1.0)
    };
    if correlation.is_nan() || correlation <= of(0.0) {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, LONGEST * spacing_s);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if of(middle) < correlation { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use thetahat_estimation::signal::Decimator;
    use thetahat_ground::series::Series;

    fn row(joint: usize, rms: f64, autocorrelation: f64) -> JointResidual {
        JointResidual { joint, rms, autocorrelation, whiteness: None, normality: None, explained: None }
    }

    /// Noise that is drawn and goes through the parallel filter has the rows that it was made from.
    #[test]
    fn drawn_noise_has_the_rows_that_it_is_made_from() {
        let (rate, factor, samples) = (1000.0, 20, 400_000);
        let rows = [row(1, 0.5, 0.8), row(2, 1.5, 0.5), row(3, 0.2, 0.1)];
        let noise = torque_noise_of_rows(&rows, ROWS_PER_CUTOFF * rate / factor as f64, rate);
        let drawn = noise.spectrum.unwrap().draw(samples, rate, &mut ChaCha8Rng::seed_from_u64(3));
        let decimated: Series = Decimator::new(factor, samples).unwrap().decimate(&drawn).unwrap();
        for (c, row) in rows.iter().enumerate() {
            let y = decimated.channel(c);
            let mean_square = y.iter().map(|v| v * v).sum::<f64>() / y.len() as f64;
            let neighbours = y.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / y.len() as f64 / mean_square;
            let expected = row.autocorrelation.max(0.234);
            assert!((mean_square.sqrt() / row.rms - 1.0).abs() < 0.05, "{c}: {}", mean_square.sqrt());
            assert!((neighbours - expected).abs() < 0.05, "{c}: {neighbours}");
        }
    }
}
