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
        let times: Vec<f64> = (0..20)
            .map(|k| {
                f64::from(if k > 12 {
                    k - 2
                } else if k > 5 {
                    k - 1
                } else {
                    k
                })
            })
            .collect();
        let values: Vec<f64> = (0..20).map(|k| if k == 6 { 5.0 } else { f64::from(k) }).collect();
        let series = Series::shaped(1, values);
        // Samples 5 and 6 are one, and 12 and 13 have one time and two values.
        assert_eq!((times[6], times[13]), (times[5], times[12]));
        let kept = without_copies(&times, &[&series]).unwrap();
        assert_eq!(kept, (0..20).filter(|k| *k != 6).collect::<Vec<_>>());
        assert_eq!(selected(&series, &kept).values()[5..8], [5.0, 7.0, 8.0]);
        assert!(without_copies(&[0.0, 1.0, 2.0], &[]).is_none());
    }
}
