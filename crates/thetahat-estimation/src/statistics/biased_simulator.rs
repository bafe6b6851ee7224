//! Tests whether DIDIM's simulator agrees with the recorded loop: DIDIM against IV with the same instruments and weights.
//!
//! | letter | word |
//! | --- | --- |
//! | `X`, `Z`, `y` | observation matrices of the measured and the simulated motion, and torques, whitened alike |
//! | `Q` | orthonormal basis of Z |
//! | `s` | `(X - Z) theta_IV`: difference of the predictions of measured and simulated motion |
//! | `d` | `theta_DIDIM - theta_IV = Z^+ s`, exactly |
//! | `u` | `s - Z d`: the part of `s` that no parameters explain |
//!
//! The noise of y cancels in `d`: with one Z and one set of weights, `theta_DIDIM = Z^+ X theta_IV`. This is a regression of `s`
//! on Z, so the test compares its coefficients `d` with their noise. The noise `u` has the autocorrelation of the modelling
//! errors that both motions share.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{
    RowNoise,
    wu_hausman::{IvEstimate, without},
};
use crate::regression::RowLayout;
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, norm};

/// DIDIM against IV.
#[derive(Debug, Clone)]
pub struct SimulatorComparison {
    q: Matrix,
    /// `Q^T Z`.
    projected: Matrix,
    /// `Q^T s`.
    delta: Vec<f64>,
    noise: RowNoise,
    /// Covariance of `Q^T u` by joint, and of all.
    covariances: Vec<Matrix>,
    covariance: Matrix,
    /// `theta_DIDIM - theta_IV`.
    pub difference: Vec<f64>,
    /// Standard deviations of IV with the autocorrelation of its residual.
    pub iv_deviation: Vec<f64>,
    /// Average difference in standard deviations of IV, `sqrt(d^T V_IV^-1 d / b)`.
    pub average_difference: f64,
    /// `(Q^T s)^T W^-1 Q^T s` with the covariance W of `Q^T u`.
    pub statistic: f64,
    /// `|y - Z theta_DIDIM| / |y - X theta_IV|`: above one if the simulated motion explains the torques worse than the measured
    /// one.
    pub residual_ratio: f64,
    /// Squares of the torques `Z d` of the difference, by joint.
    pub joint_squares: Vec<f64>,
}

/// The part of a difference that one bias of the simulator explains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BiasFit {
    /// Change of the simulator's setting that would undo the difference.
    pub correction: f64,
    /// Its standard deviation, increased by the part that the bias does not explain.
    pub standard_deviation: f64,
    /// Part of the statistic that it explains, from 0 to 1.
    pub explained: f64,
}

impl SimulatorComparison {
    /// Compares the two estimates with instruments Z. `None` if one of them does not exist, or X is Z.
    #[must_use]
    pub fn new(z: &Matrix, x: &Matrix, y: &[f64], layout: &RowLayout) -> Option<Self> {
        let q = PivotedQr::new(z).thin_q();
        let iv = IvEstimate::with_basis(&q, x, y, layout)?;
        let s = x.plus(z, -1.0).times(&iv.theta);
        let delta = q.transpose_times(&s);
        let projected = q.transposed_times(z);
        let difference = PivotedQr::new(&projected).solve(&delta);
        let u = without(&q, &s);
        let noise = RowNoise::of(&u, layout);
        let covariances = noise.covariances(&q);
        let covariance = sum(&covariances, &vec![1.0; covariances.len()]);
        Some(Self {
            statistic: covariance.inverse_quadratic_form(&delta)?,
            average_difference: iv.average(&difference)?,
            iv_deviation: iv.deviations(),
            residual_ratio: norm(&sum_of(&iv.residual, &u)) / norm(&iv.residual),
            joint_squares: layout.squares(&z.times(&difference)),
            q,
            projected,
            delta,
            noise,
            covariances,
            covariance,
            difference,
        })
    }

    /// The statistics of `draws` simulated recordings with the same Z and noise like `u`, but without bias: smallest first.
    ///
    /// Each draws `u`, estimates its `d` and its noise again, and computes the statistic with the covariance scaled joint by joint
    /// to that noise. The same seed gives the same numbers. A draw without a statistic counts as infinite.
    #[must_use]
    pub fn bootstrap(&self, draws: usize, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let memory = self.noise.memory();
        let mut u = vec![0.0; self.q.rows()];
        let mut statistics: Vec<f64> = Vec::with_capacity(draws);
        for _ in 0..draws {
            self.noise.draw(&memory, &mut rng, &mut u);
            statistics.push(self.statistic_of(&u).unwrap_or(f64::INFINITY));
        }
        statistics.sort_by(f64::total_cmp);
        statistics
    }

    fn statistic_of(&self, u: &[f64]) -> Option<f64> {
        let delta = self.q.transpose_times(u);
        let explained = self.q.times(&delta);
        let left: Vec<f64> = u.iter().zip(explained).map(|(u, e)| u - e).collect();
        let scales = self.noise.relative_long_run_variances(&left);
        sum(&self.covariances, &scales).inverse_quadratic_form(&delta)
    }

