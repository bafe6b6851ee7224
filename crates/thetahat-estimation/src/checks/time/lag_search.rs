//! The search for lags: whole steps first, then Gauss-Newton.

use crate::{
    checks::{
        fit::{orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
        numbers::block_score,
    },
    signal::{central_difference, delayed},
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr, dot},
    series::Series,
};

/// Longest lag that is searched for, s.
pub(in crate::checks) const LONGEST_S: f64 = 0.1;
/// Most whole steps of the search to each side.
const MOST_STEPS: usize = 50;
/// Every n-th whole step is tried: Gauss-Newton reaches the steps between.
const COARSE: isize = 3;
/// Most steps of Gauss-Newton.
const ITERATIONS: usize = 10;
/// Change of a lag, in steps, at which Gauss-Newton ends: a hundredth of a sample where a step is ten samples.
const CONVERGED: f64 = 1e-3;

/// Mean squared slope, relative to the torque's variance, below which it is rounding.
const SMALLEST_SLOPE: f64 = 1e-20;

/// Lags in steps of the thinned recording, with their standard deviations from blocks of time; infinite for a joint without
/// information.
pub(in crate::checks) struct Lags {
    pub(in crate::checks) steps: Vec<f64>,
    pub(in crate::checks) deviation: Vec<f64>,
}

/// A recording and its fits, to search in.
pub(in crate::checks) struct LagSearch<'a, 'b> {
    pub(in crate::checks) recording: &'a ThinnedRecording<'b>,
    /// The fit of the parameters alone; its predicted torque is late.
    pub(in crate::checks) parameters: &'a OrthogonalFit,
    /// The fit with the friction shapes, which a lag must improve.
    pub(in crate::checks) with_shapes: &'a OrthogonalFit,
}

/// Which lags are free.
#[derive(Debug, Clone, Copy)]
enum Joints {
    /// One lag for each joint.
    Each,
    /// One lag for all joints.
    Together,
}

impl LagSearch<'_, '_> {
    fn steps(&self) -> impl Iterator<Item = isize> + use<> {
        let most = (LONGEST_S * self.recording.rate_hz).ceil().min(MOST_STEPS as f64) as isize;
        (-most..=most).filter(|s| s % COARSE == 0)
    }

    /// The lag of each joint with the others unchanged.
    pub(in crate::checks) fn lag_of_each_joint(&self) -> Option<Lags> {
        let joints = self.recording.coordinates();
        let mut best = vec![(0, f64::INFINITY); joints];
        for step in self.steps() {
            let rows = later(self.recording, step);
            for (j, best) in best.iter_mut().enumerate() {
                let squares = self.with_shapes.squares_with(&rows, j);
                if squares < best.1 {
                    *best = (step, squares);
                }
            }
        }
        self.refined(best.into_iter().map(|b| b.0 as f64).collect(), Joints::Each)
    }

    /// The lag of all joints together.
    pub(in crate::checks) fn common_lag(&self) -> Option<Lags> {
        let squares = |step: isize| {
            let rest = self.with_shapes.unexplained(&later(self.recording, step));
            dot(&rest, &rest)
        };
        let best = self.steps().map(|s| (s, squares(s))).min_by(|a, b| a.1.total_cmp(&b.1));
        self.refined(vec![best.map_or(0.0, |b| b.0 as f64); self.recording.coordinates()], Joints::Together)
    }

    /// Gauss-Newton from whole lags; `None` if the recording does not determine them.
    fn refined(&self, mut steps: Vec<f64>, free: Joints) -> Option<Lags> {
        let joints = self.recording.coordinates();
        let most = LONGEST_S * self.recording.rate_hz;
        let mut deviation = vec![f64::INFINITY; joints];
        let mut rest = self.residual(&steps);
        for _ in 0..ITERATIONS {
            let (groups, directions) = self.directions(&steps, free)?;
            let qr = PivotedQr::new(&directions);
            if groups.is_empty() || qr.rank(1e-9) < directions.columns() {
                return None;
            }
            let change = qr.solve(&rest);
            let influence = directions.times_matrix(&qr.inverse_gram());
            let left: Vec<f64> = rest.iter().zip(directions.times(&change)).map(|(r, d)| r - d).collect();
            for (c, group) in groups.iter().enumerate() {
                let uncertainty = block_score(influence.column(c), &left, self.recording.rows());
                for &j in group {
                    steps[j] = (steps[j] - change[c]).clamp(-most, most);
                    deviation[j] = uncertainty;
                }
            }
            rest = self.residual(&steps);
            if change.iter().all(|c| c.abs() < CONVERGED) {
                break;
            }
        }
        Some(Lags { steps, deviation })
    }

    fn residual(&self, steps: &[f64]) -> Vec<f64> {
        self.with_shapes.unexplained(&self.recording.stack(&shifted(&self.recording.torque, steps)))
    }

    /// The groups of joints whose lag the recording determines, and the derivative of the residual by each lag: the slope of
    /// the predicted torque.
    fn directions(&self, steps: &[f64], free: Joints) -> Option<(Vec<Vec<usize>>, Matrix)> {
        let recording = self.recording;
        let stacked = recording.stack(&shifted(&recording.torque, steps));
        let theta = self.parameters.theta_of(&stacked);
        let smooth = recording.decimator.filter(&recording.predict(&recording.motion, &theta)).ok()?;
        let slope = recording.stack(&central_difference(&smooth, 1.0));
        let rows = recording.rows();
        let part = |group: &Vec<usize>| -> Vec<f64> {
            let own = slope.iter().enumerate().map(|(i, s)| if group.contains(&(i / rows)) { *s } else { 0.0 });
            self.with_shapes.unexplained(&own.collect::<Vec<_>>())
        };
        let all = 0..recording.coordinates();
        let groups: Vec<Vec<usize>> = match free {
            Joints::Together => vec![all.collect()],
            Joints::Each => all.map(|j| vec![j]).collect(),
        };
        let columns = groups.into_iter().map(|group| (part(&group), group));
        let informative = columns.filter(|(column, _)| dot(column, column) > SMALLEST_SLOPE * rows as f64);
        let (columns, groups): (Vec<_>, Vec<_>) = informative.unzip();
        let matrix = Matrix::from_fn(slope.len(), columns.len(), |i, c| columns[c][i]);
        Some((groups, matrix))
    }

    pub(in crate::checks) fn joint_squares(&self, rest: &[f64]) -> Vec<f64> {
        rest.chunks(self.recording.rows()).map(|r| dot(r, r)).collect()
    }
}

/// The rows of the torque some whole steps later.
pub(super) fn later(recording: &ThinnedRecording<'_>, step: isize) -> Vec<f64> {
    let torque = &recording.torque;
    let last = torque.len() as isize - 1;
    let at = |k: usize, j: usize| torque.sample((k as isize + step).clamp(0, last) as usize)[j];
    (0..torque.channels()).flat_map(|j| recording.kept.iter().map(move |&k| at(k, j))).collect()
}

/// The series with channel j shifted by `steps[j]`, which corrects a lag of so many steps.
pub(in crate::checks) fn shifted(series: &Series, steps: &[f64]) -> Series {
    delayed(series, &steps.iter().map(|step| -step).collect::<Vec<_>>())
}
