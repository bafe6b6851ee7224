//! The sums over poles of one piece of a recording, independent of its neighbours.
//!
//! A piece lies between two kept samples. Its causal sums start from zero (those of the first piece from the steady state), and so
//! do its anticausal sums; `join` adds what its neighbours contribute.

use std::ops::Range;

use super::forward_backward::Kept;
use super::pole_sums::{Interval, LANES, PoleSums, Sums, WEIGHTS, interval_sums};
use thetahat_ground::series::Series;

/// How a recording is extended at both ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Extension {
    /// This number of samples of its odd reflection, `2 x[0] - x[k]`, then the last of those repeated.
    Odd(usize),
    /// Zeros.
    Zero,
}

/// Size of a recording: samples and channels, and its extension at both ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record {
    pub samples: usize,
    pub channels: usize,
    pub extension: Extension,
}

impl Extension {
    /// Number of reflected samples, without the one at the centre of reflection.
    fn reflected(self) -> usize {
        match self {
            Self::Odd(samples) => samples,
            Self::Zero => 0,
        }
    }
}

/// Consecutive kept samples of a recording, to the extent that the samples between them determine them.
#[derive(Debug, Clone)]
pub struct DecimatedPiece {
    pub(super) rows: Series,
    /// Samples of the interval that ends with each row.
    pub(super) lengths: Vec<usize>,
    /// Causal sums of each channel at the last row, anticausal ones before the first interval.
    pub(super) causal: Vec<Sums>,
    pub(super) anticausal: Vec<Sums>,
    /// The odd extension after the recording, if this is its last piece and is extended.
    pub(super) tail: Option<Tail>,
}

/// The extension after the last sample of a recording.
#[derive(Debug, Clone)]
pub(super) struct Tail {
    pub(super) samples: usize,
    pub(super) sums: Vec<[Sums; 2]>,
    /// The last sample of the extension.
    pub(super) last: Vec<f64>,
}

impl DecimatedPiece {
    /// A piece of an unfiltered recording: its samples.
    pub(super) fn of_samples(rows: Series) -> Self {
        Self { rows, lengths: Vec::new(), causal: Vec::new(), anticausal: Vec::new(), tail: None }
    }

    pub(super) fn samples(&self) -> usize {
        self.lengths.iter().sum()
    }
}

/// Accumulates the sums of one piece.
pub(super) struct PiecePass<'a, F> {
    sums: &'a PoleSums,
    record: Record,
    kept: Kept,
    fill: F,
    /// Number of channels, padded with zeros to whole tiles.
    width: usize,
    /// The first samples of the recording, which the extension needs early, and the last ones.
    head: Vec<f64>,
    tail: Vec<f64>,
    weights: Vec<[f64; WEIGHTS]>,
    /// The buffer of the last interval, reused by the next one: the padding stays zero.
    spare: Vec<f64>,
}

impl<'a, F: FnMut(usize, &mut [f64])> PiecePass<'a, F> {
    pub(super) fn new(sums: &'a PoleSums, record: Record, kept: Kept, fill: F) -> Self {
        let width = record.channels.next_multiple_of(LANES);
        let tail = vec![0.0; (record.extension.reflected() + 1) * width];
        Self { sums, record, kept, fill, width, head: Vec::new(), tail, weights: Vec::new(), spare: Vec::new() }
    }

    /// Computes the piece with these kept samples.
    pub(super) fn run(mut self, rows: Range<usize>) -> DecimatedPiece {
        let mut output = Series::zeros(rows.len(), self.record.channels);
        let mut lengths = Vec::with_capacity(rows.len());
        let mut causal = vec![Sums::default(); self.width];
        let mut interval_ends = Vec::with_capacity(rows.len());
        for (place, row) in rows.clone().enumerate() {
            let interval =
                if row == 0 { self.first_interval(&mut causal) } else { self.interval(self.samples_of(row)) };
            let sums = self.sums_of(&interval);
            let decay = self.sums.decay(interval.samples);
            causal.iter_mut().zip(&sums).for_each(|(s, [added, _])| *s = s.decayed(&decay, added));
            self.write_causal(&interval, &causal, output.sample_mut(place));
            lengths.push(interval.samples);
            interval_ends.push(sums);
            self.spare = interval.values;
        }
        let anticausal = self.add_anticausal(&lengths, &interval_ends, &mut output);
        let is_last = self.kept.first + self.kept.step * (rows.end - 1) + 1 == self.record.samples;
        let tail = (is_last && self.record.extension != Extension::Zero).then(|| self.tail());
        DecimatedPiece { rows: output, lengths, causal, anticausal, tail }
    }

