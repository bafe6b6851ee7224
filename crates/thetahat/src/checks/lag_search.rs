//! The search for lags: whole steps first, then Gauss-Newton.

use std::ops::Range;

use super::{orthogonal_fit::OrthogonalFit, thinned_record::ThinnedRecord};
use crate::{
    linear_algebra::{Matrix, PivotedQr, dot},
    series::Series,
    signal::{central_difference, delayed},
};

/// Longest lag that is searched for, s.
pub(super) const LONGEST_S: f64 = 0.1;
/// Most whole steps of the search to each side.
const MOST_STEPS: usize = 50;
/// Every n-th whole step is tried: Gauss-Newton reaches the steps between.
const COARSE: isize = 3;
/// Most steps of Gauss-Newton.
const ITERATIONS: usize = 10;
/// Change of a lag, in steps, at which Gauss-Newton ends: a hundredth of a sample where a step is ten samples.
const CONVERGED: f64 = 1e-3;

/// Lags in steps of the record, with their standard deviations and each joint's squared residual without them.
pub(super) struct Lags {
    pub(super) steps: Vec<f64>,
    pub(super) deviation: Vec<f64>,
    pub(super) squares: Vec<f64>,
}

/// A lag of Coulomb friction alone.
pub(super) struct FrictionLag {
    pub(super) steps: f64,
    /// Its standard deviation.
    pub(super) deviation: f64,
}

/// A record and its fit, to search in.
pub(super) struct Search<'a, 'b> {
    pub(super) record: &'a ThinnedRecord<'b>,
    pub(super) fit: &'a OrthogonalFit,
}

impl Search<'_, '_> {
    fn steps(&self) -> impl Iterator<Item = isize> + use<> {
        let most = (LONGEST_S * self.record.rate_hz).ceil().min(MOST_STEPS as f64) as isize;
        (-most..=most).filter(|s| s % COARSE == 0)
    }

    /// The rows of the torque some whole steps later.
    fn later(&self, step: isize) -> Vec<f64> {
        let torque = &self.record.torque;
        let last = torque.len() as isize - 1;
        let at = |k: usize, j: usize| torque.sample((k as isize + step).clamp(0, last) as usize)[j];
        (0..torque.channels()).flat_map(|j| self.record.kept.iter().map(move |&k| at(k, j))).collect()
    }

    /// The best whole lag of each joint with the others as they are.
    pub(super) fn coarse(&self) -> Vec<f64> {
        let joints = self.record.coordinates();
        let mut best = vec![(0, f64::INFINITY); joints];
        for step in self.steps() {
            let rows = self.later(step);
            for (j, best) in best.iter_mut().enumerate() {
                let squares = self.fit.squares_with(&rows, j);
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
            let rest = self.fit.unexplained(&self.later(step));
            dot(&rest, &rest)
        };
        let best = self.steps().map(|s| (s, squares(s))).min_by(|a, b| a.1.total_cmp(&b.1));
        vec![best.map_or(0.0, |b| b.0 as f64); self.record.coordinates()]
    }

    /// Gauss-Newton from whole lags, of each joint or of all together.
    pub(super) fn refined(&self, mut steps: Vec<f64>, together: bool) -> Option<Lags> {
        let joints = self.record.coordinates();
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
            let most = LONGEST_S * self.record.rate_hz;
            steps.iter_mut().for_each(|s| *s = s.clamp(-most, most));
            rest = self.residual(&steps);
            if change.iter().all(|c| c.abs() < CONVERGED) {
                break;
            }
        }
        Some(Lags { squares: self.joint_squares(&rest), steps, deviation })
    }

    fn residual(&self, steps: &[f64]) -> Vec<f64> {
        self.fit.unexplained(&self.record.stack(&shifted(&self.record.torque, steps)))
    }

    /// The derivative of the residual by each lag: the slope of the predicted torque.
    fn directions(&self, steps: &[f64], together: bool) -> Option<Matrix> {
        let record = self.record;
        let stacked = record.stack(&shifted(&record.torque, steps));
        let theta = self.fit.theta_of(&stacked);
        let smooth = record.decimator.filter(&record.predict(&record.motion, &theta)).ok()?;
        let slope = record.stack(&central_difference(&smooth, 1.0));
        let rows = record.rows();
        let part = |j: usize| -> Vec<f64> {
            let own = |i: usize| together || i / rows == j;
            slope.iter().enumerate().map(|(i, s)| if own(i) { *s } else { 0.0 }).collect()
        };
        let count = if together { 1 } else { record.coordinates() };
        let columns: Vec<Vec<f64>> = (0..count).map(|j| self.fit.unexplained(&part(j))).collect();
        Some(Matrix::from_fn(slope.len(), count, |i, c| columns[c][i]))
    }

    /// The lag that the Coulomb friction of a group of joints still has after their torques are put right; none where
    /// there is no friction.
    pub(super) fn friction_lag(&self, steps: &[f64], group: Range<usize>) -> Option<FrictionLag> {
        let record = self.record;
        let rest = self.residual(steps);
        let theta = self.fit.theta_of(&record.stack(&shifted(&record.torque, steps)));
        let slope = |theta: &[f64]| {
            let smooth = record.decimator.filter(&record.predict(&record.motion, theta)).ok()?;
            let mut slope = record.stack(&central_difference(&smooth, 1.0));
            let own = |i: usize| group.contains(&(i / record.rows()));
            slope.iter_mut().enumerate().filter(|(i, _)| !own(*i)).for_each(|(_, s)| *s = 0.0);
            Some(slope)
        };
        let coulomb: Vec<f64> =
            theta.iter().enumerate().map(|(c, t)| if record.is_coulomb_friction(c) { *t } else { 0.0 }).collect();
        let others: Vec<f64> = theta.iter().zip(&coulomb).map(|(t, f)| t - f).collect();
        let columns = [slope(&coulomb)?, slope(&others)?].map(|s| self.fit.unexplained(&s));
        let qr = PivotedQr::new(&Matrix::from_fn(rest.len(), 2, |i, c| columns[c][i]));
        let variance = dot(&rest, &rest) / rest.len() as f64;
        (qr.rank(1e-9) == 2).then(|| FrictionLag {
            steps: -qr.solve(&rest)[0],
            deviation: (variance * qr.inverse_gram().at(0, 0)).sqrt(),
        })
    }

    pub(super) fn joint_squares(&self, rest: &[f64]) -> Vec<f64> {
        rest.chunks(self.record.rows()).map(|r| dot(r, r)).collect()
    }
}

/// The series with channel j read `steps[j]` later, which undoes a lag of so many steps.
pub(super) fn shifted(series: &Series, steps: &[f64]) -> Series {
    delayed(series, &steps.iter().map(|step| -step).collect::<Vec<_>>())
}
