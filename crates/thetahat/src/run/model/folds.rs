//! What is left out in turn to choose and judge the model.

use super::{
    factors::ModelFactors,
    parts::{FOLDS, Parts, STRETCHES},
};

/// Fewest recordings of which one is left out whole; with fewer, stretches of each are.
pub(crate) const FEWEST_RECORDINGS: usize = 4;
/// Fewest rows of a joint in a stretch.
const FEWEST_ROWS: usize = 6;
/// Part of each joint's motion, by the square of its velocity, that the rest must keep when a part is left out.
const MOTION_KEPT: f64 = 0.5;

/// What is left out in turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ModelFolds {
    /// Nothing: all rows belong to one part.
    Nothing,
    /// Recordings, in so many parts.
    Recordings(usize),
    /// Stretches of each recording, by the division of this number.
    Stretches(usize),
}

impl ModelFolds {
    pub(super) fn new(recordings: &[&ModelFactors]) -> Self {
        if recordings.len() >= FEWEST_RECORDINGS {
            return Self::Recordings(recordings.len().min(FOLDS));
        }
        let shortest = recordings.iter().map(|r| r.rows).min().unwrap_or(0);
        let mut best: Option<(f64, usize)> = None;
        for division in (0..STRETCHES.len()).filter(|d| shortest / STRETCHES[*d] >= FEWEST_ROWS) {
            let kept = motion_kept(recordings, division);
            if best.is_none_or(|(most, _)| kept > most) {
                best = Some((kept, division));
            }
            if kept >= MOTION_KEPT {
                break;
            }
        }
        best.map_or(Self::Nothing, |(_, division)| Self::Stretches(division))
    }

    /// How many parts there are; zero if nothing can be left out.
    pub(super) fn count(self) -> usize {
        match self {
            Self::Nothing => 0,
            Self::Recordings(count) => count,
            Self::Stretches(_) => FOLDS,
        }
    }

    /// The part of rows of a recording; none of rows near a border between parts.
    pub(super) fn part_of(self, recording: usize, parts: &Parts) -> Option<usize> {
        match self {
            Self::Nothing => Some(0),
            Self::Recordings(count) => Some(recording % count),
            Self::Stretches(division) => parts[division].map(usize::from),
        }
    }
}

/// The least part of a joint's motion that is left when one part is left out.
fn motion_kept(recordings: &[&ModelFactors], division: usize) -> f64 {
    let joints = recordings.first().map_or(0, |r| r.squared_velocities.len());
    let of_joint = |joint: usize| {
        let part = |part: usize| -> f64 {
            recordings.iter().map(|r| r.squared_velocities[joint][division * FOLDS + part]).sum()
        };
        let parts: Vec<f64> = (0..FOLDS).map(part).collect();
        let total: f64 = parts.iter().sum();
        let most = parts.into_iter().fold(0.0, f64::max);
        if total > 0.0 { 1.0 - most / total } else { 1.0 }
    };
    (0..joints).map(of_joint).fold(1.0, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of joints whose squared velocities in the parts of the first division are given.
    fn recording(rows: usize, of_joints: &[[f64; FOLDS]]) -> ModelFactors {
        let joint = |first: &[f64; FOLDS]| first.iter().copied().chain([1.0; 3 * FOLDS]).collect();
        ModelFactors {
            rows,
            mean_position: Vec::new(),
            squared_velocities: of_joints.iter().map(joint).collect(),
            cells: Vec::new(),
            sums: Vec::new(),
            span: 1,
            moving_sums: Vec::new(),
            settled: Vec::new(),
            repeated: None,
        }
    }

    #[test]
    fn a_joint_that_moves_in_one_part_alone_asks_for_shorter_stretches() {
        let even = [1.0; FOLDS];
        let once = [0.0, 0.0, 3.0, 0.0, 0.0];
        assert_eq!(motion_kept(&[&recording(100, &[even])], 0), 0.8);
        assert_eq!(motion_kept(&[&recording(100, &[even, once])], 0), 0.0);
        let folds = |rows: usize, of_joints: &[[f64; FOLDS]]| ModelFolds::new(&[&recording(rows, of_joints)]);
        assert_eq!(folds(100, &[even]), ModelFolds::Stretches(0));
        assert_eq!(folds(200, &[even, once]), ModelFolds::Stretches(1));
        assert_eq!(folds(100, &[even, once]), ModelFolds::Stretches(0));
        assert_eq!(folds(59, &[even]), ModelFolds::Nothing);
    }

    #[test]
    fn of_four_recordings_one_is_left_out_whole() {
        let recording = recording(10, &[[1.0; FOLDS]]);
        let folds = ModelFolds::new(&[&recording; 6]);
        assert_eq!((folds.count(), folds.part_of(5, &[None; STRETCHES.len()])), (FOLDS, Some(0)));
    }
}
