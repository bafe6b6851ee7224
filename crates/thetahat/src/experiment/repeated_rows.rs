//! Rows that a logger repeats because it asks more often than there are new values.

use thetahat_ground::series::Series;

/// Part of the rows that must be repeats: fewer are accidents, which the checks name.
const LEAST_PART: f64 = 0.02;
/// Longest run of repeats that is bridged, rows.
const LONGEST_RUN: usize = 4;
/// Steps of its resolution that some joint travels for each row of a run: with fewer, equal rows are a coincidence of slow motion.
const STEPS: f64 = 4.0;
/// New values on either side that a bridge is made of.
const NODES: usize = 2;

/// The rows whose positions and torques are those of the row before while the robot moves; none if they are few.
pub(super) fn repeated_rows(position: &Series, torque: Option<&Series>) -> Option<Vec<usize>> {
    let same = |k: usize| {
        let torque_is_same = torque.is_none_or(|torque| torque.sample(k) == torque.sample(k - 1));
        torque_is_same && position.sample(k) == position.sample(k - 1)
    };
    let rows = position.len();
    if !(1..rows).any(same) {
        return None;
    }
    let resolutions: Vec<f64> = (0..position.channels()).map(|j| resolution(position, j)).collect();
    let mut repeated = Vec::new();
    let mut k = 1;
    while k < rows {
        let end = (k..rows).find(|&i| !same(i)).unwrap_or(rows);
        if end < rows && end > k && end - k <= LONGEST_RUN {
            let least = STEPS * (end - k + 1) as f64;
            let travels =
                |j: usize| (position.sample(end)[j] - position.sample(k - 1)[j]).abs() >= least * resolutions[j];
            if (0..position.channels()).any(travels) {
                repeated.extend(k..end);
            }
        }
        k = end.max(k) + 1;
    }
    (repeated.len() as f64 >= LEAST_PART * rows as f64).then_some(repeated)
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
        let sample = bridged.sample_mut(k);
        sample.fill(0.0);
        for &node in &nodes {
            let weight = lagrange_weight(node, &nodes, k);
            sample.iter_mut().zip(series.sample(node)).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    bridged
}

fn lagrange_weight(node: usize, nodes: &[usize], k: usize) -> f64 {
    let others = nodes.iter().filter(|&&other| other != node);
    others.map(|&other| (k as f64 - other as f64) / (node as f64 - other as f64)).product()
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

    /// A torque that is new says that the row is.
    #[test]
    fn rows_with_a_new_torque_are_no_repeats() {
        let position = Series::shaped(1, (0..60).map(|k| cubic(k - k % 2)).collect());
        let torque = Series::shaped(1, (0..60).map(f64::from).collect());
        assert!(repeated_rows(&position, None).is_some());
        assert_eq!(repeated_rows(&position, Some(&torque)), None);
    }
}
