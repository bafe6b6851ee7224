//! Samples that two recordings share, found from a few marks of each.
//!
//! A mark is a hash of the positions and torques of all joints in one or a few samples of a motion. Each recording keeps its
//! smallest hashes, so that what two recordings share is among the marks of both (A. Broder, "On the resemblance and
//! containment of documents", 1997).

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::fingerprint::scrambled;
use thetahat_ground::series::Series;

/// Marks of one recording.
const MARKS: usize = 1024;
/// Marks at one distance in time from which samples are shared.
const FEWEST: usize = 3;
/// Numbers of a mark at least: of a robot with few joints, several samples are one.
const NUMBERS: usize = 12;
/// Samples of a mark at the most.
const MOST_SAMPLES: usize = 6;

/// A sample, counted in its recording, with the hash of its values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Mark(u64, u64);

/// The marks of a recording, by their hashes.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Marks(Vec<Mark>);

impl Marks {
    /// Adds the marks that start in `own`, a range of the given series, of which `end` is the last sample that may be used;
    /// `first` is the place of the series in the recording.
    pub(super) fn add(&mut self, [position, torque]: [&Series; 2], own: Range<usize>, (first, end): (usize, usize)) {
        let samples = NUMBERS.div_ceil(2 * position.channels()).min(MOST_SAMPLES);
        let moves = |k: &usize| position.sample(*k) != position.sample(*k + 1);
        let places = own.take_while(|k| k + samples.max(2) <= end).filter(moves);
        for k in places {
            let values = (k..k + samples).flat_map(|k| position.sample(k).iter().chain(torque.sample(k)));
            let hash = values.fold(0, |hash: u64, v| scrambled(hash.rotate_left(5) ^ v.to_bits()));
            self.0.push(Mark(hash, (first + k) as u64));
            if self.0.len() > 4 * MARKS {
                self.keep_smallest();
            }
        }
        self.keep_smallest();
    }

    /// Adds those of another part of the same recording.
    pub(super) fn join(&mut self, other: Self) {
        self.0.extend(other.0);
        self.keep_smallest();
    }

    fn keep_smallest(&mut self) {
        self.0.sort_unstable();
        self.0.truncate(MARKS);
    }

    /// By how many samples the same samples are later in this recording than in another one; none if none are shared.
    pub(super) fn shift_from(&self, other: &Self) -> Option<i64> {
        let mut shifts = Vec::new();
        let mut theirs = other.0.iter().peekable();
        for Mark(hash, place) in &self.0 {
            while theirs.next_if(|mark| mark.0 < *hash).is_some() {}
            if let Some(mark) = theirs.peek().filter(|mark| mark.0 == *hash) {
                shifts.push(*place as i64 - mark.1 as i64);
            }
        }
        shifts.sort_unstable();
        let runs = shifts.chunk_by(|a, b| a == b);
        runs.max_by_key(|run| run.len()).filter(|run| run.len() >= FEWEST).map(|run| run[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(samples: usize) -> [Series; 2] {
        let wave = |rate: f64| (0..samples).map(|k| (rate * k as f64 * k as f64).sin()).collect::<Vec<_>>();
        [Series::side_by_side(&[wave(1.1), wave(1.3)]), Series::side_by_side(&[wave(1.7), wave(1.9)])]
    }

    fn marks(samples: Range<usize>, pieces: &[usize]) -> Marks {
        let [position, torque] = record(samples.end);
        let mut marks = Marks::default();
        let mut start = samples.start;
        for end in pieces.iter().copied().chain([samples.end]) {
            let mut own = Marks::default();
            own.add([&position, &torque], start..end, (0, samples.end));
            marks.join(own);
            start = end;
        }
        marks
    }

    #[test]
    fn pieces_give_the_marks_of_the_whole() {
        assert_eq!(marks(10..20_000, &[]), marks(10..20_000, &[11, 5000, 5001, 19_999]));
    }

    #[test]
    fn shared_samples_are_found_with_their_shift() {
        let whole = marks(0..20_000, &[]);
        assert_eq!(whole.shift_from(&marks(19_000..20_500, &[])), Some(0));
        assert_eq!(whole.shift_from(&marks(20_000..30_000, &[])), None);
        let [position, torque] = record(9000);
        let mut later = Marks::default();
        later.add([&position, &torque], 100..9000, (1000, 9000));
        assert_eq!(later.shift_from(&whole), Some(1000));
        assert_eq!(whole.shift_from(&later), Some(-1000));
    }

    #[test]
    fn a_robot_at_rest_has_no_marks() {
        let still = Series::zeros(100, 3);
        let mut marks = Marks::default();
        marks.add([&still, &still], 0..100, (0, 100));
        assert_eq!(marks, Marks::default());
    }
}
