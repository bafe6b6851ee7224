//! Joins pieces, in order, into the rows of the whole recording.
//!
//! The samples before and after a piece add `c_j p_j^m` times the sums at its ends, m samples away, to its kept samples. All samples before
//! it count; samples after it count while `p_j^m` is not negligible.

use std::{collections::VecDeque, ops::Range};

use super::forward_backward::Kept;
use super::pieces::{DecimatedPiece, PiecePass, Record, Tail};
use super::pole_sums::{PoleSums, Sums};
use thetahat_ground::series::Series;

/// Powers of a pole below this count as zero: their contribution is below the rounding of a sum.
const NEGLIGIBLE: f64 = 1e-20;

/// Rows up to which a recording is one piece, and rows of each piece of a longer one: the sums of a piece take sixteen times the memory of
/// its rows.
const ROWS_OF_ONE_PIECE: usize = 8192;
const ROWS_OF_PIECE: usize = 1024;

/// The kept samples of a recording, filtered as by [`forward_backward`](super::forward_backward::forward_backward). `fill` writes the
/// channels of each sample in order.
pub(super) fn filter_and_keep(
    sums: &PoleSums,
    record: Record,
    kept: Kept,
    mut fill: impl FnMut(usize, &mut [f64]),
) -> Series {
    let rows = kept.indices(record.samples).count();
    let mut joined = Joined::new(sums, rows);
    let mut finished: Vec<Series> = Vec::new();
    for piece in pieces(rows, if rows > ROWS_OF_ONE_PIECE { ROWS_OF_PIECE } else { rows }) {
        finished.extend(joined.take(PiecePass::new(sums, record, kept, &mut fill).run(piece)));
    }
    joined_rows(record.channels, finished)
}

/// Pieces one after the other.
fn joined_rows(channels: usize, mut pieces: Vec<Series>) -> Series {
    match pieces.len() {
        1 => pieces.remove(0),
        _ => Series::shaped(channels, pieces.into_iter().flat_map(Series::into_values).collect()),
    }
}

/// Ranges of at least so many rows.
pub(super) fn pieces(all: usize, rows: usize) -> Vec<Range<usize>> {
    let count = (all / rows.max(1)).max(1);
    let end = |piece: usize| if piece + 1 == count { all } else { (piece + 1) * rows };
    (0..count).map(|piece| piece * rows..end(piece)).collect()
}

/// Joins the pieces of a recording into rows.
#[derive(Debug)]
pub(super) struct Joined<'a> {
    sums: &'a PoleSums,
    /// Rows of the whole recording that are still missing.
    missing: usize,
    /// Number of samples that a piece's rows look ahead.
    ahead: usize,
    /// Causal sums at the end of the last finished piece.
    before: Option<Vec<Sums>>,
    waiting: VecDeque<DecimatedPiece>,
}

impl<'a> Joined<'a> {
    pub(super) fn new(sums: &'a PoleSums, rows: usize) -> Self {
        Self { sums, missing: rows, ahead: sums.reach(NEGLIGIBLE), before: None, waiting: VecDeque::new() }
    }

    /// Receives the next piece and returns the rows of the pieces that it completes.
    pub(super) fn take(&mut self, piece: DecimatedPiece) -> Vec<Series> {
        self.missing -= piece.rows.len().min(self.missing);
        self.waiting.push_back(piece);
        let mut finished = Vec::new();
        while self.is_first_finished() {
            let Some(piece) = self.waiting.pop_front() else { break };
            finished.push(self.finish(piece));
        }
        finished
    }

    fn is_first_finished(&self) -> bool {
        let after: usize = self.waiting.iter().skip(1).map(DecimatedPiece::samples).sum();
        self.missing == 0 || after >= self.ahead
    }

    fn finish(&mut self, piece: DecimatedPiece) -> Series {
        let DecimatedPiece { mut rows, lengths, mut causal, tail, .. } = piece;
        if let Some(before) = self.before.take() {
            self.add_before(before.clone(), &lengths, &mut rows);
            let decay = self.sums.decay(lengths.iter().sum());
            causal = before.iter().zip(&causal).map(|(b, own)| b.decayed(&decay, own)).collect();
        }
        let after = tail.map_or_else(|| self.sums_after(&causal), |tail| self.after_recording(&tail, &causal));
        self.add_after(after, &lengths, &mut rows);
        self.before = Some(causal);
        rows
    }

    /// Adds the contribution of the samples before a piece to its rows.
    fn add_before(&self, mut before: Vec<Sums>, lengths: &[usize], rows: &mut Series) {
        let mut samples = 0;
        for (row, length) in lengths.iter().enumerate() {
            samples += length;
            if samples > self.ahead {
                break;
            }
            let decay = self.sums.decay(*length);
            for (y, before) in rows.sample_mut(row).iter_mut().zip(&mut before) {
                *before = before.decayed(&decay, &Sums::default());
                *y += self.sums.output(before);
            }
        }
    }

    /// Adds the contribution of the samples after a piece to its rows.
    fn add_after(&self, mut after: Vec<Sums>, lengths: &[usize], rows: &mut Series) {
        let mut samples = 0;
        for (row, length) in lengths.iter().enumerate().rev() {
            if samples > self.ahead {
                break;
            }
            let decay = self.sums.decay(*length);
            for (y, after) in rows.sample_mut(row).iter_mut().zip(&mut after) {
                *y += self.sums.output(after);
                *after = after.decayed(&decay, &Sums::default());
            }
            samples += length;
        }
    }

    /// Anticausal sums of the waiting pieces, after a piece that ends with these causal sums.
    fn sums_after(&self, causal: &[Sums]) -> Vec<Sums> {
        let through = |sums: &[Sums], piece: &DecimatedPiece, own: &[Sums]| -> Vec<Sums> {
            let decay = self.sums.decay(piece.samples());
            sums.iter().zip(own).map(|(s, own)| s.decayed(&decay, own)).collect()
        };
        let end = self.waiting.iter().fold(causal.to_vec(), |causal, piece| through(&causal, piece, &piece.causal));
        let tail = self.waiting.back().and_then(|piece| piece.tail.as_ref());
        let after = tail.map_or_else(|| vec![Sums::default(); causal.len()], |tail| self.after_recording(tail, &end));
        self.waiting.iter().rev().fold(after, |after, piece| through(&after, piece, &piece.anticausal))
    }

    /// Anticausal sums of the extension after the recording and of the steady state in which the backward pass starts.
    fn after_recording(&self, tail: &Tail, causal: &[Sums]) -> Vec<Sums> {
        let decay = self.sums.decay(tail.samples);
        let of_channel = |((causal, [added, after]), x): ((&Sums, &[Sums; 2]), &f64)| {
            let end = self.sums.end(&causal.decayed(&decay, added), *x);
            end.decayed(&decay, after)
        };
        causal.iter().zip(&tail.sums).zip(&tail.last).map(of_channel).collect()
    }
}
