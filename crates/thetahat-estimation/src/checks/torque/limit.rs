//! Recorded torques that are clipped, with noise or without.
//!
//! A clipped torque stays near its extreme value while the motion, by the fit to the other times, asks for more. Torques of constant
//! acceleration, and those of a drive whose limit the motion follows, stay there as well, and are what that fit predicts.

use thetahat_ground::{linear_algebra::dot, number::significant};

use crate::{
    checks::{
        examination::{Evidence, Examination, FindingText},
        finding::{Code, Severity},
        fit::{orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
        numbers::{NORMAL_PER_MEDIAN, correlation, deviation, quantile_abs, rms},
        remedy_step::RemedyStep,
    },
    statistics::quantile,
};

/// Part of the rows below the extreme value of a torque.
const EXTREME: f64 = 0.99;
/// Part of the extreme value from which rows may be at a limit, and are left out of the fit.
const NEAR: f64 = 0.85;
/// Largest part of a joint's rows that is left out of the fit.
const MOST_NEAR: f64 = 0.5;
/// Least extreme value on one side, part of that on the other: a limit is the same on both.
const LEAST_SIDE: f64 = 0.3;
/// Distance from the extreme value within which rows are at a limit, and beyond which the fit must ask for more, part of it; at least four
/// usual errors of the fit, which must not be more than this part.
const CLEAR: f64 = 0.05;
const USUAL_ERRORS: f64 = 4.0;
const MOST_CLEAR: f64 = 0.25;
/// Error of the fit to all rows over the usual error of the fit to the other rows: with less, that fit is wrong at the extreme.
const GAIN: f64 = 2.0;
/// Part of the rows for which the fit asks for more that must be at the limit.
const AT_LIMIT: f64 = 0.8;
/// Largest slope of the recorded torque over what the fit asks for beyond the extreme value: a clipped torque does not follow. One of
/// strokes of constant velocity, which that fit misses by the friction of a direction that it has not seen, does.
const MOST_SLOPE: f64 = 1.0 / 3.0;
/// Rows at a limit, percent, and fewest of them.
const LIMIT_PERCENT: f64 = 1.0;
const FEWEST_ROWS: usize = 5;
/// Time that is left out on either side, s, and most times.
const MARGIN_S: f64 = 0.1;
const MOST_TIMES: usize = 40;
/// Times that a remedy lists.
const LISTED: usize = 4;

/// Checks for clipped torques; returns whether there are any.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) -> bool {
    let limited = limited(recording).unwrap_or_default();
    let raised = limited.into_iter().map(|limited| {
        let rows = recording.rows() as f64;
        let evidence = Evidence {
            code: Code::TorqueSaturated,
            coordinate: Some(limited.joint),
            value: 100.0 * limited.count as f64 / rows,
            unit: "% of the window",
            limit: LIMIT_PERCENT,
        };
        let number = exam.subject.joint_number(limited.joint);
        let times = recording.times_where(|i| limited.is_limited[i]);
        exam.replace(evidence, Severity::Problem, || limited.finding_text(number, times))
    });
    raised.fold(false, |any, raised| any | raised)
}

/// A torque that is clipped.
struct Limited {
    joint: usize,
    /// Magnitude of the torque there, and the largest that the fit to the other times asks for.
    value: f64,
    asked: f64,
    /// Usual error of that fit.
    usual_error: f64,
    /// Rows at the limit for which the fit asks for clearly more.
    count: usize,
    /// Whether each row is at the limit or next to one that is.
    is_limited: Vec<bool>,
}

impl Limited {
    /// The same with a limit on the other side.
    fn extend(&mut self, other: &Self) {
        self.value = self.value.max(other.value);
        self.asked = self.asked.max(other.asked);
        self.count += other.count;
        self.is_limited.iter_mut().zip(&other.is_limited).for_each(|(own, other)| *own |= other);
    }

