//! Torques of another clock: late or early by more than the search for lags reaches, where nothing else explains them.

use super::lag_search::{self, later, shifted};
use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::thinned_recording::ThinnedRecording,
    remedy_step::RemedyStep,
};
use thetahat_ground::linear_algebra::dot;

/// Longest lag, s, and as a part of the recording.
const LONGEST_S: f64 = 5.0;
const LONGEST_PART: f64 = 0.1;
/// Part of the squared torques left unexplained above which it is looked for.
const POOR: f64 = 0.02;
/// Factor by which it must reduce the squared residual.
const GAIN: f64 = 4.0;
/// Factor within which the shortest of several lags is taken: those of a motion that repeats are a period apart.
const SHORTEST_WITHIN: f64 = 1.2;
/// Operations of the search up to which it is made.
const MOST_WORK: f64 = 1e10;

/// Corrects a lag of all torques that explains much of what nothing else explains.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &mut ThinnedRecording<'_>) {
    let Ok(fit) = recording.fit() else { return };
    if fit.squares < POOR * dot(&fit.y, &fit.y) {
        return;
    }
    let longest = (LONGEST_S * recording.rate_hz).min(LONGEST_PART * recording.torque.len() as f64) as isize;
    let work = 8.0 * longest as f64 * (fit.x.rows() * fit.x.columns()) as f64;
    if longest < 1 || work > MOST_WORK {
        return;
    }
    let squares = |step: isize| {
        let rest = fit.unexplained(&later(recording, step));
        dot(&rest, &rest)
    };
    let all: Vec<(isize, f64)> = (-longest..=longest).map(|step| (step, squares(step))).collect();
    let least = all.iter().map(|(_, squares)| *squares).fold(f64::INFINITY, f64::min);
    let is_near_best = |step: isize, squares: f64| step.abs() < longest && squares <= SHORTEST_WITHIN * least;
    let near_best = all.iter().filter(|(step, squares)| is_near_best(*step, *squares));
    let Some(&(near, _)) = near_best.min_by_key(|(step, _)| step.abs()) else { return };
    let steps = refined(&all, best_around(&all, near));
    let samples = steps * exam.subject.sample_rate_hz / recording.rate_hz;
    let gain = fit.squares / least;
    let evidence = Evidence { code: Code::Lag, coordinate: None, value: samples, unit: "samples", limit: f64::NAN };
    let is_beyond = steps.abs() > lag_search::LONGEST_S * recording.rate_hz;
    if gain > GAIN && is_beyond {
        exam.raise(evidence, Severity::Problem, finding_text(samples / exam.subject.sample_rate_hz, gain));
        recording.replace_torque(shifted(&recording.torque, &vec![steps; recording.coordinates()]));
    }
}

fn finding_text(delay_s: f64, gain: f64) -> FindingText {
    let delay_s = (1e5 * delay_s).round() / 1e5;
    let order = if delay_s > 0.0 { "later" } else { "earlier" };
    let message = format!(
        "the torques fit {:.1} times better if they are {:.3} s {order} than the positions: the two are of different clocks",
        gain.sqrt(),
        delay_s.abs()
    );
    let remedy =
        format!("log both by one clock, or state the delay of the torque: delay_s = {delay_s} next to its columns");
    FindingText::new(message, remedy).with_step(RemedyStep::Delay { delay_s, joints: Vec::new() })
}

/// The place of the least residual from a step downwards on both sides.
fn best_around(all: &[(isize, f64)], step: isize) -> usize {
    let mut place = all.iter().position(|(other, _)| *other == step).unwrap_or(0);
    loop {
        let next = [place.checked_sub(1), Some(place + 1)];
        let lower = next.into_iter().flatten().filter(|&k| all.get(k).is_some_and(|(_, s)| *s < all[place].1));
        match lower.min_by(|a, b| all[*a].1.total_cmp(&all[*b].1)) {
            Some(lower) => place = lower,
            None => return place,
        }
    }
}

/// The minimum of the parabola through a minimum and its neighbours, in steps.
fn refined(all: &[(isize, f64)], place: usize) -> f64 {
    let step = all[place].0 as f64;
    let (Some(before), Some(after)) = (place.checked_sub(1).map(|k| all[k].1), all.get(place + 1).map(|(_, s)| *s))
    else {
        return step;
    };
    let curvature = before - 2.0 * all[place].1 + after;
    if curvature > 0.0 { step + 0.5 * (before - after) / curvature } else { step }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_is_found_between_steps() {
        let all: Vec<(isize, f64)> = (-20..=20).map(|k| (k, 3.0 + (k as f64 - 7.3).powi(2))).collect();
        assert!((refined(&all, best_around(&all, 5)) - 7.3).abs() < 1e-9);
        assert_eq!(refined(&all, 0), -20.0);
    }
}
