//! The covariance of the intervals: the errors of each joint and recording are a stationary series of any spectrum.

use super::{Sandwich, block::Block, lagged::add_lagged_products, t_quantile};
use thetahat_ground::linear_algebra::Matrix;

/// A variance that is itself estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedVariance {
    /// The variance.
    pub variance: f64,
    /// Degrees of freedom: the number of independent rows that would give a variance of the same precision (Satterthwaite).
    pub freedom: f64,
}

/// Probability below the upper end of an interval of 95 %.
const UPPER: f64 = 0.975;
/// Passes of the correction for the fit's effect on the autocovariance of its residual; each leaves at most about a third of
/// the rest.
const PASSES: usize = 2;
/// Fewest degrees of freedom: with fewer an interval is meaningless.
const FEWEST_FREEDOM: f64 = 2.0;
/// Standard deviations from zero at which the errors of two joints count as correlated: one pair in a thousand by chance.
const CORRELATED: f64 = 3.29;

impl EstimatedVariance {
    /// Half the width of the 95 % confidence interval; `None` if the variance is not finite.
    #[must_use]
    pub fn half_width_95(&self) -> Option<f64> {
        t_quantile(UPPER, self.freedom).map(|t| t * self.variance.sqrt()).filter(|h| h.is_finite())
    }
}

