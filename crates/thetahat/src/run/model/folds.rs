//! What is left out in turn to choose and judge the model.

use super::rows::ModelRows;
use crate::run::{identification::Identification, prepared::PreparedRecording};
use thetahat_estimation::simulation::Reference;

/// Parts that are left out in turn.
pub(super) const FOLDS: usize = 5;
/// Fewest recordings of which one is left out whole; with fewer, stretches of each are.
const FEWEST_RECORDINGS: usize = 4;
/// Stretches of time into which a recording is divided, tried in this order.
const STRETCHES: [usize; 4] = [10, 20, 40, 80];
/// Fewest rows of a joint in a stretch.
const FEWEST_ROWS: usize = 6;
/// Part of each joint's motion, by the square of its velocity, that the rest must keep when a part is left out.
const MOTION_KEPT: f64 = 0.5;

/// The part to which each decimated row of a joint belongs.
#[derive(Debug, Clone)]
pub(super) struct ModelFolds {
    /// None of the rows near a border between parts, which know of both.
    pub(super) of_row: Vec<Option<usize>>,
    /// How many parts there are; zero if nothing can be left out.
    pub(super) count: usize,
}

impl ModelFolds {
    pub(super) fn new(identification: &Identification, rows: &ModelRows) -> Self {
        let lengths: Vec<usize> = rows.decimators.iter().map(|d| d.rows()).collect();
        if lengths.len() >= FEWEST_RECORDINGS {
            return Self::of_recordings(&lengths);
        }
        let signal = &identification.setup().settings.signal;
        let rate = identification.main.first().map_or(1.0, |p| p.filtered.recording.sample_rate_hz);
        let memory = (rate / (signal.cutoff_hz * signal.decimation as f64)).ceil() as usize + 1;
        let speeds = speeds(identification, rows);
        let tried = STRETCHES.into_iter().filter_map(|stretches| {
            let shortest = lengths.iter().min()? / stretches;
            (shortest >= FEWEST_ROWS).then(|| of_stretches(&identification.main, rows, stretches))
        });
        let mut best: Option<(f64, Vec<usize>)> = None;
        for folds in tried {
            let kept = motion_kept(&folds, &speeds);
            if best.as_ref().is_none_or(|(most, _)| kept > *most) {
                best = Some((kept, folds));
            }
            if kept >= MOTION_KEPT {
                break;
            }
        }
        let Some((_, folds)) = best else { return Self { of_row: vec![Some(0); rows.rows_of_joint()], count: 0 } };
        Self { of_row: without_borders(&folds, &lengths, memory), count: FOLDS }
    }

    /// Recordings, in at most five parts.
    fn of_recordings(lengths: &[usize]) -> Self {
        let count = lengths.len().min(FOLDS);
        let of_row = lengths.iter().enumerate().flat_map(|(k, rows)| std::iter::repeat_n(Some(k % count), *rows));
        Self { of_row: of_row.collect(), count }
    }
}

/// The squared velocity of each joint at each row of a joint.
fn speeds(identification: &Identification, rows: &ModelRows) -> Vec<Vec<f64>> {
    let of_joint = |j: usize| {
        let recordings = identification.main.iter().zip(&rows.decimators);
        recordings.flat_map(move |(p, d)| d.kept().map(move |k| p.filtered.motion.dq.sample(k)[j].powi(2))).collect()
    };
    (0..rows.layout.joints()).map(of_joint).collect()
}

/// Stretches of each recording that go to the parts in turn; of a motion that repeats, the same stretch of each period.
fn of_stretches(prepared: &[PreparedRecording], rows: &ModelRows, stretches: usize) -> Vec<usize> {
    let mut folds = Vec::with_capacity(rows.rows_of_joint());
    for (p, decimator) in prepared.iter().zip(&rows.decimators) {
        let (count, rate) = (decimator.rows(), p.filtered.recording.sample_rate_hz);
        let frequency_hz = p.reference.as_ref().and_then(|r| match &r.reference {
            Reference::Periodic(periodic) => Some(periodic.series().base_frequency_hz()),
            Reference::Moves(_) | Reference::Sampled(_) => None,
        });
        for (row, sample) in decimator.kept().enumerate() {
            let part = match frequency_hz {
                Some(frequency_hz) => ((p.filtered.start_s() + sample as f64 / rate) * frequency_hz).fract(),
                None => row as f64 / count as f64,
            };
            folds.push((part * stretches as f64) as usize % FOLDS);
        }
    }
    folds
}

/// The least part of a joint's motion that is left when one part is left out.
fn motion_kept(folds: &[usize], speeds: &[Vec<f64>]) -> f64 {
    let of_joint = |squares: &Vec<f64>| {
        let total: f64 = squares.iter().sum();
        let part = |fold: usize| {
            let inside = folds.iter().zip(squares).filter(|(f, _)| **f == fold);
            inside.map(|(_, s)| s).sum::<f64>()
        };
        let most = (0..FOLDS).map(part).fold(0.0, f64::max);
        if total > 0.0 { 1.0 - most / total } else { 1.0 }
    };
    speeds.iter().map(of_joint).fold(1.0, f64::min)
}

/// The parts without the rows within `memory` of a border, at most a quarter of a stretch on either side.
fn without_borders(folds: &[usize], lengths: &[usize], memory: usize) -> Vec<Option<usize>> {
    let mut of_row: Vec<Option<usize>> = folds.iter().copied().map(Some).collect();
    let mut start = 0;
    for length in lengths {
        let end = start + length;
        let borders: Vec<usize> = (start + 1..end).filter(|&k| folds[k] != folds[k - 1]).collect();
        let reach = memory.min(length / (4 * (borders.len() + 1)));
        for border in borders {
            of_row[border.saturating_sub(reach).max(start)..(border + reach).min(end)].fill(None);
        }
        start = end;
    }
    of_row
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_near_a_border_belong_to_no_part() {
        let found = without_borders(&[0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0], &[8, 4], 9);
        assert_eq!(found, [0, 0, 0, 9, 9, 1, 1, 1, 0, 0, 0, 0].map(|f| (f < 9).then_some(f)));
    }

    #[test]
    fn a_joint_that_moves_in_one_part_alone_keeps_nothing() {
        let folds = [0, 0, 1, 1, 2, 2, 3, 3, 4, 4];
        assert_eq!(motion_kept(&folds, &[vec![1.0; 10]]), 0.8);
        let once = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(motion_kept(&folds, &[vec![1.0; 10], once]), 0.0);
    }
}
