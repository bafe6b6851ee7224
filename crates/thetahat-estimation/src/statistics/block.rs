use std::{borrow::Cow, ops::Range};

use super::{
    Sandwich,
    lagged::{add_lagged_products, convolve},
    sandwich::squares,
};
use thetahat_ground::linear_algebra::Matrix;

/// Largest bandwidth as part of a block's rows.
const LARGEST_BANDWIDTH: f64 = 1.0 / 3.0;

/// The error of one joint in one recording.
pub(super) struct Block {
    pub(super) rows: Range<usize>,
    /// The part of each row that a mask leaves, which multiplies its stationary error.
    shares: Option<Vec<f64>>,
    /// `sum_t m(t) m(t + l)` of these parts m, by lag; `n - l` without a mask.
    pub(super) pairs: Vec<f64>,
    /// Columns of X that are not zero in this block.
    pub(super) acting: Vec<usize>,
    /// Parzen's window by lag.
    pub(super) window: Vec<f64>,
    /// Sums of lagged products of the residual.
    pub(super) observed: Vec<f64>,
    /// gamma(l), tapered.
    pub(super) covariance: Vec<f64>,
}

impl Block {
    pub(super) fn new(sandwich: &Sandwich<'_>, rows: Range<usize>, leverage: &[f64]) -> Self {
        let residual = &sandwich.residual[rows.clone()];
        let window = parzen(bandwidth(residual), residual.len());
        let mut observed = vec![0.0; window.len()];
        add_lagged_products(residual, residual, &mut observed);
        let shares = sandwich.rows.shares(rows.clone()).map(<[f64]>::to_vec);
        let pairs = pairs(shares.as_deref(), residual.len(), window.len());
        let counted = sandwich.rows.counted(rows.clone()).max(1.0);
        let freedom = (counted - leverage[rows.clone()].iter().sum::<f64>()).max(1.0);
        // All lags have the same divisor, apart from the mask, so that the result is the autocovariance of a series.
        let left = |l: usize| pairs[l] / counted * residual.len() as f64 / (residual.len() - l) as f64;
        let covariance = (0..window.len()).map(|l| window[l] * observed[l] / (freedom * left(l))).collect();
        let acts = |i: &usize| sandwich.design.column(*i)[rows.clone()].iter().any(|x| *x != 0.0);
        let acting = (0..sandwich.design.columns()).filter(acts).collect();
        Self { rows, acting, shares, pairs, window, observed, covariance }
    }

    /// The rows of a column of A in this block, each times the part of it that a mask leaves.
    pub(super) fn part_of<'a>(&self, influence: &'a [f64]) -> Cow<'a, [f64]> {
        let own = &influence[self.rows.clone()];
        match &self.shares {
            Some(shares) => own.iter().zip(shares).map(|(a, m)| a * m).collect(),
            None => Cow::Borrowed(own),
        }
    }

    /// The number of rows that the masks leave in both blocks, `sum_t m_a(t) m_b(t)`.
    pub(super) fn counted_with(&self, other: &Self) -> f64 {
        match (&self.shares, &other.shares) {
            (Some(a), Some(b)) => a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>().max(1.0),
            (Some(_), None) | (None, Some(_)) | (None, None) => self.rows.len() as f64,
        }
    }

    /// `sum_t a(t) a(t + l)` of each column of A: lags by parameters.
    pub(super) fn influence_correlation(&self, influence: &Matrix) -> Matrix {
        let mut sums = Matrix::zeros(self.window.len(), influence.columns());
        for i in 0..influence.columns() {
            let a = self.part_of(influence.column(i));
            add_lagged_products(&a, &a, sums.column_mut(i));
        }
        sums
    }

    /// `Gamma a` of a column of A, in the rows of the block.
    pub(super) fn times_covariance(&self, influence: &[f64], out: &mut [f64]) {
        convolve(&self.covariance, &self.part_of(influence), out);
        if let Some(shares) = &self.shares {
            out.iter_mut().zip(shares).for_each(|(o, m)| *o *= m);
        }
    }

    pub(super) fn correct(&mut self, design: &Matrix, c: &Matrix) {
        let mut bias = vec![0.0; self.window.len()];
        for &i in &self.acting {
            let (x, c) = (&design.column(i)[self.rows.clone()], &c.column(i)[self.rows.clone()]);
            add_lagged_products(x, c, &mut bias);
            add_lagged_products(c, x, &mut bias);
        }
        let corrected = |l: usize| self.window[l] * (self.observed[l] - bias[l]) / self.pairs[l];
        self.covariance = (0..bias.len()).map(corrected).collect();
    }

    /// `a^T Gamma a` from the lagged products of a.
    pub(super) fn variance(&self, correlation: &[f64]) -> f64 {
        let both_ways: f64 = correlation.iter().zip(&self.covariance).skip(1).map(|(a, g)| a * g).sum();
        correlation.first().zip(self.covariance.first()).map_or(0.0, |(a, g)| a * g) + 2.0 * both_ways
    }

    /// Half the variance of [`Block::variance`], a quadratic form in the residual: the sum of squares of the window times the
    /// lagged products of a, convolved with gamma, divided by n.
    pub(super) fn spread(&self, correlation: &[f64]) -> f64 {
        let tapered: Vec<f64> = correlation.iter().zip(&self.window).map(|(a, w)| a * w).collect();
        let lags = tapered.len();
        let both_sides: Vec<f64> = tapered.iter().skip(1).rev().chain(&tapered).copied().collect();
        let mut padded = vec![0.0; both_sides.len() + 2 * (lags - 1)];
        padded[lags - 1..][..both_sides.len()].copy_from_slice(&both_sides);
        let mut convolved = vec![0.0; padded.len()];
        convolve(&self.covariance, &padded, &mut convolved);
        squares(&convolved) / self.pairs.first().copied().unwrap_or(1.0)
    }
}