impl Sandwich<'_> {
    /// For each parameter the variance that gives the wider interval: [`Sandwich::stationary`], or
    /// [`Sandwich::newey_west`] with as many degrees of freedom as there are rows.
    ///
    /// The first accounts for errors as slow as the recording allows, but assumes that their size does not depend on the motion;
    /// the second allows any size at any time, but uses few lags.
    #[must_use]
    pub fn robust(&self) -> Vec<EstimatedVariance> {
        let freedom = self.residual.len() as f64;
        let newey_west = self.newey_west().into_iter().map(|variance| EstimatedVariance { variance, freedom });
        let wider = |(a, b): (EstimatedVariance, EstimatedVariance)| {
            if a.half_width_95() >= b.half_width_95() { a } else { b }
        };
        self.stationary().into_iter().zip(newey_west).map(wider).collect()
    }

    /// Errors whose autocovariance `gamma(l)` is one for each joint and recording: `V = A^T Gamma A`.
    ///
    /// 1. `gamma(l)` is the residual's, tapered by Parzen's window up to the bandwidth `S = 2.6614 (alpha n)^(1/5)`,
    ///    `alpha = 4 r^2 / (1 - r)^4`, r the residual's correlation of neighbouring rows (D. Andrews,
    ///    "Heteroskedasticity and autocorrelation consistent covariance matrix estimation", 1991, (2.7), (6.2), (6.4));
    ///    at least `sqrt(n)`, at most `n / 3`.
    /// 2. The fit reduces its residual. The small-sample correction, in two passes, finds the autocovariance for which the
    ///    expectation `E rho rho^T = (I - X A^T) Gamma (I - A X^T)` agrees with the residual. A variance is never below the
    ///    uncorrected one.
    /// 3. Joints whose errors are significantly correlated at equal times add their cross-covariances; joints of different
    ///    recordings never do.
    /// 4. Errors that a motion repeats with itself add what their products in different periods say.
    /// 5. The degrees of freedom are Satterthwaite's, `2 V^2 / var(V)`, for the quadratic form V with a given bandwidth: for very
    ///    slow errors up to half too many.
    ///
    /// It does not account for errors whose size depends on the motion; [`Sandwich::newey_west`] does.
    #[must_use]
    pub fn stationary(&self) -> Vec<EstimatedVariance> {
        let leverage = self.leverage();
        let mut blocks: Vec<Block> =
            self.rows.blocks().iter().map(|b| Block::new(self, b.rows.clone(), &leverage)).collect();
        let correlations: Vec<Matrix> = blocks.iter().map(|b| b.influence_correlation(self.influence)).collect();
        let uncorrected = variances(&blocks, &correlations);
        for _ in 0..PASSES {
            self.correct(&mut blocks);
        }
        let corrected = variances(&blocks, &correlations);
        let mut own: Vec<f64> = uncorrected.iter().zip(corrected).map(|(u, c)| u.max(c)).collect();
        let spread = spreads(&blocks, &correlations);
        let freedom: Vec<f64> = own.iter().zip(spread).map(|(v, s)| freedom(*v, s, self.residual.len())).collect();
        let cross = self.cross_terms(&blocks);
        own.iter_mut().zip(cross).zip(uncorrected).for_each(|((v, c), least)| *v = (*v + c).max(least));
        let repeated = self.repeated(&blocks, &leverage);
        let most = repeated.as_ref().map_or(f64::INFINITY, |r| r.freedom);
        let added = repeated.map_or_else(|| vec![0.0; own.len()], |r| r.variances);
        let estimated = |((own, added), freedom): ((f64, f64), f64)| EstimatedVariance {
            variance: own + added,
            freedom: freedom.min(most),
        };
        own.into_iter().zip(added).zip(freedom).map(estimated).collect()
    }

    /// One pass: `gamma(l) = (r(l) - bias(l)) / (n - l)`, with r(l) the sums of lagged products of the residual and
    /// `bias(l) = sum_t x_t^T c_{t+l} + x_{t+l}^T c_t`, `c = V x / 2 - b`, `b = Gamma A` row by row.
    fn correct(&self, blocks: &mut [Block]) {
        let mut b = Matrix::zeros(self.influence.rows(), self.influence.columns());
        for i in 0..b.columns() {
            for block in blocks.iter() {
                block.times_covariance(self.influence.column(i), &mut b.column_mut(i)[block.rows.clone()]);
            }
        }
        let v = self.influence.transposed_times(&b);
        let vx = self.design.times_matrix(&v);
        let c = Matrix::from_fn(b.rows(), b.columns(), |k, i| 0.5 * vx.at(k, i) - b.at(k, i));
        blocks.iter_mut().for_each(|block| block.correct(self.design, &c));
    }

    /// Twice the covariance that each pair of correlated joints adds.
    fn cross_terms(&self, blocks: &[Block]) -> Vec<f64> {
        let mut terms = vec![0.0; self.influence.columns()];
        let recordings = self.rows.recordings();
        for (first, a) in blocks.iter().enumerate() {
            for b in blocks[first..].iter().skip(recordings).step_by(recordings) {
                if let Some(covariance) = self.cross_covariance(a, b) {
                    let term = |i: usize| 2.0 * cross_sum(&covariance, self.influence.column(i), a, b);
                    terms.iter_mut().enumerate().for_each(|(i, t)| *t += term(i));
                }
            }
        }
        terms
    }

    /// The tapered cross-covariance of two joints, with lag zero in the middle; `None` if it is not significant.
    fn cross_covariance(&self, a: &Block, b: &Block) -> Option<CrossCovariance> {
        let (x, y) = (&self.residual[a.rows.clone()], &self.residual[b.rows.clone()]);
        let window = if a.window.len() >= b.window.len() { &a.window } else { &b.window };
        // Rows that the masks leave in both.
        let both = a.counted_with(b);
        let lagged = |x: &[f64], y: &[f64]| {
            let mut sums = vec![0.0; window.len()];
            add_lagged_products(x, y, &mut sums);
            sums.iter().zip(window).map(|(s, w)| w * s / both).collect::<Vec<f64>>()
        };
        let later = lagged(x, y);
        // Of two uncorrelated series, n var(correlation) is the sum over all lags of the product of their correlations.
        let products = a.covariance.iter().zip(&b.covariance).map(|(a, b)| a * b);
        let sum: f64 = products.enumerate().map(|(l, p)| if l == 0 { p } else { 2.0 * p }).sum();
        let deviation = (sum.max(0.0) / both).sqrt();
        (later[0].abs() > CORRELATED * deviation).then(|| CrossCovariance { later, earlier: lagged(y, x) })
    }
}

/// Cross-covariance of two joints by lag.
struct CrossCovariance {
    /// `E e_a(t) e_b(t + l)`.
    later: Vec<f64>,
    /// `E e_a(t + l) e_b(t)`.
    earlier: Vec<f64>,
}

