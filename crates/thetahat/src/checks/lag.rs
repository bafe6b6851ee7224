//! Lag between torque and position, joint by joint.
//!
//! A torque that is late by `d` is `y(t) = y0(t - d)`, so the residual of the fit follows the derivative of the predicted
//! torque. A search over whole steps starts Gauss-Newton, which shifts the torques until that part of the residual is
//! gone.

use std::ops::Range;

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
/// Standard deviations by which a lag must differ from zero.
const SURE: f64 = 6.0;
/// Part of a lag by which friction alone may differ from it. Joints whose model is poor follow any shift with one part of
/// their torque: joint 5 of the recorded KUKA differs by 0.9.
const SAME: f64 = 0.5;
/// Lag in samples below which it is noted only.
const ONE_SAMPLE: f64 = 1.0;
/// Longest lag that is searched for, s.
const LONGEST_S: f64 = 0.1;
/// Most whole steps of the search to each side.
const MOST_STEPS: usize = 50;
/// Of the whole steps, every n-th is tried: Gauss-Newton reaches further than that.
const COARSE: isize = 3;
/// Most steps of Gauss-Newton.
const ITERATIONS: usize = 10;
/// Change of a lag, in steps, at which Gauss-Newton ends: a hundredth of a sample where a step is ten samples.
const CONVERGED: f64 = 1e-3;
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
    let groups: Vec<Range<usize>> =
        if together { vec![0..chain.joints()] } else { (0..chain.joints()).map(|j| j..j + 1).collect() };
    let mut correction = vec![0.0; chain.joints()];
    for group in groups {
        let lag = Lag::new(&search, &lags, group.clone(), (&before, exam.subject.sample_rate_hz));
        if lag.judge(exam, together) {
            group.for_each(|j| correction[j] = lags.steps[j]);
        }
    }
    if correction.iter().any(|s| *s != 0.0) {
        chain.replace_torque(shifted(&chain.torque, &correction));
    }
}

/// Lags in steps of the chain with their deviations, and what they leave of each joint's squared residual.
struct Lags {
    steps: Vec<f64>,
    deviation: Vec<f64>,
    squares: Vec<f64>,
}

/// The lag of one joint, or of all.
struct Lag {
    joint: usize,
    /// Samples by which the torque is later, and the standard deviation.
    samples: f64,
    deviation: f64,
    /// Part of the squared residual that it explains, percent.
    explained: f64,
    /// Lag of friction alone that is left, in samples.
    friction: f64,
    longest: f64,
    rate: f64,
}

impl Lag {
    fn new(search: &Search<'_, '_>, lags: &Lags, group: Range<usize>, (before, rate): (&[f64], f64)) -> Self {
        let per_step = rate / search.chain.rate_hz;
        let (was, is) = (before[group.clone()].iter().sum::<f64>(), lags.squares[group.clone()].iter().sum::<f64>());
        let mut lag = Self {
            joint: group.start,
            samples: per_step * lags.steps[group.start],
            deviation: per_step * lags.deviation[group.start],
            explained: 100.0 * (1.0 - is / was),
            friction: 0.0,
            longest: LONGEST_S * rate,
            rate,
        };
        if lag.explained > EXPLAINED_LIMIT_PERCENT {
            lag.friction = per_step * search.friction_lag(&lags.steps, group).unwrap_or(0.0);
        }
        lag
    }

    /// Whether it is a lag: certain, inside the range of the search, and the same in friction as in the rest.
    fn is_one(&self) -> bool {
        let size = self.samples.abs();
        size > SURE * self.deviation && size < 0.99 * self.longest && self.friction.abs() < SAME * size
    }

    /// Raises it where it is one; whether the record is to be put right.
    fn judge(&self, exam: &mut Examination<'_>, together: bool) -> bool {
        let joint = (!together).then_some(self.joint);
        let value = if self.is_one() || self.explained <= EXPLAINED_LIMIT_PERCENT { self.explained } else { 0.0 };
        let unit = "% of the squared residual";
        let evidence = Evidence { code: Code::Lag, joint, value, unit, limit: EXPLAINED_LIMIT_PERCENT };
        exam.note_measure(evidence);
        if value <= EXPLAINED_LIMIT_PERCENT {
            return false;
        }
        let severity = if self.samples.abs() < ONE_SAMPLE { Severity::Note } else { Severity::Warning };
        let evidence = Evidence { value: self.samples, unit: "samples", limit: f64::NAN, ..evidence };
        exam.raise(evidence, severity, self.words(joint), Vec::new());
        severity != Severity::Note
    }

    fn words(&self, joint: Option<usize>) -> (String, String) {
        let ms = |samples: f64| 1e3 * samples / self.rate;
        let (size, order) = (self.samples.abs(), if self.samples > 0.0 { "later" } else { "earlier" });
        let whose = joint.map_or_else(|| "the torques are".to_owned(), |j| format!("joint {}: the torque is", j + 1));
        let message = format!(
            "{whose} {size:.1} samples ({:.2} ms, +- {:.2}) {order} than the position; without that the squared \
             residual is {:.0} % smaller",
            ms(size),
            ms(self.deviation),
            self.explained
        );
        let remedy = "shift the torque against the position before the estimate, and state the delay of [controller]";
        (message, remedy.to_owned())
    }
}

struct Search<'a, 'b> {
    chain: &'a Chain<'b>,
    regression: &'a Regression,
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
    fn coarse(&self) -> Vec<f64> {
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
    fn coarse_common(&self) -> Vec<f64> {
        let squares = |step: isize| {
            let rest = self.regression.unexplained(&self.later(step));
            dot(&rest, &rest)
        };
        let best = self.steps().map(|s| (s, squares(s))).min_by(|a, b| a.1.total_cmp(&b.1));
        vec![best.map_or(0.0, |b| b.0 as f64); self.chain.joints()]
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

    /// The further lag, in steps, of the Coulomb friction of a group of joints when their torques are put right; none where
    /// friction says nothing.
    fn friction_lag(&self, steps: &[f64], group: Range<usize>) -> Option<f64> {
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
        (qr.rank(1e-9) == 2).then(|| -qr.solve(&rest)[0])
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
