//! Which samples of a piece make no rows because a joint is near rest.

use std::ops::Range;

use thetahat_estimation::identification::{NearRest, hardly_moves};
use thetahat_ground::series::Series;
use thetahat_model::dynamics::Jump;
use thetahat_report::results::NearRestResult;

/// What decides of the samples of a window.
#[derive(Debug, Clone)]
pub(super) struct NearRestMask {
    jumps: Vec<Jump>,
    rule: NearRest,
    window: Range<usize>,
    /// Whether a coordinate keeps all its samples, because it hardly moves.
    keeps_all: Vec<bool>,
}

/// The samples of a piece that make rows.
pub(super) struct MaskedPiece {
    /// One where a sample makes rows, else zero: a channel for each coordinate.
    pub used: Series,
    /// Samples of each coordinate that make none.
    pub left_out: Vec<usize>,
}

impl NearRestMask {
    /// At first no coordinate keeps all: whether one hardly moves is known when all pieces were gone through.
    pub(super) fn new(jumps: Vec<Jump>, rule: NearRest, window: Range<usize>) -> Self {
        let keeps_all = vec![false; rule.velocity.len()];
        Self { jumps, rule, window, keeps_all }
    }

    /// The samples of the window whose velocities decide of a range.
    pub(super) fn around(&self, range: &Range<usize>) -> Range<usize> {
        let widened = self.rule.widened;
        let start = range.start.saturating_sub(widened).max(self.window.start);
        // A sample is near rest, too, where the velocity changes its sign after it.
        start..(range.end + widened + 1).min(self.window.end)
    }

    /// The samples of a range, from the velocities [`Self::around`] it.
    pub(super) fn of(&self, range: &Range<usize>, velocity_around: &Series) -> MaskedPiece {
        let first = range.start - self.around(range).start;
        let own = |used: Vec<f64>, keeps_all: bool| match keeps_all {
            true => vec![1.0; range.len()],
            false => used[first..first + range.len()].to_vec(),
        };
        let used = self.rule.used(&self.jumps, velocity_around).into_iter().zip(&self.keeps_all);
        let channels: Vec<Vec<f64>> = used.map(|(used, keeps_all)| own(used, *keeps_all)).collect();
        let left_out = channels.iter().map(|used| used.iter().filter(|u| **u == 0.0).count()).collect();
        MaskedPiece { used: Series::side_by_side(&channels), left_out }
    }

    /// The mask with which coordinates keep all samples that would lose too many, so many as all pieces left out; none if
    /// this one is it.
    pub(super) fn after(&self, left_out: &[usize]) -> Option<Self> {
        let samples = self.window.len();
        let keeps = |(keeps, &left_out): (&bool, &usize)| *keeps || hardly_moves(left_out, samples, self.rule.widened);
        let keeps_all: Vec<bool> = self.keeps_all.iter().zip(left_out).map(keeps).collect();
        (keeps_all != self.keeps_all).then(|| Self { keeps_all, ..self.clone() })
    }

    /// What is reported of it; none if every sample makes rows.
    pub(super) fn describe(&self, left_out: &[usize], sample_rate_hz: f64) -> Option<NearRestResult> {
        let percent = |&samples: &usize| 100.0 * samples as f64 / self.window.len() as f64;
        left_out.iter().any(|samples| *samples > 0).then(|| NearRestResult {
            velocity: self.rule.velocity.clone(),
            widened_s: self.rule.widened as f64 / sample_rate_hz,
            left_out_percent: left_out.iter().map(percent).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_estimation::identification::RowMask;

    const SAMPLES: usize = 400;

    fn velocities() -> Series {
        let of = |k: usize| [(0.05 * k as f64).sin(), 0.02, if k % 97 == 5 { -1.0 } else { 1.0 }];
        Series::shaped(3, (0..SAMPLES).flat_map(of).collect())
    }

    fn jumps() -> Vec<Jump> {
        (0..3).map(|j| Jump { velocity: vec![(j, 1.0)], acts_on: vec![j] }).collect()
    }

    /// The samples of all pieces, with as many passes as it takes.
    fn in_pieces(velocity: &Series, window: &Range<usize>, rule: &NearRest, length: usize) -> (Vec<f64>, Vec<usize>) {
        let mut mask = NearRestMask::new(jumps(), rule.clone(), window.clone());
        loop {
            let (mut used, mut left_out) = (Vec::new(), vec![0; 3]);
            for start in window.clone().step_by(length) {
                let range = start..(start + length).min(window.end);
                let piece = mask.of(&range, &velocity.window(mask.around(&range)));
                used.extend_from_slice(piece.used.values());
                left_out.iter_mut().zip(&piece.left_out).for_each(|(sum, n)| *sum += n);
            }
            match mask.after(&left_out) {
                None => return (used, left_out),
                Some(next) => mask = next,
            }
        }
    }

    /// Samples outside the window decide nothing, and the second coordinate, which is always near rest, keeps all.
    #[test]
    fn pieces_leave_out_what_the_whole_window_does() {
        let velocity = velocities();
        for (window, widened) in [(0..SAMPLES, 3), (10..391, 0), (63..200, 20)] {
            let rule = NearRest { velocity: vec![0.2, 0.03, 0.5], widened };
            let whole = RowMask::near_rest(&jumps(), &velocity.window(window.clone()), &rule).unwrap();
            for length in [1, 7, 50, SAMPLES] {
                let (used, left_out) = in_pieces(&velocity, &window, &rule, length);
                let ones = Series::shaped(3, vec![1.0; 3 * window.len()]);
                assert_eq!(used, whole.applied_to(&ones).values(), "{window:?} {length}");
                let percent: Vec<f64> =
                    whole.left_out().iter().map(|part| (part * window.len() as f64).round()).collect();
                assert_eq!(left_out.iter().map(|n| *n as f64).collect::<Vec<_>>(), percent);
                assert!(left_out[0] > 0 && left_out[1] == 0 && left_out[2] > 0, "{left_out:?}");
            }
        }
    }

    #[test]
    fn a_mask_that_leaves_nothing_out_is_not_described() {
        let rule = NearRest { velocity: vec![0.1], widened: 2 };
        let mask = NearRestMask::new(Vec::new(), rule, 0..100);
        assert_eq!(mask.describe(&[0], 100.0), None);
        let described = mask.describe(&[25], 100.0).unwrap();
        assert_eq!((described.left_out_percent, described.widened_s), (vec![25.0], 0.02));
    }
}