/// `a^T Gamma_ab b` for a parameter's influence in two blocks.
fn cross_sum(covariance: &CrossCovariance, influence: &[f64], a: &Block, b: &Block) -> f64 {
    let (x, y) = (a.part_of(influence), b.part_of(influence));
    let sum = |covariance: &[f64], x: &[f64], y: &[f64]| {
        let mut sums = vec![0.0; covariance.len()];
        add_lagged_products(x, y, &mut sums);
        sums.iter().zip(covariance).map(|(s, c)| s * c).collect::<Vec<f64>>()
    };
    let (later, earlier) = (sum(&covariance.later, &x, &y), sum(&covariance.earlier, &y, &x));
    later.iter().sum::<f64>() + earlier.iter().skip(1).sum::<f64>()
}

/// The variance of each parameter, over all blocks.
fn variances(blocks: &[Block], correlations: &[Matrix]) -> Vec<f64> {
    sum_over_blocks(blocks, correlations, Block::variance)
}

fn spreads(blocks: &[Block], correlations: &[Matrix]) -> Vec<f64> {
    sum_over_blocks(blocks, correlations, Block::spread)
}

fn sum_over_blocks(blocks: &[Block], correlations: &[Matrix], of: fn(&Block, &[f64]) -> f64) -> Vec<f64> {
    let parameters = correlations.first().map_or(0, Matrix::columns);
    let sum = |i: usize| blocks.iter().zip(correlations).map(|(b, c)| of(b, c.column(i))).sum();
    (0..parameters).map(sum).collect()
}

