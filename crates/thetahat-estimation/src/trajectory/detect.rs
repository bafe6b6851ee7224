//! Where the moves of a recording lie, and a first time law for each.

use std::ops::Range;

use super::{TimeLaw, TrajectoryError};
use thetahat_ground::{series::Series, stretches::stretches_where};

/// A joint travels if its range is above this fraction of the largest range ...
const LEAST_TRAVEL: f64 = 1e-2;
/// ... and above this many standard deviations of its noise: the range of noise alone stays below ten.
const LEAST_TRAVEL_IN_NOISE: f64 = 20.0;
/// The robot moves while its speed is above this fraction of the largest speed.
const MOVING: f64 = 0.05;
/// A move's peak is above this fraction of the largest speed; anything lower is noise.
const LEAST_PEAK: f64 = 0.25;
/// Shortest move, and least rest kept before the first and after the last move, in s.
const SHORTEST_S: f64 = 0.05;

/// The moves of a recording.
pub(super) struct Detection {
    /// First sample of each move, and last sample of the last one: a move runs from one boundary to the next.
    pub boundaries: Vec<usize>,
    /// One over the squared range of each joint that travels, zero for the others.
    pub joint_weights: Vec<f64>,
}

/// Finds the moves by the speed of the joints, each in units of its range.
pub(super) fn detect(position: &Series, velocity: &Series, rate: f64) -> Result<Detection, TrajectoryError> {
    let joint_weights = joint_weights(position);
    let speed: Vec<f64> = (0..velocity.len()).map(|k| weighted_norm(velocity.sample(k), &joint_weights)).collect();
    let runs = runs(&speed, rate);
    if runs.is_empty() {
        return Err(TrajectoryError::NoMotion { largest_range: ranges(position).into_iter().fold(0.0, f64::max) });
    }
    Ok(Detection { boundaries: boundaries(&speed, &runs, rate), joint_weights })
}

fn ranges(position: &Series) -> Vec<f64> {
    let range = |x: Vec<f64>| x.iter().copied().fold(f64::MIN, f64::max) - x.iter().copied().fold(f64::MAX, f64::min);
    (0..position.channels()).map(|j| range(position.channel(j))).collect()
}

fn joint_weights(position: &Series) -> Vec<f64> {
    let ranges = ranges(position);
    let least = LEAST_TRAVEL * ranges.iter().copied().fold(0.0, f64::max);
    let travels = |j: usize, range: f64| range > least && range > LEAST_TRAVEL_IN_NOISE * noise(&position.channel(j));
    ranges.iter().enumerate().map(|(j, &range)| if travels(j, range) { 1.0 / (range * range) } else { 0.0 }).collect()
}

/// Standard deviation of white noise from the second differences, which hardly contain motion: their variance is 1 + 4 + 1 times the
/// noise's.
fn noise(x: &[f64]) -> f64 {
    let squares: f64 = x.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2)).sum();
    (squares / (6.0 * x.len() as f64)).sqrt()
}

fn weighted_norm(x: &[f64], weights: &[f64]) -> f64 {
    x.iter().zip(weights).map(|(x, w)| w * x * x).sum::<f64>().sqrt()
}

fn runs(speed: &[f64], rate: f64) -> Vec<Range<usize>> {
    let top = speed.iter().copied().fold(0.0, f64::max);
    let is_move = |run: &Range<usize>| {
        run.len() as f64 / rate >= SHORTEST_S && speed[run.clone()].iter().any(|v| *v > LEAST_PEAK * top)
    };
    stretches_where(0..speed.len(), |k| speed[k] > MOVING * top).into_iter().filter(is_move).collect()
}

/// Moves are separated at the lowest speed between them; some rest is kept before the first and after the last.
fn boundaries(speed: &[f64], runs: &[Range<usize>], rate: f64) -> Vec<usize> {
    let rest = |run: &Range<usize>| (run.len() / 4).max((SHORTEST_S * rate) as usize);
    let slowest = |from: usize, to: usize| (from..=to).min_by(|&a, &b| speed[a].total_cmp(&speed[b])).unwrap_or(from);
    let (first, last) = (&runs[0], &runs[runs.len() - 1]);
    let between = runs.windows(2).map(|pair| slowest(pair[0].end, pair[1].start));
    std::iter::once(first.start.saturating_sub(rest(first)))
        .chain(between)
        .chain([(last.end + rest(last)).min(speed.len() - 1)])
        .collect()
}