    /// The samples after the previous kept one, up to this row's.
    fn samples_of(&self, row: usize) -> Range<usize> {
        let end = self.kept.first + row * self.kept.step + 1;
        end.saturating_sub(self.kept.step)..end
    }

    fn sums_of(&mut self, interval: &Interval) -> Vec<[Sums; 2]> {
        if self.weights.len() != interval.samples {
            self.weights = self.sums.weights(interval.samples);
        }
        interval_sums(interval, self.width, &self.weights)
    }

    /// The samples in `range` of the recording.
    fn interval(&mut self, range: Range<usize>) -> Interval {
        let mut values = std::mem::take(&mut self.spare);
        values.resize(range.len() * self.width, 0.0);
        let (Record { samples, channels, .. }, padding) = (self.record, self.record.extension.reflected());
        for (k, sample) in range.clone().zip(values.chunks_mut(self.width)) {
            match self.head.get(k * self.width..(k + 1) * self.width) {
                Some(known) => sample.copy_from_slice(known),
                None => (self.fill)(k, &mut sample[..channels]),
            }
            if let Some(place) = (k + padding + 1).checked_sub(samples) {
                self.tail[place * self.width..][..self.width].copy_from_slice(sample);
            }
        }
        Interval { samples: range.len(), values }
    }

    /// The extension before the recording and its samples up to the first kept one. The sums before an odd extension assume that
    /// the recording has always had its first value.
    fn first_interval(&mut self, causal: &mut [Sums]) -> Interval {
        let (padding, width) = (self.record.extension.reflected(), self.width);
        let mut head = vec![0.0; (padding + 1) * width];
        let fill = &mut self.fill;
        head.chunks_mut(width).enumerate().for_each(|(k, sample)| fill(k, &mut sample[..self.record.channels]));
        let mut values: Vec<f64> = Vec::new();
        for k in (1..=padding).rev() {
            values.extend((0..width).map(|c| 2.0 * head[c] - head[k * width + c]));
        }
        causal.iter_mut().zip(&values).for_each(|(sums, x)| *sums = self.sums.steady(*x));
        self.head = head;
        let record = self.interval(0..self.kept.first + 1);
        values.extend(record.values);
        Interval { samples: padding + record.samples, values }
    }

    /// The odd extension after the recording.
    fn tail(&mut self) -> Tail {
        let (padding, width) = (self.record.extension.reflected(), self.width);
        let last = &self.tail[padding * width..];
        let reflected = (1..=padding).flat_map(|k| {
            let sample = &self.tail[(padding - k) * width..][..width];
            last.iter().zip(sample).map(|(l, x)| 2.0 * l - x)
        });
        let interval = Interval { samples: padding, values: reflected.collect() };
        let sums = self.sums_of(&interval);
        Tail { samples: padding, sums, last: interval.values[(padding - 1) * width..].to_vec() }
    }

    /// `sum_j c_j s_j + g x` at the last sample of an interval.
    fn write_causal(&self, interval: &Interval, causal: &[Sums], output: &mut [f64]) {
        let last = &interval.values[(interval.samples - 1) * self.width..];
        for ((y, causal), x) in output.iter_mut().zip(causal).zip(last) {
            *y = self.sums.output(causal) + self.sums.at_sample * x;
        }
    }

    /// Adds the anticausal sums from the last row to the first, and returns those before the piece.
    fn add_anticausal(&self, lengths: &[usize], after: &[Vec<[Sums; 2]>], output: &mut Series) -> Vec<Sums> {
        let mut anticausal = vec![Sums::default(); self.width];
        for (row, (length, sums)) in lengths.iter().zip(after).enumerate().rev() {
            let decay = self.sums.decay(*length);
            output.sample_mut(row).iter_mut().zip(&anticausal).for_each(|(y, t)| *y += self.sums.output(t));
            anticausal.iter_mut().zip(sums).for_each(|(t, [_, added])| *t = t.decayed(&decay, added));
        }
        anticausal
    }
}