    fn finding_text(&self, number: impl std::fmt::Display, times: Vec<[f64; 2]>) -> FindingText {
        let message = format!(
            "joint {number}: the recorded torque stays near {} where the motion asks for up to {}, by the other times: it is clipped",
            significant(self.value, 3),
            significant(self.asked, 3)
        );
        if times.len() > MOST_TIMES {
            return FindingText::new(message, "move more slowly, or widen the range of the drive or recorder");
        }
        let listed = match times.as_slice() {
            [[from, _], .., [_, to]] if times.len() > LISTED => {
                format!(
                    "leave out the {} times of it between {from} and {to} s by left_out_s in [recording]",
                    times.len()
                )
            }
            times => format!("leave these times out: left_out_s = {times:?} in [recording], in s from its start"),
        };
        let remedy = format!("move more slowly, widen the range of the drive or recorder, or {listed}");
        FindingText::new(message, remedy).with_step(RemedyStep::LeaveOutTimes { times })
    }
}

/// What the fit to the other times asks for, with its standard deviation: in a short recording it says little beyond them.
struct Asked<'a> {
    torque: &'a [f64],
    /// Of a row.
    deviation: &'a dyn Fn(usize) -> f64,
}

/// An extreme of a joint's torque, on the positive or the negative side.
struct Side {
    joint: usize,
    sign: f64,
    extreme: f64,
}

fn limited(recording: &ThinnedRecording<'_>) -> Option<Vec<Limited>> {
    let regression = recording.regression().ok()?;
    let rows = recording.rows();
    let torque = |j: usize| recording.rows_of(&regression.y, j);
    let sides: Vec<Side> = (0..recording.coordinates()).flat_map(|j| sides(j, torque(j))).collect();
    let mut is_near = vec![false; regression.y.len()];
    for side in &sides {
        (0..rows).filter(|&i| side.is_near(torque(side.joint)[i])).for_each(|i| is_near[side.joint * rows + i] = true);
    }
    let fit = OrthogonalFit::without(&regression, &is_near);
    if fit.rank < regression.x.columns() {
        return None;
    }
    let (all, asked) = (recording.fit().ok()?, regression.x.times(&fit.theta()));
    let covariance = fit.covariance(&is_near);
    let deviation = |row: usize| {
        let x: Vec<f64> = (0..regression.x.columns()).map(|c| regression.x.at(row, c)).collect();
        dot(&x, &covariance.times(&x)).max(0.0).sqrt()
    };
    let margin = (MARGIN_S * recording.rows_per_second()).ceil() as usize;
    let mut found: Vec<Limited> = Vec::new();
    for side in &sides {
        let own = side.joint * rows..(side.joint + 1) * rows;
        let asked = Asked { torque: &asked[own.clone()], deviation: &|row| deviation(own.start + row) };
        let limited = side.limited(torque(side.joint), &asked, &is_near[own.clone()], margin);
        let is_explained = |limited: &Limited| rms(&all.errors(limited.joint)) < GAIN * limited.usual_error;
        let Some(limited) = limited.filter(|limited| !is_explained(limited)) else { continue };
        match found.last_mut().filter(|last| last.joint == limited.joint) {
            Some(other_side) => other_side.extend(&limited),
            None => found.push(limited),
        }
    }
    Some(found)
}

/// The sides of a joint's torque on which it may be limited.
fn sides(joint: usize, torque: &[f64]) -> Vec<Side> {
    let extremes = [1.0, -1.0].map(|sign| {
        let along: Vec<f64> = torque.iter().map(|v| sign * v).collect();
        Side { joint, sign, extreme: quantile(&along, EXTREME) }
    });
    let largest = extremes.iter().map(|side| side.extreme).fold(0.0, f64::max);
    let is_side = |side: &Side| {
        let near = torque.iter().filter(|v| side.is_near(**v)).count() as f64;
        side.extreme > LEAST_SIDE * largest && near < MOST_NEAR * torque.len() as f64
    };
    extremes.into_iter().filter(is_side).collect()
}

impl Side {
    fn is_near(&self, torque: f64) -> bool {
        self.sign * torque > NEAR * self.extreme
    }

