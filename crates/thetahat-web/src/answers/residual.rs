//! The residual of a run over time.

use serde::Serialize;
use thetahat::{
    Method, Results,
    results::{NOMINAL, RunResult},
};

/// Largest number of rows of a joint.
const MOST: usize = 2000;

/// Measured minus predicted torques in the first recording, thinned: one row of the answer for each joint.
#[derive(Serialize)]
pub(super) struct ResidualAnswer {
    method: Method,
    /// Since the begin of the recording, s.
    time_s: Vec<f64>,
    /// N m or N.
    residual: Vec<Vec<f32>>,
    /// Root mean square of each joint in all recordings, whose squares are divided by the rows less the parameters, N m or N.
    noise: Vec<f64>,
}

impl ResidualAnswer {
    /// Of the recommended run, or else of the first that has estimates.
    pub(super) fn of(results: &Results) -> Option<Self> {
        let has_estimates = |run: &&RunResult| run.residual.is_some() && !run.plots.predicted.is_empty();
        let nominal = || results.runs.iter().filter(|run| run.case == NOMINAL).find(has_estimates);
        let run = results.recommended_run().filter(has_estimates).or_else(nominal)?;
        let plots = &results.plots;
        let end = plots.recordings.get(1).map_or(plots.time_s.len(), |second| second.row);
        let step = end.div_ceil(MOST).max(1);
        let rows = |measured: &Vec<f64>, predicted: &Vec<f64>| {
            let both = measured.iter().zip(predicted).take(end).step_by(step);
            both.map(|(measured, predicted)| (measured - predicted) as f32).collect()
        };
        Some(Self {
            method: run.method,
            time_s: plots.time_s.iter().take(end).step_by(step).copied().collect(),
            residual: plots.measured.iter().zip(&run.plots.predicted).map(|(m, p)| rows(m, p)).collect(),
            noise: run.residual.as_ref()?.joints.iter().map(|joint| joint.rms).collect(),
        })
    }
}
