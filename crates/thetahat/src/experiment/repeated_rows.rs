//! Rows that a logger repeats because it asks more often than there are new values.

use thetahat_ground::{interpolation::lagrange_weights, series::Series};

/// Part of the rows that must be repeats: fewer are accidents, which the checks name.
const LEAST_PART: f64 = 0.02;
/// The same of rows that repeat the positions alone, and of long runs: the positions are read at a lower rate.
const HELD_PART: f64 = 0.2;
/// Longest run of repeats that is bridged, rows.
const LONGEST_RUN: usize = 4;
/// The same of positions that are read at a lower rate.
const LONGEST_HOLD: usize = 16;
/// Steps of its resolution that some joint travels for each row of a run: with fewer, equal rows are a coincidence of slow motion.
const STEPS: f64 = 4.0;
/// New values on either side that a bridge is made of.
const NODES: usize = 2;

/// The rows whose positions, and whose torques or most rows' positions alone, are those of the row before while the robot moves; none
/// if they are few.
pub(super) fn repeated_rows(position: &Series, torque: Option<&Series>) -> Option<Vec<usize>> {
    let is_held = |k: usize| position.sample(k) == position.sample(k - 1);
    let is_repeated = |k: usize| is_held(k) && torque.is_none_or(|torque| torque.sample(k) == torque.sample(k - 1));
    if !(1..position.len()).any(is_held) {
        return None;
    }
    let wanted = |part: f64| move |rows: &Vec<usize>| rows.len() as f64 >= part * position.len() as f64;
    let held = runs(position, is_held, LONGEST_HOLD);
    if wanted(HELD_PART)(&moving(position, &held)) {
        return Some(held.concat());
    }
    Some(moving(position, &runs(position, is_repeated, LONGEST_RUN))).filter(wanted(LEAST_PART))
}

/// The runs of equal rows that are no longer than `longest`.
fn runs(position: &Series, is_same: impl Fn(usize) -> bool, longest: usize) -> Vec<Vec<usize>> {
    let rows = position.len();
    let mut runs = Vec::new();
    let mut k = 1;
    while k < rows {
        let end = (k..rows).find(|&i| !is_same(i)).unwrap_or(rows);
        if end < rows && end > k && end - k <= longest {
            runs.push((k..end).collect());
        }
        k = end + 1;
    }
    runs
}

/// The rows of the runs during which some joint moves.
fn moving(position: &Series, runs: &[Vec<usize>]) -> Vec<usize> {
    let resolutions: Vec<f64> = (0..position.channels()).map(|j| resolution(position, j)).collect();
    let travels = |run: &&Vec<usize>| {
        let (before, after) = (position.sample(run[0] - 1), position.sample(run[run.len() - 1] + 1));
        let least = STEPS * (run.len() + 1) as f64;
        (0..resolutions.len()).any(|j| (after[j] - before[j]).abs() >= least * resolutions[j])
    };
    runs.iter().filter(travels).flatten().copied().collect()
}

/// The smallest step of a channel.
fn resolution(series: &Series, channel: usize) -> f64 {
    let steps = (1..series.len()).map(|k| (series.sample(k)[channel] - series.sample(k - 1)[channel]).abs());
    steps.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min)
}

/// The series with the repeated rows replaced by what the new values around them interpolate.
pub(super) fn bridged(series: &Series, repeated: &[usize]) -> Series {
    let mut is_new = vec![true; series.len()];
    repeated.iter().for_each(|&k| is_new[k] = series.sample(k) != series.sample(k - 1));
    let mut bridged = series.clone();
    for &k in repeated.iter().filter(|&&k| !is_new[k]) {
        let before = (0..k).rev().filter(|&i| is_new[i]).take(NODES);
        let after = (k + 1..series.len()).filter(|&i| is_new[i]).take(NODES);
        let nodes: Vec<usize> = before.chain(after).collect();
        let places: Vec<f64> = nodes.iter().map(|&node| node as f64).collect();
        let sample = bridged.sample_mut(k);
        sample.fill(0.0);
        for (&node, weight) in nodes.iter().zip(lagrange_weights(&places, k as f64)) {
            sample.iter_mut().zip(series.sample(node)).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    bridged
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cubic(k: usize) -> f64 {
        let t = 0.1 * k as f64;
        t * t * t - 2.0 * t + 1.0
    }

    /// A cubic is met exactly, at single repeats and at two in a row.
    #[test]
    fn repeats_of_a_motion_are_interpolated() {
        let mut values: Vec<f64> = (0..60).map(cubic).collect();
        for k in [15, 16, 20, 33, 50] {
            values[k] = values[k - 1];
        }
        let recorded = Series::shaped(1, values);
        let repeated = repeated_rows(&recorded, None).unwrap();
        assert_eq!(repeated, [15, 16, 20, 33, 50]);
        let found = bridged(&recorded, &repeated);
        for k in 0..60 {
            assert!((found.sample(k)[0] - cubic(k)).abs() < 1e-9, "{k}");
        }
    }

    #[test]
    fn rests_slow_motion_on_a_coarse_encoder_and_few_repeats_are_left_alone() {
        let rest: Vec<f64> = (0..100).map(|k| if k < 50 { 0.0 } else { f64::from(k) }).collect();
        assert_eq!(repeated_rows(&Series::shaped(1, rest), None), None);
        let coarse: Vec<f64> = (0..100).map(|k| f64::from(k / 3)).collect();
        assert_eq!(repeated_rows(&Series::shaped(1, coarse), None), None);
        let mut once: Vec<f64> = (0..100).map(cubic).collect();
        once[70] = once[69];
        assert_eq!(repeated_rows(&Series::shaped(1, once), None), None);
    }

    /// A torque that is new says that the row is, unless positions are read at a lower rate.
    #[test]
    fn single_rows_with_a_new_torque_are_no_repeats() {
        let torque = Series::shaped(1, (0..60).map(f64::from).collect());
        let every = |n: usize| Series::shaped(1, (0..60).map(|k| cubic(k - k % n)).collect());
        for n in [2, 4, 8] {
            let repeated = repeated_rows(&every(n), Some(&torque)).unwrap();
            let found = bridged(&every(n), &repeated);
            let inside = n..60 - 2 * n;
            assert!(inside.clone().all(|k| (found.sample(k)[0] - cubic(k)).abs() < 1e-9), "{n}");
            assert_eq!(bridged(&torque, &repeated), torque);
        }
        let mut once: Vec<f64> = (0..60).map(cubic).collect();
        for k in [15, 20, 33, 50] {
            once[k] = once[k - 1];
        }
        assert!(repeated_rows(&Series::shaped(1, once.clone()), None).is_some());
        assert_eq!(repeated_rows(&Series::shaped(1, once), Some(&torque)), None);
    }
}
