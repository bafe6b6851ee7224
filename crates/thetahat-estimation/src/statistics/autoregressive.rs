use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Part of a process's first weight below which later weights are left out.
const FORGOTTEN: f64 = 1e-6;
/// Longest memory that is considered, samples.
const LONGEST_MEMORY: usize = 2000;
/// Smallest `1 - sum a`: the long-run variance of a process closer to a random walk cannot be estimated from its rows.
const SMALLEST_GAIN: f64 = 0.02;

/// An autoregressive process, `e_k = sum_i a_i e_(k-i) + w_k` with white `w`.
#[derive(Debug, Clone, PartialEq)]
pub struct Autoregressive {
    /// `a_1 ...`.
    pub coefficients: Vec<f64>,
    /// Variance of `w`.
    pub innovation_variance: f64,
}

impl Autoregressive {
    /// Estimates a process by the Yule-Walker equations, of the order up to `highest` with the smallest Bayesian
    /// information criterion `n ln v + order ln n` (G. E. P. Box, G. M. Jenkins, "Time series analysis", 1970; G. Schwarz,
    /// "Estimating the dimension of a model", 1978).
    ///
    /// Products never cross from one segment to the next; the mean is assumed to be zero. The process is stable.
    #[must_use]
    pub fn fit(segments: &[&[f64]], highest: usize) -> Self {
        let rows: usize = segments.iter().map(|s| s.len()).sum();
        let n = rows as f64;
        let criterion = |p: &Self| n * p.innovation_variance.ln() + p.coefficients.len() as f64 * n.ln();
        let orders = levinson_durbin(&autocovariances(segments, highest));
        let best = orders.into_iter().min_by(|a, b| criterion(a).total_cmp(&criterion(b)));
        best.unwrap_or(Self { coefficients: Vec::new(), innovation_variance: 0.0 })
    }

    /// The same of a given order, or of a lower one if the series is a sum of few sinusoids.
    #[must_use]
    pub fn fit_order(segments: &[&[f64]], order: usize) -> Self {
        let mut orders = levinson_durbin(&autocovariances(segments, order));
        orders.pop().unwrap_or(Self { coefficients: Vec::new(), innovation_variance: 0.0 })
    }

    /// The weights of past innovations: `e_k = sum_i psi_i w_(k-i)`, `psi_0 = 1`.
    #[must_use]
    pub fn weights(&self) -> Vec<f64> {
        let mut weights = vec![1.0];
        let mut small = 0;
        while weights.len() < LONGEST_MEMORY && small <= self.coefficients.len() {
            let past = weights.iter().rev().zip(&self.coefficients);
            let next: f64 = past.map(|(w, a)| w * a).sum();
            small = if next.abs() < FORGOTTEN { small + 1 } else { 0 };
            weights.push(next);
        }
        weights
    }

    /// The covariance of rows `k` apart, for `k` from zero until it vanishes.
    #[must_use]
    pub fn autocovariance(&self) -> Vec<f64> {
        let weights = self.weights();
        let product = |k: usize| -> f64 { weights.iter().zip(&weights[k..]).map(|(a, b)| a * b).sum() };
        (0..weights.len()).map(|k| self.innovation_variance * product(k)).collect()
    }

    /// Variance of the mean of many rows, times their number: `v / (1 - sum a)^2`.
    #[must_use]
    pub fn long_run_variance(&self) -> f64 {
        let gain = (1.0 - self.coefficients.iter().sum::<f64>()).max(SMALLEST_GAIN);
        self.innovation_variance / (gain * gain)
    }

    /// Draws a series of normal rows; `memory` rows are drawn before the first, so that the series is stationary.
    pub fn draw(&self, memory: usize, rng: &mut impl Rng, out: &mut [f64]) {
        let deviation = self.innovation_variance.sqrt();
        let order = self.coefficients.len();
        let mut past = vec![0.0; order];
        for k in 0..memory + out.len() {
            let noise: f64 = StandardNormal.sample(rng);
            let value = deviation * noise + past.iter().zip(&self.coefficients).map(|(e, a)| e * a).sum::<f64>();
            if order > 0 {
                past.rotate_right(1);
                past[0] = value;
            }
            if k >= memory {
                out[k - memory] = value;
            }
        }
    }
}

