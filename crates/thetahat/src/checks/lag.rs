//! Lag between torque and position, joint by joint.
//!
//! A torque that is late by `d` is `y(t) = y0(t - d)`, so the residual of the fit follows the derivative of the predicted
//! torque. A search over whole steps starts Gauss-Newton, which shifts the torques until that part of the residual is
//! gone.

use std::ops::Range;

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    lag_search::{FrictionLag, LONGEST_S, Lags, Search, shifted},
    thinned_record::ThinnedRecord,
};

/// Part of the squared residual that a lag must explain, percent. The clean recordings stay below 18.
const EXPLAINED_LIMIT_PERCENT: f64 = 25.0;
/// Rms torque that it must explain, percent of the torque's deviation. The friction of the clean twins, which is not quite
/// a sign, leaves up to 3.8.
const EFFECT_LIMIT_PERCENT: f64 = 5.0;
/// Standard deviations by which a lag must differ from zero.
const SURE: f64 = 6.0;
/// Part of a lag by which friction alone may differ from it. Joints whose model is poor follow any shift with one part of
/// their torque: joint 5 of the recorded KUKA differs by 0.9.
const SAME: f64 = 0.35;
/// Lag in samples below which it is noted only.
const ONE_SAMPLE: f64 = 1.0;
/// One lag for all joints is taken where it leaves no more than this times the squared residual of one lag per joint.
const AS_GOOD: f64 = 1.05;

/// Corrects the record by the lags that are found.
pub(super) fn check(exam: &mut Examination<'_>, record: &mut ThinnedRecord<'_>) {
    let Ok(fit) = record.fit() else { return };
    let search = Search { record, fit: &fit };
    let Some(each) = search.refined(search.coarse(), false) else { return };
    let Some(common) = search.refined(search.coarse_common(), true) else { return };
    let together = common.squares.iter().sum::<f64>() <= AS_GOOD * each.squares.iter().sum::<f64>();
    let lags = if together { common } else { each };
    let before = search.joint_squares(&fit.residual);
    let size = if together { record.coordinates() } else { 1 };
    let mut correction = vec![0.0; record.coordinates()];
    for first in (0..record.coordinates()).step_by(size) {
        let group = first..first + size;
        let lag = Lag::new(&search, &lags, group.clone(), &before);
        if lag.judge(exam, together) {
            group.for_each(|j| correction[j] = lags.steps[j]);
        }
    }
    if correction.iter().any(|s| *s != 0.0) {
        record.replace_torque(shifted(&record.torque, &correction));
    }
}

/// The lag of one joint, or of all.
struct Lag {
    coordinate: usize,
    /// Samples by which the torque is later, and the standard deviation.
    samples: f64,
    deviation: f64,
    /// Part of the squared residual that it explains, percent.
    explained: f64,
    /// Rms torque that it explains, percent of the torque's deviation.
    effect: f64,
    /// Further lag of friction alone, in samples; zero where friction says nothing.
    friction: f64,
    longest: f64,
    rate: f64,
}

impl Lag {
    fn new(search: &Search<'_, '_>, lags: &Lags, group: Range<usize>, before: &[f64]) -> Self {
        let rate = search.record.subject.sample_rate_hz;
        let per_step = rate / search.record.rate_hz;
        let (was, is) = (before[group.clone()].iter().sum::<f64>(), lags.squares[group.clone()].iter().sum::<f64>());
        let mut lag = Self {
            coordinate: group.start,
            samples: per_step * lags.steps[group.start],
            deviation: per_step * lags.deviation[group.start],
            explained: 100.0 * (1.0 - is / was),
            effect: 100.0 * ((was - is).max(0.0) / (group.len() * search.record.rows()) as f64).sqrt(),
            friction: 0.0,
            longest: LONGEST_S * rate,
            rate,
        };
        if lag.is_certain() {
            let certain = |friction: &FrictionLag| per_step * friction.deviation < 0.5 * SAME * lag.samples.abs();
            let friction = search.friction_lag(&lags.steps, group).filter(certain);
            lag.friction = per_step * friction.map_or(0.0, |f| f.steps);
        }
        lag
    }

    fn is_certain(&self) -> bool {
        self.samples.abs() > SURE * self.deviation && self.samples.abs() < 0.99 * self.longest
    }

    /// Whether it is a lag: certain, inside the range of the search, and the same in friction as in the rest.
    fn is_one(&self) -> bool {
        self.is_certain() && self.friction.abs() < SAME * self.samples.abs()
    }

    /// Raises it where it is one; whether the record is to be put right.
    fn judge(&self, exam: &mut Examination<'_>, together: bool) -> bool {
        let coordinate = (!together).then_some(self.coordinate);
        let strength = (self.explained / EXPLAINED_LIMIT_PERCENT).min(self.effect / EFFECT_LIMIT_PERCENT);
        let value = if self.is_one() { strength } else { 0.0 };
        let evidence = Evidence { code: Code::Lag, coordinate, value, unit: "times the limits", limit: 1.0 };
        exam.note_measure(evidence);
        if !self.is_one() {
            return false;
        }
        let matters = strength > 1.0 && self.samples.abs() >= ONE_SAMPLE;
        let severity = if matters { Severity::Warning } else { Severity::Note };
        let evidence = Evidence { value: self.samples, unit: "samples", limit: f64::NAN, ..evidence };
        let words = self.words(coordinate.map(|c| exam.subject.joint_number(c)));
        exam.raise(evidence, severity, words);
        matters
    }

    fn words(&self, joint_number: Option<usize>) -> Words {
        let ms = |samples: f64| 1e3 * samples / self.rate;
        let (size, order) = (self.samples.abs(), if self.samples > 0.0 { "later" } else { "earlier" });
        let whose = joint_number
            .map_or_else(|| "the torques are".to_owned(), |number| format!("joint {number}: the torque is"));
        let message = format!(
            "{whose} {size:.1} samples ({:.2} ms, +- {:.2}) {order} than the position; without that the squared \
             residual is {:.0} % smaller",
            ms(size),
            ms(self.deviation),
            self.explained
        );
        let remedy = "shift the torque against the position before the estimate, and state the delay of [controller]";
        Words::new(message, remedy)
    }
}
