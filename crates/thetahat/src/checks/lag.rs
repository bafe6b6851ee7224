//! Lag between torque and position, joint by joint.
//!
//! A torque that is late by `d` is `y(t) = y0(t - d)`, so the residual of the fit follows the derivative of the predicted
//! torque. A search over whole steps starts Gauss-Newton, which shifts the torques until that part of the residual is
//! gone.

use super::{
    Code, Severity,
    chain::{Chain, Regression},
    examination::{Evidence, Examination},
    numbers::dot,
};
use crate::{
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
    signal::central_difference,
};

/// Part of a joint's squared residual that its lag must explain, percent. The clean records stay below 17; the pulses of
/// EMPS have 50, which is a true lag of 0.7 samples.
const EXPLAINED_LIMIT_PERCENT: f64 = 25.0;
/// Lag in samples below which it is noted only.
const ONE_SAMPLE: f64 = 1.0;
/// Longest lag that is searched for, s.
const LONGEST_S: f64 = 0.1;
/// Most whole steps of the search to each side.
const MOST_STEPS: usize = 50;
/// Steps of Gauss-Newton.
const ITERATIONS: usize = 6;
/// Common lag instead of one for each joint, where it leaves no more than this times the squared residual.
const AS_GOOD: f64 = 1.05;

/// Corrects the chain by the lags that are found.
pub(super) fn check(exam: &mut Examination<'_>, chain: &mut Chain<'_>) {
    let Ok(regression) = chain.regression() else { return };
    let search = Search { chain, regression: &regression };
    let Some(each) = search.refined(search.coarse(), false) else { return };
    let Some(common) = search.refined(search.coarse_common(), true) else { return };
    let together = common.squares.iter().sum::<f64>() <= AS_GOOD * each.squares.iter().sum::<f64>();
    let lags = if together { common } else { each };
    let before = search.joint_squares(&regression.residual);
    let per_sample = exam.subject.sample_rate_hz / chain.rate_hz;
    let found = if together {
        judge(exam, None, (&before, &lags.squares), &lags, per_sample)
    } else {
        (0..chain.joints())
            .map(|j| judge(exam, Some(j), (&before[j..=j], &lags.squares[j..=j]), &lags, per_sample))
            .fold(false, |a, b| a || b)
    };
    if found {
        chain.replace_torque(shifted(&chain.torque, &lags.steps));
    }
}

/// Lags in steps of the chain with their deviations, and what they leave of each joint's squared residual.
struct Lags {
    steps: Vec<f64>,
    deviation: Vec<f64>,
    squares: Vec<f64>,
}

fn judge(
    exam: &mut Examination<'_>,
    joint: Option<usize>,
    (before, after): (&[f64], &[f64]),
    lags: &Lags,
    per_sample: f64,
) -> bool {
    let j = joint.unwrap_or(0);
    let (lag, deviation) = (lags.steps[j] * per_sample, lags.deviation[j] * per_sample);
    let explained = 100.0 * (1.0 - after.iter().sum::<f64>() / before.iter().sum::<f64>());
    let evidence = Evidence {
        code: Code::Lag,
        joint,
        value: explained,
        unit: "% of the squared residual",
        limit: EXPLAINED_LIMIT_PERCENT,
    };
    exam.note_measure(evidence);
    if explained <= EXPLAINED_LIMIT_PERCENT {
        return false;
    }
    let severity = if lag.abs() < ONE_SAMPLE { Severity::Note } else { Severity::Warning };
    let rate = exam.subject.sample_rate_hz;
    let (size, order) = (lag.abs(), if lag > 0.0 { "later" } else { "earlier" });
    let whose = joint.map_or_else(|| "the torques are".to_owned(), |j| format!("joint {}: the torque is", j + 1));
    let words = (
        format!(
            "{whose} {size:.1} samples ({:.2} ms, +- {:.2}) {order} than the position; without that the squared \
             residual is {explained:.0} % smaller",
            1e3 * size / rate,
            1e3 * deviation / rate
        ),
        "shift the torque against the position before the estimate, and state the delay of [controller]".to_owned(),
    );
    let evidence = Evidence { value: lag, unit: "samples", limit: f64::NAN, ..evidence };
    exam.raise(evidence, severity, words, Vec::new());
    severity != Severity::Note
}

struct Search<'a, 'b> {
    chain: &'a Chain<'b>,
    regression: &'a Regression,
}

impl Search<'_, '_> {
    fn steps(&self) -> impl Iterator<Item = f64> + use<> {
        let most = (LONGEST_S * self.chain.rate_hz).ceil().min(MOST_STEPS as f64) as i32;
        (-most..=most).map(f64::from)
    }

    /// The best whole lag of each joint with the others as they are.
    fn coarse(&self) -> Vec<f64> {
        let joints = self.chain.joints();
        let mut best = vec![(0.0, f64::INFINITY); joints];
        for step in self.steps() {
            let stacked = self.chain.stack(&shifted(&self.chain.torque, &vec![step; joints]));
            for (j, best) in best.iter_mut().enumerate() {
                let squares = self.regression.squares_with(&stacked, j, joints);
                if squares < best.1 {
                    *best = (step, squares);
                }
            }
        }
        best.into_iter().map(|b| b.0).collect()
    }

    /// The best whole lag of all joints together.
    fn coarse_common(&self) -> Vec<f64> {
        let joints = self.chain.joints();
        let squares = |step: f64| {
            let stacked = self.chain.stack(&shifted(&self.chain.torque, &vec![step; joints]));
            let rest = self.regression.unexplained(&stacked);
            dot(&rest, &rest)
        };
        let best = self.steps().map(|s| (s, squares(s))).min_by(|a, b| a.1.total_cmp(&b.1));
        vec![best.map_or(0.0, |b| b.0); joints]
    }

    /// Gauss-Newton from whole lags, of each joint or of all together.
    fn refined(&self, mut steps: Vec<f64>, together: bool) -> Option<Lags> {
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

    fn joint_squares(&self, rest: &[f64]) -> Vec<f64> {
        rest.chunks(self.chain.rows()).map(|r| dot(r, r)).collect()
    }
}

/// The series with channel j taken `steps[j]` later: what it was before it became late. Cubic between samples, the ends
/// held.
fn shifted(series: &Series, steps: &[f64]) -> Series {
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