/// Satterthwaite's degrees of freedom, not more than there are rows.
fn freedom(variance: f64, spread: f64, rows: usize) -> f64 {
    let freedom = variance * variance / spread;
    if freedom.is_finite() { freedom.clamp(FEWEST_FREEDOM, rows as f64) } else { rows as f64 }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::regression::RowLayout;
    use thetahat_ground::linear_algebra::PivotedQr;

    const ROWS: usize = 60;
    /// Autocovariance of each joint, a moving average of the second order.
    const GAMMA: [[f64; 3]; 2] = [[3.0, 1.5, 0.4], [0.5, -0.2, 0.1]];

    fn design() -> Matrix {
        let value = |k: usize, i: usize| ((0.05 + 0.11 * i as f64) * k as f64 + (i * i) as f64).cos();
        Matrix::from_fn(2 * ROWS, 5, |k, i| if k >= ROWS && i == 4 { 0.0 } else { value(k, i) })
    }

    fn gamma(k: usize, l: usize) -> f64 {
        let same_joint = k / ROWS == l / ROWS;
        if same_joint { GAMMA[k / ROWS].get(k.abs_diff(l)).copied().unwrap_or(0.0) } else { 0.0 }
    }

    /// The expected lagged products of the residual, by dense matrices.
    fn expected_products(x: &Matrix, a: &Matrix, errors: &Matrix, rows: std::ops::Range<usize>) -> Vec<f64> {
        let n = 2 * ROWS;
        let hat = x.times_matrix(&a.transpose());
        let m = Matrix::from_fn(n, n, |k, l| f64::from(k == l) - hat.at(k, l));
        let covariance = m.times_matrix(errors).times_matrix(&m.transpose());
        (0..3).map(|l| rows.clone().filter(|k| k + l < rows.end).map(|k| covariance.at(k, k + l)).sum()).collect()
    }

    /// A third of the first joint's rows and one row of the second are left out, and half of the rows next to them.
    fn shares() -> Vec<f64> {
        let share = |k: usize| match k {
            20..=39 | 90 => 0.0,
            19 | 40 | 89 | 91 => 0.5,
            _ => 1.0,
        };
        (0..2 * ROWS).map(share).collect()
    }

    #[test]
    fn the_correction_recovers_the_autocovariance_from_the_expected_residual() {
        recovers(None, 1e-5);
    }

    #[test]
    fn rows_that_a_mask_leaves_in_part_show_the_same_autocovariance() {
        recovers(Some(shares()), 1e-4);
    }

    fn recovers(shares: Option<Vec<f64>>, tolerance: f64) {
        let part = |k: usize| shares.as_ref().map_or(1.0, |shares| shares[k]);
        let full = design();
        let x = Matrix::from_fn(full.rows(), full.columns(), |k, i| part(k) * full.at(k, i));
        let errors = Matrix::from_fn(2 * ROWS, 2 * ROWS, |k, l| part(k) * part(l) * gamma(k, l));
        let a = x.times_matrix(&PivotedQr::new(&x).inverse_gram());
        let rows = RowLayout::new(2, &[ROWS]).with_shares(shares.clone());
        let residual = vec![1.0; 2 * ROWS];
        let sandwich = Sandwich { design: &x, influence: &a, residual: &residual, rows: &rows };
        let leverage = sandwich.leverage();
        let mut blocks: Vec<Block> =
            rows.blocks().iter().map(|b| Block::new(&sandwich, b.rows.clone(), &leverage)).collect();
        for block in &mut blocks {
            block.observed = expected_products(&x, &a, &errors, block.rows.clone());
            block.window = vec![1.0; 3];
            block.covariance = block.observed.iter().zip(&block.pairs).map(|(r, n)| r / n).collect();
        }
        let mut differences = Vec::new();
        for _ in 0..16 {
            let pairs = blocks.iter().flat_map(|b| &b.covariance).zip(GAMMA.as_flattened());
            differences.push(pairs.map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max));
            sandwich.correct(&mut blocks);
        }
        let [first, third, last] = [0, 2, 15].map(|i| differences[i]);
        assert!(first > 0.05 && third < 0.2 * first && last < tolerance, "{differences:?}");
        let exact = a.transpose().times_matrix(&errors).times_matrix(&a);
        let correlations: Vec<Matrix> = blocks.iter().map(|b| b.influence_correlation(&a)).collect();
        for (i, variance) in variances(&blocks, &correlations).into_iter().enumerate() {
            assert!((variance / exact.at(i, i) - 1.0).abs() < 1e-3, "parameter {i}");
        }
    }

    const LENGTH: usize = 400;

    /// An autoregression of the first order with normal innovations of variance one.
    fn autoregression(coefficient: f64, seed: u64) -> Vec<f64> {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut last = 0.0;
        let mut next = || {
            let innovation: f64 = StandardNormal.sample(&mut generator);
            last = coefficient * last + innovation;
            last
        };
        (0..10 * LENGTH).for_each(|_| _ = next());
        (0..LENGTH).map(|_| next()).collect()
    }

    fn minus_mean(errors: &[f64]) -> Vec<f64> {
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        errors.iter().map(|e| e - mean).collect()
    }

    /// The variance of the mean of all rows, from the residual that the mean leaves.
    fn of_mean(errors: &[f64], rows: &RowLayout) -> EstimatedVariance {
        let n = errors.len();
        let (design, influence) = (Matrix::from_fn(n, 1, |_, _| 1.0), Matrix::from_fn(n, 1, |_, _| 1.0 / n as f64));
        Sandwich { design: &design, influence: &influence, residual: &minus_mean(errors), rows }.stationary()[0]
    }

    /// Results for many series.
    struct ManySeries {
        /// Mean of the estimated variances.
        variance: f64,
        /// Mean of the stated degrees of freedom.
        stated_freedom: f64,
        /// The degrees of freedom that correspond to the spread of the variances.
        observed_freedom: f64,
    }

    fn of_many(coefficient: f64) -> ManySeries {
        let rows = RowLayout::new(1, &[LENGTH]);
        let found: Vec<_> = (0..600).map(|seed| of_mean(&autoregression(coefficient, seed), &rows)).collect();
        let mean = |f: &dyn Fn(&EstimatedVariance) -> f64| found.iter().map(f).sum::<f64>() / found.len() as f64;
        let variance = mean(&|v| v.variance);
        let spread = mean(&|v| (v.variance - variance).powi(2));
        let observed_freedom = 2.0 * variance * variance / spread;
        ManySeries { variance, stated_freedom: mean(&|v| v.freedom), observed_freedom }
    }

    /// The part of the variance of a mean, `sum gamma(l) / n`, that the tapered autocovariance of an autoregression keeps.
    fn kept_by_the_window(r: f64) -> f64 {
        let n = LENGTH as f64;
        let bandwidth = (2.6614 * (4.0 * r * r / (1.0 - r).powi(4) * n).powf(0.2)).max(n.sqrt());
        let window = |x: f64| if x <= 0.5 { 1.0 - 6.0 * x * x + 6.0 * x * x * x } else { 2.0 * (1.0 - x).powi(3) };
        let both_ways = |l: i32| if l == 0 { 1.0 } else { 2.0 * r.powi(l) };
        let kept: f64 = (0..bandwidth as i32).map(|l| window(f64::from(l) / bandwidth) * both_ways(l)).sum();
        kept * (1.0 - r) / (1.0 + r)
    }

    #[test]
    fn the_variance_of_a_mean_accounts_for_slow_errors_and_states_its_degrees_of_freedom() {
        for r in [0.0, 0.5, 0.8] {
            let ManySeries { variance, stated_freedom: stated, observed_freedom: observed } = of_many(r);
            let ratio = variance * LENGTH as f64 * (1.0 - r) * (1.0 - r) / kept_by_the_window(r);
            assert!((ratio - 1.0).abs() < 0.04, "{r}: {ratio} of the variance");
            // The stated value assumes a given bandwidth; it is chosen from the residual.
            assert!(
                (0.7..=1.6).contains(&(stated / observed)),
                "{r}: {stated} degrees of freedom, observed {observed}"
            );
        }
    }

    /// With equal errors in both joints, the mean over both has the variance of the mean over one: each joint adds a
    /// quarter of it, and their covariance adds half. The fit of one mean to two joints reduces each
    /// joint's variance by `c / 2`; the fit to one joint reduces it by c, the sum of the window over n. The covariance of the joints is
    /// not corrected for this.
    #[test]
    fn joints_with_equal_errors_add_their_covariance() {
        let first = minus_mean(&autoregression(0.0, 1));
        let together = [first.clone(), first.clone()].concat();
        let apart: Vec<f64> = first.iter().copied().chain(first.iter().map(|e| -e)).collect();
        let rows = RowLayout::new(2, &[LENGTH]);
        let alone = of_mean(&first, &RowLayout::new(1, &[LENGTH])).variance;
        let [together, apart] = [together, apart].map(|e| of_mean(&e, &rows).variance / alone);
        let bandwidth = (LENGTH as f64).sqrt();
        let c = 0.75 * bandwidth / LENGTH as f64;
        let expected = (0.5 * (1.0 + 0.5 * c) + 0.5) / (1.0 + c);
        assert!((together - expected).abs() < 0.005, "{together}, not {expected}");
        let expected = 0.5 / (1.0 + c);
        assert!((apart - expected).abs() < 0.005, "never below the joints alone, uncorrected: {apart}, not {expected}");
    }

    /// The errors of two joints are correlated one row apart in one direction only, so that their order decides the sum.
    #[test]
    fn the_covariance_of_two_joints_depends_on_their_order() {
        let n = 12;
        let rows = RowLayout::new(2, &[n]);
        let influence = Matrix::from_fn(2 * n, 1, |k, _| (0.3 * k as f64).sin() + 0.1 * k as f64);
        let (design, residual) = (influence.clone(), vec![1.0; 2 * n]);
        let sandwich = Sandwich { design: &design, influence: &influence, residual: &residual, rows: &rows };
        let blocks: Vec<Block> =
            rows.blocks().iter().map(|b| Block::new(&sandwich, b.rows.clone(), &vec![0.0; 2 * n])).collect();
        let covariance = CrossCovariance { later: vec![0.5, 2.0], earlier: vec![0.5, -1.0] };
        let of = |lag: isize| match lag {
            0 => 0.5,
            1 => 2.0,
            -1 => -1.0,
            _ => 0.0,
        };
        let a = influence.column(0);
        let dense: f64 = (0..n)
            .flat_map(|t| (0..n).map(move |s| (t, s)))
            .map(|(t, s)| a[t] * a[n + s] * of(s as isize - t as isize))
            .sum();
        let found = cross_sum(&covariance, a, &blocks[0], &blocks[1]);
        assert!((found - dense).abs() < 1e-12, "{found}, not {dense}");
    }

    #[test]
    fn an_exact_fit_has_no_variance() {
        let found = of_mean(&[0.0; 40], &RowLayout::new(1, &[40]));
        assert_eq!((found.variance, found.freedom), (0.0, 40.0));
    }
}