/// A first time law for the move in `window`, from the times at which `ds` crosses quarters of its plateau.
///
/// `ds` is the velocity projected on the displacement. The crossings at one half are T1 apart; each flank takes T2 / 2
/// from one quarter to three quarters.
pub(super) fn first_law(
    position: &Series,
    velocity: &Series,
    joint_weights: &[f64],
    window: Range<usize>,
    rate: f64,
) -> TimeLaw {
    let (from, to) = (position.sample(window.start), position.sample(window.end - 1));
    let along: Vec<f64> = (0..from.len()).map(|j| joint_weights[j] * (to[j] - from[j])).collect();
    let project = |dq: &[f64]| dq.iter().zip(&along).map(|(v, d)| v * d).sum::<f64>();
    let speed: Vec<f64> = window.clone().map(|k| project(velocity.sample(k))).collect();
    let [rising, falling] = crossings(&speed).map(|side| side.map(|k| (window.start as f64 + k) / rate));
    law_from_crossings(rising, falling, 2.0 / rate)
}

/// Fractional indices at which the flanks about the peak cross 1/4, 1/2 and 3/4 of the plateau.
fn crossings(speed: &[f64]) -> [[f64; 3]; 2] {
    let plateau = quantile(speed, 0.98);
    let peak = (0..speed.len()).max_by(|&a, &b| speed[a].total_cmp(&speed[b])).unwrap_or(0);
    let levels = [0.25 * plateau, 0.5 * plateau, 0.75 * plateau];
    let left = |level| peak as f64 - steps_until_below(speed[..=peak].iter().rev(), level);
    let right = |level| peak as f64 + steps_until_below(speed[peak..].iter(), level);
    [levels.map(left), levels.map(right)]
}

/// Steps until the values fall below `level`, by linear interpolation; the number of values if they never do.
fn steps_until_below<'a>(values: impl Iterator<Item = &'a f64>, level: f64) -> f64 {
    let mut steps = 0.0;
    let mut last = None;
    for &value in values {
        if value < level {
            return steps + last.map_or(0.0, |above: f64| (above - level) / (above - value) - 1.0);
        }
        (steps, last) = (steps + 1.0, Some(value));
    }
    steps
}

fn quantile(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * part) as usize]
}

fn law_from_crossings(rising: [f64; 3], falling: [f64; 3], shortest: f64) -> TimeLaw {
    let t1_s = (falling[1] - rising[1]).max(shortest);
    let flanks = (rising[2] - rising[0]) + (falling[0] - falling[2]);
    let t2_s = flanks.clamp(shortest, t1_s);
    let t3_s = 0.25 * t2_s;
    TimeLaw { start_s: (rising[1] + falling[1] - t1_s - t2_s - t3_s) / 2.0, t1_s, t2_s, t3_s }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_interpolated() {
        assert_eq!(steps_until_below([4.0, 3.0, 1.0].iter(), 2.0), 1.5);
        assert_eq!(steps_until_below([4.0, 3.0].iter(), 2.0), 2.0);
    }

    #[test]
    fn noise_of_a_parabola_is_its_curvature_only() {
        let x: Vec<f64> = (0..100).map(|k| f64::from(k * k) * 1e-4).collect();
        assert!(noise(&x) < 1e-4);
    }

    #[test]
    fn the_first_law_of_a_clean_trapezoid_is_close() {
        let law = TimeLaw { start_s: 0.1, t1_s: 0.4, t2_s: 0.2, t3_s: 0.02 };
        let at = |k: usize| law.evaluate(k as f64 / 1000.0);
        let q = Series::shaped(1, (0..900).map(|k| 2.0 * at(k).0).collect());
        let dq = Series::shaped(1, (0..900).map(|k| 2.0 * at(k).1).collect());
        let found = first_law(&q, &dq, &[1.0], 0..900, 1000.0);
        assert!((found.t1_s - law.t1_s).abs() < 5e-3 && (found.t2_s - law.t2_s).abs() < 5e-3);
        assert!((found.start_s - law.start_s).abs() < 0.03);
    }
}