    /// The part of the difference that a bias explains, from the change of `theta_DIDIM` per unit of the simulator's setting: the
    /// correction c that makes `theta_DIDIM + c change` closest to `theta_IV`, by generalised least squares.
    ///
    /// If the rest exceeds noise, the standard deviation grows with it (Birge ratio).
    #[must_use]
    pub fn explain(&self, change: &[f64]) -> Option<BiasFit> {
        let direction = self.projected.times(change);
        let weighted = self.covariance.inverse_times(&direction)?;
        let dot = |a: &[f64]| -> f64 { a.iter().zip(&weighted).map(|(a, w)| a * w).sum() };
        let (information, along) = (dot(&direction), dot(&self.delta));
        let explained = along * along / information / self.statistic;
        let left = (1.0 - explained) * self.statistic / (self.delta.len().max(2) - 1) as f64;
        let fit = BiasFit {
            correction: -along / information,
            standard_deviation: (left.max(1.0) / information).sqrt(),
            explained,
        };
        (information > 0.0 && fit.correction.is_finite()).then_some(fit)
    }
}

fn sum_of(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn sum(matrices: &[Matrix], scales: &[f64]) -> Matrix {
    let columns = matrices.first().map_or(0, Matrix::columns);
    let zero = Matrix::zeros(columns, columns);
    matrices.iter().zip(scales).fold(zero, |sum, (m, scale)| sum.plus(m, *scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    const ROWS: usize = 300;
    const THETA: [f64; 3] = [2.0, -1.0, 0.5];

    fn layout() -> RowLayout {
        RowLayout::new(2, &[150])
    }

    fn motion(scale: f64) -> Matrix {
        Matrix::from_fn(ROWS, 3, |k, j| {
            let t = 0.05 * (k % 150) as f64;
            [scale * (1.3 * t).sin(), scale * (2.1 * t + 0.4).cos(), (3.7 * t).sin().signum()][j]
        })
    }

    /// Rows of autocorrelated noise.
    fn coloured(rng: &mut impl Rng, size: f64) -> Vec<f64> {
        let mut e = vec![0.0; ROWS];
        let process = super::super::Autoregressive { coefficients: vec![0.5], innovation_variance: size * size };
        process.draw(50, rng, &mut e);
        e
    }

    /// A simulator with `factor` of the true amplitudes, and noise in X and y.
    fn example(factor: f64, seed: u64) -> SimulatorComparison {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut x = motion(1.0);
        for c in 0..2 {
            let noise = coloured(&mut rng, 0.02);
            x.column_mut(c).iter_mut().zip(noise).for_each(|(x, e)| *x += e);
        }
        let noise = coloured(&mut rng, 0.2);
        let y: Vec<f64> = motion(1.0).times(&THETA).iter().zip(noise).map(|(t, e)| t + e).collect();
        SimulatorComparison::new(&motion(factor), &x, &y, &layout()).unwrap()
    }

    #[test]
    fn the_difference_is_that_of_the_two_estimators() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let y: Vec<f64> = motion(1.0).times(&THETA).iter().zip(coloured(&mut rng, 0.2)).map(|(t, e)| t + e).collect();
        let (z, x) = (motion(1.1), motion(1.0));
        let compared = SimulatorComparison::new(&z, &x.plus(&z, 0.01), &y, &layout()).unwrap();
        let didim = PivotedQr::new(&z).solve(&y);
        let iv = IvEstimate::with_basis(&PivotedQr::new(&z).thin_q(), &x.plus(&z, 0.01), &y, &layout()).unwrap().theta;
        let residual =
            |a: &Matrix, theta: &[f64]| norm(&a.times(theta).iter().zip(&y).map(|(p, y)| y - p).collect::<Vec<_>>());
        let ratio = residual(&z, &didim) / residual(&x.plus(&z, 0.01), &iv);
        assert!((compared.residual_ratio - ratio).abs() < 1e-12);
        for (d, (a, b)) in compared.difference.iter().zip(didim.iter().zip(&iv)) {
            assert!((d - (a - b)).abs() < 1e-12);
        }
    }

    /// The noise is estimated again in each draw, so that its size does not matter.
    #[test]
    fn a_draw_is_judged_by_its_own_noise() {
        let compared = example(1.0, 2);
        let u = coloured(&mut ChaCha8Rng::seed_from_u64(11), 0.1);
        let louder: Vec<f64> = u.iter().map(|u| 10.0 * u).collect();
        let [one, ten] = [&u, &louder].map(|u| compared.statistic_of(u).unwrap());
        assert!((ten / one - 1.0).abs() < 1e-9, "{one} {ten}");
    }

    #[test]
    fn without_bias_it_rejects_at_the_nominal_rate() {
        let rejects = |seed: u64| {
            let compared = example(1.0, seed);
            let statistics = compared.bootstrap(99, 1);
            compared.statistic > statistics[94]
        };
        let rejected = (0..200).filter(|&seed| rejects(seed)).count();
        // Binomial with p = 0.05: 2 to 20 of 200 hold all but 1 in 1000.
        assert!((2..=20).contains(&rejected), "{rejected} of 200");
    }

    #[test]
    fn a_bias_is_found_and_measured() {
        let compared = example(1.1, 1);
        assert!(compared.statistic > 10.0 * compared.bootstrap(99, 1)[94], "{}", compared.statistic);
        // theta of the first two columns is proportional to one over the simulator's factor.
        let change = [-THETA[0] / 1.1 / 1.1, -THETA[1] / 1.1 / 1.1, 0.0];
        let fit = compared.explain(&change).unwrap();
        let simulated = 1.1 + fit.correction;
        assert!((simulated - 1.0).abs() < 0.02, "{fit:?}");
        assert!(fit.explained > 0.95 && fit.standard_deviation < 0.02, "{fit:?}");
    }
}
