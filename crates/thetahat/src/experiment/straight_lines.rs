//! Samples on straight lines between values of a lower rate, as where a logger brings signals of several rates to one clock.

use std::ops::Range;

use thetahat_ground::{interpolation::lagrange_weights, series::Series, stretches::stretches_of_equal};

/// Second difference, as a part of its rms over the series, below which a sample is on the line of its neighbours.
const ON_LINE: f64 = 0.02;
/// Longest line between two values, samples: longer ones are rests and constant speeds.
const LONGEST_LINE: usize = 64;
/// Most samples in a row off a line at the end of one: the value, or its two neighbours if it lies between samples.
const LONGEST_BEND: usize = 2;
/// Part of the samples that must be on such lines.
const LEAST_PART: f64 = 0.3;
/// Bends of a channel that is not quantised, in its smallest steps: a slow motion in coarse steps has lines as well.
const STEPS: f64 = 4.0;
/// Values on either side through which a cubic goes.
const NODES: usize = 2;

/// A series of which the samples between the values of a lower rate are interpolated anew.
#[derive(Debug, PartialEq)]
pub(super) struct Straightened {
    /// Cubics through the values.
    pub(super) series: Series,
    /// Samples that are on lines between two values.
    pub(super) on_lines: usize,
}

/// A value of the lower rate, at a sample or between two.
struct Node {
    place: f64,
    value: Vec<f64>,
}

/// The series with cubics through the values that straight lines join; none if few samples are on such lines.
pub(super) fn without_straight_lines(series: &Series) -> Option<Straightened> {
    let bends = Bends::of(series)?;
    let lines = bends.short_lines();
    let on_lines = lines.iter().map(Range::len).sum::<usize>();
    if (on_lines as f64) < LEAST_PART * series.len() as f64 || bends.are_coarse(series) {
        return None;
    }
    let nodes = bends.nodes(series, &lines);
    let mut cubic = series.clone();
    let mut after = 0;
    for k in 0..series.len() {
        after += nodes[after..].iter().take_while(|node| node.place <= k as f64).count();
        if after == 0 || after == nodes.len() || nodes[after - 1].place == k as f64 {
            continue;
        }
        let around = &nodes[after.saturating_sub(NODES)..(after + NODES).min(nodes.len())];
        interpolate(around, k as f64, cubic.sample_mut(k));
    }
    Some(Straightened { series: cubic, on_lines })
}

/// The polynomial through the nodes.
fn interpolate(nodes: &[Node], place: f64, value: &mut [f64]) {
    value.fill(0.0);
    let places: Vec<f64> = nodes.iter().map(|node| node.place).collect();
    for (node, weight) in nodes.iter().zip(lagrange_weights(&places, place)) {
        value.iter_mut().zip(&node.value).for_each(|(sum, v)| *sum += weight * v);
    }
}

/// Where the series is not straight.
struct Bends {
    /// Rms of the second differences of each channel.
    scale: Vec<f64>,
    /// Whether each sample is off the line of its neighbours.
    is_bent: Vec<bool>,
}

impl Bends {
    /// None of a series that is too short or does not move.
    fn of(series: &Series) -> Option<Self> {
        let inside = 1..series.len().checked_sub(1).filter(|end| *end > LONGEST_LINE)?;
        let channels = 0..series.channels();
        let rms = |j| {
            let sum = inside.clone().map(|k| second_difference(series, k, j).powi(2)).sum::<f64>();
            (sum / inside.len() as f64).sqrt()
        };
        let scale: Vec<f64> = channels.clone().map(rms).collect();
        let is_off = |k: usize| channels.clone().any(|j| second_difference(series, k, j).abs() > ON_LINE * scale[j]);
        let is_bent = (0..series.len()).map(|k| inside.contains(&k) && is_off(k)).collect();
        scale.iter().any(|s| *s > 0.0).then_some(Self { scale, is_bent })
    }

    /// The samples on a line between two values: stretches that are straight and end at short bends.
    fn short_lines(&self) -> Vec<Range<usize>> {
        // Straight and bent ones in turn.
        let stretches = stretches_of_equal(&self.is_bent);
        let is_bent = |stretch: &Range<usize>| self.is_bent[stretch.start];
        let is_value = |stretch: &Range<usize>| is_bent(stretch) && stretch.len() <= LONGEST_BEND;
        let is_line = |stretch: &Range<usize>| !is_bent(stretch) && stretch.len() <= LONGEST_LINE;
        let three =
            stretches.windows(3).filter(|three| is_value(&three[0]) && is_line(&three[1]) && is_value(&three[2]));
        three.map(|three| three[1].clone()).collect()
    }

    /// Whether the bends of a channel that moves are a few of its smallest steps.
    fn are_coarse(&self, series: &Series) -> bool {
        let bent = || (0..series.len()).filter(|&k| self.is_bent[k]);
        let is_coarse = |j: usize| {
            let steps = (1..series.len()).map(|k| (series.sample(k)[j] - series.sample(k - 1)[j]).abs());
            let smallest = steps.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
            let squares = bent().map(|k| second_difference(series, k, j).powi(2)).sum::<f64>();
            (squares / bent().count().max(1) as f64).sqrt() < STEPS * smallest
        };
        (0..series.channels()).any(|j| self.scale[j] > 0.0 && is_coarse(j))
    }

