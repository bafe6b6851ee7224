//! The search for lags: whole steps first, then Gauss-Newton.

use std::ops::Range;

use super::{chain::Chain, regression::Regression};
use crate::{
    linear_algebra::{Matrix, PivotedQr, dot},
    series::Series,
    signal::central_difference,
};

/// Longest lag that is searched for, s.
pub(super) const LONGEST_S: f64 = 0.1;
/// Most whole steps of the search to each side.
const MOST_STEPS: usize = 50;
/// Of the whole steps, every n-th is tried: Gauss-Newton reaches further than that.
const COARSE: isize = 3;
/// Most steps of Gauss-Newton.
const ITERATIONS: usize = 10;
/// Change of a lag, in steps, at which Gauss-Newton ends: a hundredth of a sample where a step is ten samples.
const CONVERGED: f64 = 1e-3;

/// Lags in steps of the chain with their deviations, and what they leave of each joint's squared residual.
pub(super) struct Lags {
    pub(super) steps: Vec<f64>,
    pub(super) deviation: Vec<f64>,
    pub(super) squares: Vec<f64>,
}

/// A chain and its fit, to search in.
pub(super) struct Search<'a, 'b> {
    pub(super) chain: &'a Chain<'b>,
    pub(super) regression: &'a Regression,
}

impl Search<'_, '_> {
    fn steps(&self) -> impl Iterator<Item = isize> + use<> {
        let most = (LONGEST_S * self.chain.rate_hz).ceil().min(MOST_STEPS as f64) as isize;
        (-most..=most).filter(|s| s % COARSE == 0)
    }

    /// The rows of the torque some whole steps later.
    fn later(&self, step: isize) -> Vec<f64> {
        let torque = &self.chain.torque;
        let last = torque.len() as isize - 1;
        let at = |k: usize, j: usize| torque.sample((k as isize + step).clamp(0, last) as usize)[j];
        (0..torque.channels()).flat_map(|j| self.chain.kept.iter().map(move |&k| at(k, j))).collect()
    }

    /// The best whole lag of each joint with the others as they are.
    pub(super) fn coarse(&self) -> Vec<f64> {
        let joints = self.chain.joints();
        let mut best = vec![(0, f64::INFINITY); joints];
        for step in self.steps() {
            let rows = self.later(step);
            for (j, best) in best.iter_mut().enumerate() {
                let squares = self.regression.squares_with(&rows, j, joints);
                if squares < best.1 {
                    *best = (step, squares);
                }
            }
        }
        best.into_iter().map(|b| b.0 as f64).collect()
    }

    /// The best whole lag of all joints together.
    pub(super) fn coarse_common(&self) -> Vec<f64> {
        let squares = |step: isize| {
            let rest = self.regression.unexplained(&self.later(step));
            dot(&rest, &rest)
        };
        let best = self.steps().map(|s| (s, squares(s))).min_by(|a, b| a.1.total_cmp(&b.1));
        vec![best.map_or(0.0, |b| b.0 as f64); self.chain.joints()]
    }

    /// Gauss-Newton from whole lags, of each joint or of all together.
    pub(super) fn refined(&self, mut steps: Vec<f64>, together: bool) -> Option<Lags> {
        let joints = self.chain.joints();
        let mut deviation = vec![0.0; joints];
        let mut rest = self.residual(&steps);
        for _ in 0..ITERATIONS {
            let directions = self.directions(&steps, together)?;
            let qr = PivotedQr::new(&directions);
            if qr.rank(1e-9) < directions.columns() {
                return None;
            }
            let change = qr.solve(&rest);
            let inverse = qr.inverse_gram();
            let variance = dot(&rest, &rest) / rest.len() as f64;
            for j in 0..joints {
                let c = if together { 0 } else { j };
                steps[j] -= change[c];
                deviation[j] = (variance * inverse.at(c, c)).sqrt();
            }
            let most = LONGEST_S * self.chain.rate_hz;
            steps.iter_mut().for_each(|s| *s = s.clamp(-most, most));
            rest = self.residual(&steps);
            if change.iter().all(|c| c.abs() < CONVERGED) {
                break;
            }
        }
        Some(Lags { squares: self.joint_squares(&rest), steps, deviation })
    }

