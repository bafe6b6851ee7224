use super::lagged::add_lagged_products;
use crate::regression::RowLayout;
use thetahat_ground::linear_algebra::Matrix;

/// An estimate that is linear in its errors, as LS, IV and DIDIM are if their assumptions hold.
///
/// | letter | word | shape |
/// | --- | --- | --- |
/// | `X` | design: the prediction is `X theta` (Z for DIDIM) | r x b |
/// | `A` | influence: `theta_hat - theta = A^T e` | r x b |
/// | `e` | errors of the rows | r |
/// | `rho` | residual, `y - X theta_hat = (I - X A^T) e` | r |
///
/// The covariance of the estimate is the sandwich `A^T cov(e) A`; the functions here differ in their assumption on `cov(e)`.
/// They return the variance of each parameter.
#[derive(Debug, Clone, Copy)]
pub struct Sandwich<'a> {
    /// X, unweighted.
    pub design: &'a Matrix,
    /// A, with the weights in it.
    pub influence: &'a Matrix,
    /// rho, unweighted.
    pub residual: &'a [f64],
    /// Joint, recording and stretch of time of the rows.
    pub rows: &'a RowLayout,
}

impl Sandwich<'_> {
    /// Errors that are independent, with one variance for each joint and recording.
    ///
    /// The variance of a block is its sum of squares divided by its rows minus their leverage, the sum of `x_k^T a_k`.
    #[must_use]
    pub fn per_joint(&self) -> Vec<f64> {
        let leverage = self.leverage();
        let mut variances = vec![0.0; self.influence.columns()];
        for block in self.rows.blocks().iter().map(|b| b.rows.clone()) {
            let freedom = (self.rows.counted(block.clone()) - leverage[block.clone()].iter().sum::<f64>()).max(1.0);
            let error = squares(&self.residual[block.clone()]) / freedom;
            self.add_to_each(&mut variances, |a| error * squares(&a[block.clone()]));
        }
        variances
    }

    /// Errors that are independent, with a variance of their own in every row: HC3, `sum_k a_k^2 rho_k^2 / (1 - h_k)^2`
    /// (J. MacKinnon, H. White, "Some heteroskedasticity-consistent covariance matrix estimators with improved finite
    /// sample properties", 1985; H. White, "A heteroskedasticity-consistent covariance matrix estimator", 1980, without
    /// the leverage).
    #[must_use]
    pub fn heteroscedastic(&self) -> Vec<f64> {
        let errors = self.rescaled_residual(1.0);
        let mut variances = vec![0.0; self.influence.columns()];
        self.add_to_each(&mut variances, |a| a.iter().zip(&errors).map(|(a, e)| (a * e).powi(2)).sum());
        variances
    }

    /// Errors that are correlated in time and between joints in any way that fades: Newey and West, 1987, equation (5),
    /// with lags up to `4 (n / 100)^(2/9)` in recordings of n rows per joint, on residuals over `sqrt(1 - h)`.
    ///
    /// The joints' rows of one instant form a cluster; lags do not cross recordings. It assumes the least, at a price: in short
    /// recordings with many parameters its variances are too small (`docs/evidence/coverage.md`).
    #[must_use]
    pub fn newey_west(&self) -> Vec<f64> {
        let errors = self.rescaled_residual(0.5);
        let mut variances = vec![0.0; self.influence.columns()];
        for recording in 0..self.rows.recordings() {
            let rows = self.rows.block(0, recording).len();
            let lags = ((4.0 * (rows as f64 / 100.0).powf(2.0 / 9.0)) as usize).min(rows.saturating_sub(1));
            self.add_to_each(&mut variances, |a| {
                let scores = self.scores(recording, a, &errors);
                let mut sums = vec![0.0; lags + 1];
                add_lagged_products(&scores, &scores, &mut sums);
                let bartlett = |l: usize| 1.0 - l as f64 / (lags + 1) as f64;
                sums[0] + (1..=lags).map(|l| 2.0 * bartlett(l) * sums[l]).sum::<f64>()
            });
        }
        variances
    }

    /// The contribution of each instant of a recording to the error of a parameter, over all joints.
    fn scores(&self, recording: usize, influence: &[f64], errors: &[f64]) -> Vec<f64> {
        let mut scores = vec![0.0; self.rows.block(0, recording).len()];
        for joint in 0..self.rows.joints() {
            let block = self.rows.block(joint, recording);
            let products = influence[block.clone()].iter().zip(&errors[block]).map(|(a, e)| a * e);
            scores.iter_mut().zip(products).for_each(|(s, p)| *s += p);
        }
        scores
    }

    /// Adds `term` of its column of A to the variance of each parameter.
    fn add_to_each(&self, variances: &mut [f64], term: impl Fn(&[f64]) -> f64) {
        variances.iter_mut().enumerate().for_each(|(i, v)| *v += term(self.influence.column(i)));
    }

    /// `h_k = x_k^T a_k`: the part of a row's own error that its prediction absorbs.
    pub(super) fn leverage(&self) -> Vec<f64> {
        let mut leverage = vec![0.0; self.residual.len()];
        for i in 0..self.influence.columns() {
            let products = self.design.column(i).iter().zip(self.influence.column(i)).map(|(x, a)| x * a);
            leverage.iter_mut().zip(products).for_each(|(h, p)| *h += p);
        }
        leverage
    }

    /// `rho_k / (1 - h_k)^power`.
    fn rescaled_residual(&self, power: f64) -> Vec<f64> {
        let rescale = |(r, h): (&f64, f64)| r / (1.0 - h).max(LARGEST_LEVERAGE_LEFT).powf(power);
        self.residual.iter().zip(self.leverage()).map(rescale).collect()
    }
}