    /// The limit on this side, if the rows for which the fit asks for more are at it.
    fn limited(&self, torque: &[f64], by_fit: &Asked<'_>, is_near: &[bool], margin: usize) -> Option<Limited> {
        let others = (0..torque.len()).filter(|&i| !is_near[i]).map(|i| torque[i] - by_fit.torque[i]);
        let usual_error = NORMAL_PER_MEDIAN * quantile_abs(others, 0.5);
        let clear = CLEAR.max(USUAL_ERRORS * usual_error / self.extreme);
        if clear > MOST_CLEAR {
            return None;
        }
        let asked = |i: usize| self.sign * by_fit.torque[i] / self.extreme;
        let is_more = |i: usize, than: f64| {
            asked(i) > than && asked(i) - USUAL_ERRORS * (by_fit.deviation)(i) / self.extreme > than
        };
        let is_at_limit = |i: usize| (self.sign * torque[i] / self.extreme - 1.0).abs() < CLEAR;
        let more: Vec<usize> = (0..torque.len()).filter(|&i| is_more(i, 1.0 + clear)).collect();
        let count = more.iter().filter(|i| is_at_limit(**i)).count();
        if count < FEWEST_ROWS || (count as f64) < AT_LIMIT * more.len() as f64 {
            return None;
        }
        let (torques_beyond, asked_beyond): (Vec<f64>, Vec<f64>) = (0..torque.len())
            .filter(|&i| asked(i) > 1.0)
            .map(|i| (self.sign * torque[i] / self.extreme, asked(i)))
            .unzip();
        if slope(&torques_beyond, &asked_beyond) > MOST_SLOPE {
            return None;
        }
        let most = more.iter().map(|&i| asked(i)).fold(0.0, f64::max);
        let is_limited = |i: usize| asked(i) > 1.0 - CLEAR && is_at_limit(i);
        let around = |i: usize| i.saturating_sub(margin)..(i + margin + 1).min(torque.len());
        let is_limited = (0..torque.len()).map(|i| around(i).any(is_limited)).collect();
        let (value, asked) = (self.extreme, most * self.extreme);
        Some(Limited { joint: self.joint, value, asked, usual_error, count, is_limited })
    }
}

/// Slope of `y` over `x`.
fn slope(y: &[f64], x: &[f64]) -> f64 {
    correlation(y, x) * deviation(y) / deviation(x)
}

#[cfg(test)]
mod tests {
    use thetahat_testing::noise;

    use super::{Asked, Side};

    const ROWS: usize = 600;
    const SIDE: Side = Side { joint: 0, sign: 1.0, extreme: 1.0 };

    fn is_limited(torque: &[f64], asked: &[f64], deviation: f64) -> bool {
        let is_near: Vec<bool> = torque.iter().map(|t| SIDE.is_near(*t)).collect();
        SIDE.limited(torque, &Asked { torque: asked, deviation: &|_| deviation }, &is_near, 2).is_some()
    }

    /// A torque of 1.2 that a drive limits to 1, with noise after it.
    #[test]
    fn a_torque_that_stays_at_a_level_while_the_motion_asks_for_more_is_limited() {
        let mut noise = noise();
        let asked: Vec<f64> = (0..ROWS).map(|i| 1.2 * (0.05 * i as f64).sin()).collect();
        let torque: Vec<f64> = asked.iter().map(|asked| asked.min(1.0) + 0.005 * noise()).collect();
        assert!(is_limited(&torque, &asked, 0.01));
        assert!(!is_limited(&torque, &asked, 0.06), "what it asks for is no more than its errors");
    }

    /// Gravity over strokes of constant velocity, to which friction adds: a fit that has not seen the strokes of that direction asks for
    /// 8 % too much, of a torque that follows it.
    #[test]
    fn a_torque_that_follows_what_a_wrong_fit_asks_for_is_not_limited() {
        let mut noise = noise();
        let forward = |i: usize| (i / 100).is_multiple_of(2);
        let torque = |i: usize| if forward(i) { 0.97 + 0.03 * (0.02 * i as f64).sin() } else { -0.5 };
        let asked: Vec<f64> = (0..ROWS).map(|i| torque(i) + if forward(i) { 0.08 } else { 0.0 }).collect();
        let torque: Vec<f64> = (0..ROWS).map(|i| torque(i) + 0.005 * noise()).collect();
        assert!(!is_limited(&torque, &asked, 0.0));
    }
}
