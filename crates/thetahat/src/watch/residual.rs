//! The residual's size while joints move.

use super::step::Step;
use thetahat_report::results::WatchResidual;

/// Sums of squares of each joint while it moves: residual, torque, count; of the whole time and since the last line.
#[derive(Debug, Clone)]
pub(super) struct ResidualSums {
    whole: Vec<[f64; 3]>,
    since: Vec<[f64; 3]>,
    said_s: Option<f64>,
}

impl ResidualSums {
    pub(super) fn new(joints: usize) -> Self {
        Self { whole: vec![[0.0; 3]; joints], since: vec![[0.0; 3]; joints], said_s: None }
    }

    pub(super) fn add(&mut self, step: &Step) {
        for (j, row) in step.rows.iter().enumerate().filter(|(j, _)| !step.rest[*j]) {
            for sums in [&mut self.whole[j], &mut self.since[j]] {
                sums.iter_mut().zip([row.y * row.y, row.square, 1.0]).for_each(|(sum, value)| *sum += value);
            }
        }
    }

    /// The residual since the last one, if so much time has passed since it was said.
    pub(super) fn due(&mut self, time_s: f64, every_s: f64) -> Option<WatchResidual> {
        if self.said_s.is_some_and(|said| time_s - said < every_s) {
            return None;
        }
        let said = self.said_s.replace(time_s);
        let residual = self.since(time_s);
        said.map(|_| residual)
    }

    /// The residual of the whole time.
    pub(super) fn whole(&mut self, time_s: f64) -> WatchResidual {
        self.since.clone_from(&self.whole);
        self.since(time_s)
    }

    fn since(&mut self, time_s: f64) -> WatchResidual {
        let since = std::mem::replace(&mut self.since, vec![[0.0; 3]; self.whole.len()]);
        let rms = |[square, _, count]: &[f64; 3]| (*count > 0.0).then(|| (square / count).sqrt());
        let percent = |[square, torque, _]: &[f64; 3]| (*torque > 0.0).then(|| 100.0 * (square / torque).sqrt());
        WatchResidual { time_s, rms: since.iter().map(rms).collect(), percent: since.iter().map(percent).collect() }
    }
}