/// Smallest part of a row's error that is assumed to remain in its residual: a row that alone determines a parameter has none.
const LARGEST_LEVERAGE_LEFT: f64 = 0.01;

pub(super) fn squares(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of ten values: `X = 1`, `A = 1/10`.
    fn mean(residual: &[f64], rows: &RowLayout, check: impl Fn(Sandwich<'_>)) {
        let n = residual.len();
        let (design, influence) = (Matrix::from_fn(n, 1, |_, _| 1.0), Matrix::from_fn(n, 1, |_, _| 1.0 / n as f64));
        check(Sandwich { design: &design, influence: &influence, residual, rows });
    }

    const RESIDUAL: [f64; 10] = [1.0, -2.0, 0.5, 0.5, -1.0, 2.0, -1.5, 0.0, 1.0, -0.5];

    #[test]
    fn of_a_mean_they_are_the_formulas_of_the_textbook() {
        mean(&RESIDUAL, &RowLayout::new(1, &[10]), |s| {
            let sum: f64 = RESIDUAL.iter().map(|r| r * r).sum();
            assert!((s.per_joint()[0] - sum / 9.0 / 10.0).abs() < 1e-15);
            assert!((s.heteroscedastic()[0] - sum / 0.81 / 100.0).abs() < 1e-15);
        });
    }

    #[test]
    fn newey_west_weights_the_lags_and_does_not_cross_recordings() {
        let lagged = |r: &[f64], l: usize| r.iter().zip(&r[l..]).map(|(a, b)| a * b).sum::<f64>();
        // 4 (5/100)^(2/9) = 2.06 lags in each half.
        let half = |r: &[f64]| lagged(r, 0) + 2.0 * (2.0 / 3.0 * lagged(r, 1) + 1.0 / 3.0 * lagged(r, 2));
        let expected = (half(&RESIDUAL[..5]) + half(&RESIDUAL[5..])) / 0.9 / 100.0;
        mean(&RESIDUAL, &RowLayout::new(1, &[5, 5]), |s| assert!((s.newey_west()[0] - expected).abs() < 1e-15));
    }

    #[test]
    fn newey_west_clusters_the_joints_of_an_instant() {
        // The second joint's errors cancel the first joint's.
        let residual: Vec<f64> = RESIDUAL.iter().copied().chain(RESIDUAL.iter().map(|r| -r)).collect();
        mean(&residual, &RowLayout::new(2, &[10]), |s| {
            assert!(s.newey_west()[0].abs() < 1e-15);
            assert!(s.per_joint()[0] > 0.05);
        });
    }
}