    /// The values of the lower rate between the lines, and all other samples.
    fn nodes(&self, series: &Series, lines: &[Range<usize>]) -> Vec<Node> {
        let mut is_on_line = vec![false; series.len()];
        lines.iter().for_each(|line| is_on_line[line.clone()].fill(true));
        let at = |k: usize| Node { place: k as f64, value: series.sample(k).to_vec() };
        let mut nodes = Vec::new();
        let mut k = 0;
        while k < series.len() {
            let is_between = k > 0
                && k + 2 < series.len()
                && is_on_line[k - 1]
                && is_on_line[k + 2]
                && !is_on_line[k]
                && !is_on_line[k + 1];
            match is_between.then(|| self.crossing(series, k)) {
                Some(node) => {
                    nodes.push(node);
                    k += 2;
                }
                None => {
                    nodes.extend((!is_on_line[k]).then(|| at(k)));
                    k += 1;
                }
            }
        }
        nodes
    }

    /// Where the line that ends at sample `k` meets the one that starts at the next, by least squares over the channels.
    fn crossing(&self, series: &Series, k: usize) -> Node {
        let step = |i: usize, j: usize| series.sample(i + 1)[j] - series.sample(i)[j];
        let (mut turned, mut apart) = (0.0, 0.0);
        for j in (0..series.channels()).filter(|&j| self.scale[j] > 0.0) {
            let turn = (step(k + 1, j) - step(k - 1, j)) / self.scale[j];
            turned += turn * turn;
            apart += turn * (step(k + 1, j) - step(k, j)) / self.scale[j];
        }
        let part = (apart / turned).clamp(0.0, 1.0);
        let value = (0..series.channels()).map(|j| series.sample(k)[j] + part * step(k - 1, j)).collect();
        Node { place: k as f64 + part, value }
    }
}

fn second_difference(series: &Series, k: usize, j: usize) -> f64 {
    series.sample(k + 1)[j] - 2.0 * series.sample(k)[j] + series.sample(k - 1)[j]
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: usize = 2000;

    fn motion(t: f64) -> [f64; 2] {
        [(0.021 * t).sin() + 0.2 * (0.05 * t).cos(), 0.5 * (0.033 * t + 1.0).sin()]
    }

    fn sampled(at: impl Fn(usize) -> [f64; 2]) -> Series {
        Series::shaped(2, (0..SAMPLES).flat_map(at).collect())
    }

    /// The motion on lines between values that are `every` samples apart, the first of them `start` samples in.
    fn joined(every: f64, start: f64) -> Series {
        sampled(|k| {
            let before = ((k as f64 - start) / every).floor();
            let [a, b] = [before, before + 1.0].map(|n| motion(start + n * every));
            let part = (k as f64 - start) / every - before;
            [0, 1].map(|j| a[j] + part * (b[j] - a[j]))
        })
    }

    fn largest_error(series: &Series) -> f64 {
        let error = |k: usize| (0..2).map(move |j| (series.sample(k)[j] - motion(k as f64)[j]).abs());
        (100..SAMPLES - 100).flat_map(error).fold(0.0, f64::max)
    }

    #[test]
    fn values_on_samples_and_between_them_are_found() {
        for (every, start) in [(2.0, 0.0), (8.0, 0.0), (8.0, 0.4), (6.7, 0.2), (12.0, 3.0)] {
            let lines = joined(every, start);
            let found = without_straight_lines(&lines).unwrap_or_else(|| panic!("{every} {start}"));
            let (before, after) = (largest_error(&lines), largest_error(&found.series));
            assert!(after < 0.1 * before, "{every} {start}: {before:.1e}, {after:.1e}");
        }
    }

    #[test]
    fn smooth_motion_noise_coarse_steps_and_moves_at_constant_speed_are_left_alone() {
        assert_eq!(without_straight_lines(&sampled(|k| motion(k as f64))), None);
        let noise = |k: usize| 1e-4 * (12.9898 * k as f64).sin() * (78.233 * k as f64).cos();
        assert_eq!(without_straight_lines(&sampled(|k| motion(k as f64).map(|q| q + noise(k)))), None);
        for step in [1e-4, 1e-3, 1e-2, 5e-2] {
            let coarse = sampled(|k| motion(k as f64).map(|q| (q / step).round() * step));
            assert_eq!(without_straight_lines(&coarse), None, "{step}");
        }
        // 20 samples of acceleration, 40 of constant speed, 20 of braking, there and back.
        let mut speed = 0.0;
        let mut position = 0.0;
        let trapezoids: Vec<f64> = (0..SAMPLES)
            .map(|k| {
                let sign = if (k / 80) % 2 == 0 { 1.0 } else { -1.0 };
                speed += sign * f64::from(i8::from(k % 80 < 20) - i8::from(k % 80 >= 60));
                position += 1e-3 * speed;
                position
            })
            .collect();
        assert_eq!(without_straight_lines(&Series::shaped(1, trapezoids)), None);
        assert_eq!(without_straight_lines(&Series::zeros(SAMPLES, 2)), None);
    }
}
