//! Finds the gaps in the time steps of a recording.

use std::ops::Range;

/// Time missing around a long step, in steps, that makes it a gap: if less is missing, the stamp is late and the next steps compensate.
const LASTING: f64 = 0.75;
/// Number of steps on either side within which late stamps are compensated.
const AROUND: usize = 2;

/// The steps of a recording, divided into gaps and others.
pub(super) struct Stretches {
    is_gap: Vec<bool>,
    /// Number of usual steps from the first time to the last.
    pub(super) steps: usize,
}

impl Stretches {
    /// A step is a gap if it is longer than the median by more than `largest_jitter` of it, and the neighbouring steps do not compensate
    /// for it. The mean of the others is the usual step: it does not contain the rounding of the times.
    pub(super) fn of(steps: &[f64], largest_jitter: f64) -> Self {
        let median = median(steps);
        let late: Vec<f64> = steps.iter().map(|step| step / median - 1.0).collect();
        let around = |k: usize| late[k.saturating_sub(AROUND)..(k + AROUND + 1).min(late.len())].iter().sum::<f64>();
        let is_gap: Vec<bool> =
            (0..steps.len()).map(|k| late[k] > largest_jitter && around(k) > LASTING.min(late[k])).collect();
        let regular: Vec<f64> = steps.iter().zip(&is_gap).filter(|(_, gap)| !**gap).map(|(step, _)| *step).collect();
        let usual = if regular.is_empty() { median } else { regular.iter().sum::<f64>() / regular.len() as f64 };
        let whole = |(step, gap): (&f64, &bool)| if *gap { (step / usual).round().max(1.0) } else { 1.0 };
        Self { steps: steps.iter().zip(&is_gap).map(whole).sum::<f64>() as usize, is_gap }
    }

    /// The values of the steps that are not gaps.
    pub(super) fn regular(&self, of_steps: &[f64]) -> Vec<f64> {
        of_steps.iter().zip(&self.is_gap).filter(|(_, gap)| !**gap).map(|(value, _)| *value).collect()
    }

    /// The samples at equal steps from the first stamp on that are more than half a step away from both ends of a gap.
    pub(super) fn missing_samples(&self, stamps: &[f64], step: f64) -> Vec<Range<usize>> {
        let place = |stamp: f64| (stamp - stamps[0]) / step;
        let between =
            |k: usize| (place(stamps[k]) + 0.5).floor() as usize + 1..(place(stamps[k + 1]) - 0.5).ceil() as usize;
        let gaps = (0..self.is_gap.len()).filter(|&k| self.is_gap[k]).map(between);
        gaps.filter(|range| !range.is_empty()).collect()
    }
}

fn median(steps: &[f64]) -> f64 {
    let mut sorted = steps.to_vec();
    let middle = (sorted.len() - 1) / 2;
    *sorted.select_nth_unstable_by(middle, f64::total_cmp).1
}
