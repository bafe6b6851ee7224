//! Samples that a logger wrote twice.

use thetahat_data::recording::Clock;
use thetahat_ground::series::Series;

/// The samples that are no copies, where some are: a copy has the time and all values of the sample before.
///
/// Doubled times with other values are those of a coarse clock, or of samples out of place: the clock judges them.
pub(super) fn without_copies(times: &[f64], series: &[&Series]) -> Option<Vec<usize>> {
    let same_time = |k: &usize| times[*k] == times[*k - 1];
    let same_values = |k: usize| series.iter().all(|s| s.sample(k) == s.sample(k - 1));
    // Where a coarse clock doubles the times, samples at rest may be alike and are none the less samples.
    if Clock::is_coarse(times) && !(1..times.len()).filter(same_time).all(same_values) {
        return None;
    }
    let same = |k: usize| same_time(&k) && same_values(k);
    let kept: Vec<usize> = (0..times.len()).filter(|&k| k == 0 || !same(k)).collect();
    (kept.len() < times.len()).then_some(kept)
}

/// Some samples of a series.
pub(super) fn selected(series: &Series, samples: &[usize]) -> Series {
    Series::shaped(series.channels(), samples.iter().flat_map(|&k| series.sample(k)).copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_left_out_and_other_values_stay() {
        let times = [0.0, 1.0, 1.0, 2.0, 2.0, 3.0];
        let series = Series::shaped(1, vec![5.0, 6.0, 6.0, 7.0, 7.5, 8.0]);
        let kept = without_copies(&times, &[&series]).unwrap();
        assert_eq!(kept, [0, 1, 3, 4, 5]);
        assert_eq!(selected(&series, &kept).values(), [5.0, 6.0, 7.0, 7.5, 8.0]);
        assert!(without_copies(&[0.0, 1.0, 2.0], &[]).is_none());
    }
}