/// `r_k = sum e_i e_(i+k) / n` for `k` from zero to `highest`.
fn autocovariances(segments: &[&[f64]], highest: usize) -> Vec<f64> {
    let rows: usize = segments.iter().map(|s| s.len()).sum();
    let longest = segments.iter().map(|s| s.len()).max().unwrap_or(0);
    let product = |s: &[f64], k: usize| -> f64 { s.iter().zip(s.get(k..).unwrap_or(&[])).map(|(a, b)| a * b).sum() };
    let at = |k: usize| segments.iter().map(|s| product(s, k)).sum::<f64>() / rows.max(1) as f64;
    (0..=highest.min(longest.saturating_sub(1))).map(at).collect()
}

/// The processes of order 0, 1, ... that have these covariances, by the recursion of Levinson and Durbin.
fn levinson_durbin(covariances: &[f64]) -> Vec<Autoregressive> {
    let Some((&first, later)) = covariances.split_first() else { return Vec::new() };
    let mut process = Autoregressive { coefficients: Vec::new(), innovation_variance: first };
    let mut orders = vec![process.clone()];
    for (order, covariance) in later.iter().enumerate() {
        let explained: f64 =
            process.coefficients.iter().zip(covariances[1..=order].iter().rev()).map(|(a, r)| a * r).sum();
        let reflection = (covariance - explained) / process.innovation_variance;
        if reflection.is_nan() || reflection.abs() >= 1.0 {
            break;
        }
        let reversed: Vec<f64> = process.coefficients.iter().rev().copied().collect();
        process.coefficients.iter_mut().zip(reversed).for_each(|(a, b)| *a -= reflection * b);
        process.coefficients.push(reflection);
        process.innovation_variance *= 1.0 - reflection * reflection;
        orders.push(process.clone());
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    fn close(found: &[f64], expected: &[f64], tolerance: f64) {
        assert!(found.len() >= expected.len());
        for (f, e) in found.iter().zip(expected) {
            assert!((f - e).abs() < tolerance, "{found:?}, expected {expected:?}");
        }
    }

    /// statsmodels 0.15.0, `yule_walker(x - mean, order=3, method='mle', demean=False)`.
    #[test]
    fn the_coefficients_are_those_of_statsmodels() {
        let mut x: Vec<f64> = (0..60).map(f64::from).map(|k| (0.7 * k).sin() + 0.5 * (0.31 * k * k).cos()).collect();
        let mean = x.iter().sum::<f64>() / 60.0;
        x.iter_mut().for_each(|v| *v -= mean);
        let process = Autoregressive::fit_order(&[&x], 3);
        close(
            &process.coefficients,
            &[0.646_483_568_985_238_7, 0.133_417_531_591_577_4, -0.553_833_198_727_720_6],
            1e-12,
        );
        assert!((process.innovation_variance - 0.253_429_905_608_650_25).abs() < 1e-12);
    }

    /// statsmodels 0.15.0, `ArmaProcess([1, -0.5, -0.3], [1]).acovf(5)`.
    #[test]
    fn the_autocovariance_is_that_of_statsmodels() {
        let process = Autoregressive { coefficients: vec![0.5, 0.3], innovation_variance: 1.0 };
        let expected = [2.243_589_743_59, 1.602_564_102_564, 1.474_358_974_359, 1.217_948_717_949, 1.051_282_051_282];
        close(&process.autocovariance(), &expected, 1e-4);
    }

    #[test]
    fn a_drawn_series_has_the_process_that_drew_it() {
        let process = Autoregressive { coefficients: vec![0.5, 0.3], innovation_variance: 4.0 };
        let mut x = vec![0.0; 40_000];
        process.draw(100, &mut rand_chacha::ChaCha8Rng::seed_from_u64(7), &mut x);
        let (a, b) = x.split_at(15_000);
        let found = Autoregressive::fit(&[a, b], 8);
        close(&found.coefficients, &[0.5, 0.3], 0.02);
        assert!((found.innovation_variance / 4.0 - 1.0).abs() < 0.03);
        assert!((found.long_run_variance() / 100.0 - 1.0).abs() < 0.1, "{}", found.long_run_variance());
    }

    #[test]
    fn nothing_gives_a_process_without_noise() {
        assert_eq!(Autoregressive::fit(&[], 3).innovation_variance, 0.0);
        assert_eq!(Autoregressive::fit(&[&[0.0; 10]], 3).coefficients, Vec::<f64>::new());
    }
}
