//! Angles that a counter wraps to one turn, made continuous again.

use std::f64::consts::TAU;

use thetahat_ground::series::Series;

/// Part of a turn from which a step between two samples may be a wrap.
const JUMP: f64 = 0.75;
/// Largest other step: a motion that goes further between two samples cannot be distinguished from a wrap.
const LARGEST_STEP: f64 = 0.25 * TAU;
/// By how many of the largest other steps a wrap may differ from a whole turn.
const STEPS: f64 = 2.0;
/// Least difference that is allowed, rad: a joint that hardly moves between two samples.
const LEAST: f64 = 1e-2;

/// A channel that wrapped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Wraps {
    /// The channel, from zero.
    pub(crate) channel: usize,
    /// How often.
    pub(crate) count: usize,
}

/// Adds the turns that were lost to each channel of angles in rad whose jumps are all of one turn.
pub(crate) fn unwrap(series: &mut Series, is_angle: impl Fn(usize) -> bool) -> Vec<Wraps> {
    let angles = (0..series.channels()).filter(|&channel| is_angle(channel));
    let found: Vec<(Wraps, Vec<f64>)> = angles.filter_map(|c| unwrapped(c, &series.channel(c))).collect();
    for (wraps, turns) in &found {
        turns.iter().enumerate().for_each(|(k, turns)| series.sample_mut(k)[wraps.channel] += TAU * turns);
    }
    found.into_iter().map(|(wraps, _)| wraps).collect()
}

/// The turns to add to each sample; none if the channel has no jump, or one that is not of one turn.
fn unwrapped(channel: usize, angles: &[f64]) -> Option<(Wraps, Vec<f64>)> {
    let mut last = f64::NAN;
    // A value that is missing makes no step.
    let known = angles.iter().map(|angle| {
        last = if angle.is_finite() { *angle } else { last };
        last
    });
    let known: Vec<f64> = known.collect();
    let steps: Vec<f64> = known.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let is_jump = |step: &f64| step.abs() > JUMP * TAU;
    let largest = steps.iter().filter(|step| !is_jump(step)).fold(0.0, |most: f64, step| most.max(step.abs()));
    let difference = (STEPS * largest).max(LEAST);
    let is_turn = |step: &f64| (step.abs() - TAU).abs() <= difference;
    let count = steps.iter().filter(|step| is_jump(step)).count();
    if count == 0 || largest > LARGEST_STEP || !steps.iter().filter(|step| is_jump(step)).all(is_turn) {
        return None;
    }
    let mut turns = vec![0.0; angles.len()];
    for (k, step) in steps.iter().enumerate() {
        turns[k + 1] = turns[k] - if is_jump(step) { step.signum() } else { 0.0 };
    }
    Some((Wraps { channel, count }, turns))
}

/// Takes whole turns off a reference that starts turns away from its positions.
pub(crate) fn align(reference: &mut Series, position: &Series, is_angle: impl Fn(usize) -> bool) {
    if reference.is_empty() || position.is_empty() {
        return;
    }
    for channel in (0..reference.channels()).filter(|&c| c < position.channels() && is_angle(c)) {
        let turns = ((reference.sample(0)[channel] - position.sample(0)[channel]) / TAU).round();
        (0..reference.len()).for_each(|k| reference.sample_mut(k)[channel] -= TAU * turns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wrapped(angle: f64, least: f64) -> f64 {
        (angle - least).rem_euclid(TAU) + least
    }

    #[test]
    fn a_turning_joint_is_continuous_again() {
        let angle = |k: usize| 0.02 * k as f64 - 3e-5 * (k * k) as f64;
        for least in [-TAU / 2.0, 0.0] {
            let mut series = Series::shaped(1, (0..2000).map(|k| wrapped(angle(k), least)).collect());
            let found = unwrap(&mut series, |_| true);
            assert!(found.len() == 1 && found[0].count > 3, "{found:?}");
            let offset = series.sample(0)[0] - angle(0);
            assert!((0..2000).all(|k| (series.sample(k)[0] - angle(k) - offset).abs() < 1e-9));
        }
    }

    #[test]
    fn a_jump_that_is_no_turn_stays() {
        let values: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k) + if k > 50 { 5.5 } else { 0.0 }).collect();
        let mut series = Series::shaped(1, values.clone());
        assert!(unwrap(&mut series, |_| true).is_empty());
        assert_eq!(series.values(), values);
    }

    #[test]
    fn a_sliding_joint_does_not_wrap() {
        let mut series = Series::shaped(1, (0..100).map(|k| wrapped(0.1 * f64::from(k), 0.0)).collect());
        assert!(unwrap(&mut series, |_| false).is_empty());
    }

    #[test]
    fn a_reference_starts_in_the_turn_of_its_positions() {
        let position = Series::shaped(1, vec![3.1, 3.2, 3.3]);
        let mut reference = Series::shaped(1, vec![-3.15, -3.05, -2.95]);
        align(&mut reference, &position, |_| true);
        assert!((reference.sample(2)[0] - (TAU - 2.95)).abs() < 1e-12);
    }
}