/// `sum_t m(t) m(t + l)` of the parts m that a mask leaves of rows; `n - l` without a mask. At least one: if a mask leaves no
/// pair of rows at a lag, their sum of products is zero as well.
fn pairs(shares: Option<&[f64]>, rows: usize, lags: usize) -> Vec<f64> {
    let Some(shares) = shares else { return (0..lags).map(|l| (rows - l) as f64).collect() };
    let mut pairs = vec![0.0; lags];
    add_lagged_products(shares, shares, &mut pairs);
    pairs.iter().map(|p| p.max(1.0)).collect()
}

/// Andrews' bandwidth for Parzen's window and an autoregressive series of the first order, but at least the square root of the
/// number of rows: with white and slow errors together, the correlation of neighbours does not show the slow ones.
fn bandwidth(residual: &[f64]) -> f64 {
    let n = residual.len() as f64;
    let mut sums = [0.0; 2];
    add_lagged_products(residual, residual, &mut sums);
    let r = if sums[0] > 0.0 { sums[1] / sums[0] } else { 0.0 };
    let alpha = 4.0 * r * r / (1.0 - r).powi(4);
    let plug_in = 2.6614 * (alpha * n).powf(0.2);
    plug_in.max(n.sqrt()).min((LARGEST_BANDWIDTH * n).max(1.0))
}

/// Parzen's window at the lags inside a bandwidth.
fn parzen(bandwidth: f64, rows: usize) -> Vec<f64> {
    let weight = |lag: usize| {
        let x = lag as f64 / bandwidth;
        if x <= 0.5 { 1.0 - 6.0 * x * x * (1.0 - x) } else { 2.0 * (1.0 - x).powi(3) }
    };
    (0..rows).take_while(|lag| (*lag as f64) < bandwidth).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_is_parzens() {
        let window = parzen(4.0, 100);
        let expected = [1.0, 1.0 - 6.0 / 16.0 + 6.0 / 64.0, 0.25, 2.0 / 64.0];
        assert_eq!(window.len(), 4);
        assert!(window.iter().zip(expected).all(|(w, e)| (w - e).abs() < 1e-15), "{window:?}");
        assert_eq!(parzen(4.0, 2).len(), 2);
    }

    #[test]
    fn the_bandwidth_follows_the_correlation_and_stays_in_its_bounds() {
        assert_eq!((bandwidth(&[1.0; 90]), bandwidth(&[0.0; 100])), (30.0, 10.0));
        // Three rows of one sign, then three of the other.
        let wave: Vec<f64> = (0..900).map(|k| if k / 3 % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let r: f64 = (600.0 - 299.0) / 900.0;
        let alpha = 4.0 * r * r / (1.0 - r).powi(4);
        assert!((bandwidth(&wave) - (2.6614 * (alpha * 900.0).powf(0.2)).max(30.0)).abs() < 1e-12);
    }
}
