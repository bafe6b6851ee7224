//! Lags after which a motion repeats, and the stretch in which it does.

use std::ops::Range;

use crate::signal::delayed;
use thetahat_ground::series::Series;

/// Samples per period of the cut-off: the motion ends well below it.
const PER_CUTOFF: f64 = 2.5;
/// Most samples: the search time grows with the square of their number.
const MOST_SAMPLES: usize = 6000;
/// Fewest samples.
const FEWEST_SAMPLES: usize = 40;
/// Peak to peak, rad or m, up to which a joint counts as still.
const STILL: f64 = 1e-3;
/// Mean squared difference of two stretches, relative to that of unrelated stretches, below which one may repeat the other, and the
/// difference that must be exceeded between them.
const ALIKE: f64 = 0.1;
const UNLIKE: f64 = 0.3;
/// Most lags that are tried.
const MOST_LAGS: usize = 10;
/// Largest difference between a sample and the one a period later, relative to the joint's deviation from its mean.
const SAME: f64 = 0.1;

/// A motion with fewer samples.
pub(super) struct Thinned {
    /// Every joint's positions.
    pub(super) channels: Vec<Vec<f64>>,
    /// Standard deviation of each joint.
    pub(super) deviations: Vec<f64>,
    /// Joints that move.
    moving: Vec<usize>,
    pub(super) step_s: f64,
    first_s: f64,
}

impl Thinned {
    /// The low-passed motion in a window; none if nothing moves or there is too little of it.
    pub(super) fn new(position: &Series, window: &Range<usize>, rate: f64, cutoff_hz: f64) -> Option<Self> {
        let fine = (rate / (PER_CUTOFF * cutoff_hz)) as usize;
        let stride = fine.max(window.len().div_ceil(MOST_SAMPLES)).max(1);
        let thin = |j: usize| window.clone().step_by(stride).map(|k| position.sample(k)[j]).collect();
        let channels: Vec<Vec<f64>> = (0..position.channels()).map(thin).collect();
        let span = |x: &Vec<f64>| x.iter().fold(f64::MIN, |a, b| a.max(*b)) - x.iter().fold(f64::MAX, |a, b| a.min(*b));
        let moving: Vec<usize> = (0..channels.len()).filter(|&j| span(&channels[j]) > STILL).collect();
        let deviations = channels.iter().map(|x| deviation(x)).collect();
        let (step_s, first_s) = (stride as f64 / rate, window.start as f64 / rate);
        let enough = channels[0].len() >= FEWEST_SAMPLES && !moving.is_empty();
        enough.then_some(Self { channels, deviations, moving, step_s, first_s })
    }

    pub(super) fn samples(&self) -> usize {
        self.channels[0].len()
    }

    pub(super) fn joints(&self) -> usize {
        self.channels.len()
    }

    /// Time of a sample in the recording.
    pub(super) fn time_s(&self, k: usize) -> f64 {
        self.first_s + k as f64 * self.step_s
    }

    /// One over the variance of a joint; zero for a joint that does not move.
    pub(super) fn weight(&self, j: usize) -> f64 {
        if self.moving.contains(&j) { self.deviations[j].powi(-2) } else { 0.0 }
    }

    /// Difference between the motion and itself some samples later, without the drift: zero where it repeats, about one where the two are
    /// unrelated.
    fn difference(&self, lag: usize) -> f64 {
        let of_joint = |&j: &usize| {
            let (early, late) = (&self.channels[j], &self.channels[j][lag..]);
            let count = late.len() as f64;
            let (sum, squares) = late.iter().zip(early).fold((0.0, 0.0), |(sum, squares), (b, a)| {
                let difference = b - a;
                (sum + difference, squares + difference * difference)
            });
            (squares / count - (sum / count).powi(2)) * 0.5 * self.weight(j)
        };
        self.moving.iter().map(of_joint).sum::<f64>() / self.moving.len() as f64
    }
}

fn deviation(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len() as f64).sqrt()
}

/// The lags, in samples, shortest first, after which the motion may repeat.
pub(super) fn candidates(motion: &Thinned) -> Vec<f64> {
    let differences: Vec<f64> = (0..=motion.samples() * 11 / 20).map(|lag| motion.difference(lag)).collect();
    let Some(unlike) = differences.iter().position(|d| *d > UNLIKE) else { return Vec::new() };
    let lowest = |k: &usize| differences[*k] < differences[k - 1] && differences[*k] <= differences[k + 1];
    let lags = (unlike + 1..differences.len().saturating_sub(1)).filter(|k| differences[*k] < ALIKE && lowest(k));
    let between = |k: usize| {
        let [before, at, after] = [k - 1, k, k + 1].map(|k| differences[k]);
        let bend = before - 2.0 * at + after;
        k as f64 + if bend > 0.0 { 0.5 * (before - after) / bend } else { 0.0 }
    };
    lags.take(MOST_LAGS).map(between).collect()
}

/// The longest stretch in which every sample equals the one a period before or after; none if there is none.
pub(super) fn periodic_stretch(motion: &Thinned, lag: f64) -> Option<Range<usize>> {
    let count = motion.samples().checked_sub(lag.ceil() as usize + 1)?;
    let mut same = vec![true; count];
    for &j in &motion.moving {
        let later = delayed(&Series::side_by_side(&[motion.channels[j].clone()]), &[-lag]);
        let differences: Vec<f64> = (0..count).map(|k| later.sample(k)[0] - motion.channels[j][k]).collect();
        let mut sorted = differences.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let drift = sorted[count / 2];
        let limit = SAME * motion.deviations[j];
        same.iter_mut().zip(&differences).for_each(|(same, d)| *same &= (d - drift).abs() < limit);
    }
    let longest = longest_run(&same);
    (!longest.is_empty()).then(|| longest.start..(longest.end + lag.floor() as usize).min(motion.samples()))
}

/// The longest range of entries that are true.
fn longest_run(entries: &[bool]) -> Range<usize> {
    let (mut longest, mut start) = (0..0, 0);
    for (k, holds) in entries.iter().chain([&false]).enumerate() {
        if !holds {
            if k - start > longest.len() {
                longest = start..k;
            }
            start = k + 1;
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_run_is_found() {
        assert_eq!(longest_run(&[true, false, true, true, false, true]), 2..4);
        assert_eq!(longest_run(&[false, true, true]), 1..3);
        assert!(longest_run(&[false, false]).is_empty() && longest_run(&[]).is_empty());
    }
}