    fn residual(&self, steps: &[f64]) -> Vec<f64> {
        self.regression.unexplained(&self.chain.stack(&shifted(&self.chain.torque, steps)))
    }

    /// The change of the residual with each lag taken out: the derivative of the torque as predicted.
    fn directions(&self, steps: &[f64], together: bool) -> Option<Matrix> {
        let chain = self.chain;
        let stacked = chain.stack(&shifted(&chain.torque, steps));
        let theta = self.regression.theta_of(&stacked);
        let smooth = chain.decimator.filter(&chain.predict(&chain.motion, &theta)).ok()?;
        let slope = chain.stack(&central_difference(&smooth, 1.0));
        let rows = chain.rows();
        let part = |j: usize| -> Vec<f64> {
            let own = |i: usize| together || i / rows == j;
            slope.iter().enumerate().map(|(i, s)| if own(i) { *s } else { 0.0 }).collect()
        };
        let count = if together { 1 } else { chain.joints() };
        let columns: Vec<Vec<f64>> = (0..count).map(|j| self.regression.unexplained(&part(j))).collect();
        Some(Matrix::from_fn(slope.len(), count, |i, c| columns[c][i]))
    }

    /// The further lag, in steps, of the Coulomb friction of a group of joints when their torques are put right, and its
    /// standard deviation; none where there is no friction.
    pub(super) fn friction_lag(&self, steps: &[f64], group: Range<usize>) -> Option<(f64, f64)> {
        let chain = self.chain;
        let rest = self.residual(steps);
        let theta = self.regression.theta_of(&chain.stack(&shifted(&chain.torque, steps)));
        let slope = |theta: &[f64]| {
            let smooth = chain.decimator.filter(&chain.predict(&chain.motion, theta)).ok()?;
            let mut slope = chain.stack(&central_difference(&smooth, 1.0));
            let own = |i: usize| group.contains(&(i / chain.rows()));
            slope.iter_mut().enumerate().filter(|(i, _)| !own(*i)).for_each(|(_, s)| *s = 0.0);
            Some(slope)
        };
        let coulomb: Vec<f64> =
            theta.iter().enumerate().map(|(c, t)| if chain.is_coulomb_friction(c) { *t } else { 0.0 }).collect();
        let others: Vec<f64> = theta.iter().zip(&coulomb).map(|(t, f)| t - f).collect();
        let columns = [slope(&coulomb)?, slope(&others)?].map(|s| self.regression.unexplained(&s));
        let qr = PivotedQr::new(&Matrix::from_fn(rest.len(), 2, |i, c| columns[c][i]));
        let variance = dot(&rest, &rest) / rest.len() as f64;
        (qr.rank(1e-9) == 2).then(|| (-qr.solve(&rest)[0], (variance * qr.inverse_gram().at(0, 0)).sqrt()))
    }

    pub(super) fn joint_squares(&self, rest: &[f64]) -> Vec<f64> {
        rest.chunks(self.chain.rows()).map(|r| dot(r, r)).collect()
    }
}

/// The series with channel j taken `steps[j]` later: what it was before it became late. Cubic between samples, the ends
/// held.
pub(super) fn shifted(series: &Series, steps: &[f64]) -> Series {
    let last = series.len() as isize - 1;
    let mut result = Series::zeros(series.len(), series.channels());
    for (j, step) in steps.iter().enumerate() {
        let (whole, part) = (step.floor() as isize, step - step.floor());
        let weights = cubic(part);
        for k in 0..series.len() {
            let value = |i: isize| series.sample((k as isize + whole + i).clamp(0, last) as usize)[j];
            result.sample_mut(k)[j] = (0..4).map(|i| weights[i as usize] * value(i - 1)).sum();
        }
    }
    result
}

/// Weights of the samples at -1, 0, 1 and 2 for the value at `t` from 0 to 1.
fn cubic(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}
