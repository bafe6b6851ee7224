//! The sums over poles of a record that comes in parts: each part is summed by itself, and parts are joined in order.
//!
//! A part is what lies between two kept samples. Its causal sums start from zero (the first part's from the steady state),
//! its anticausal ones too; what the samples before and behind it add at its kept samples is `c_j p_j^m` times the sums at
//! its ends, m samples away, and is added when its neighbours are known. The samples before count all, those behind it as
//! far as `p_j^m` can be told from zero.

use std::collections::VecDeque;
use std::ops::Range;

use super::forward_backward::{Kept, Shape};
use super::pole_sums::{Block, LANES, PoleSums, Sums, WEIGHTS, block_sums};
use crate::series::Series;

/// A power of a pole that is no longer told from zero: with what it multiplies it stays below the rounding of a sum.
pub(super) const NOTHING: f64 = 1e-20;

/// Consecutive kept samples of a record, as far as the samples between them determine them.
#[derive(Debug, Clone)]
pub struct DecimatedPart {
    pub(super) rows: Series,
    /// Samples of the block that ends with each row.
    lengths: Vec<usize>,
    /// Causal sums of each channel at the last row, anticausal ones before the first block.
    causal: Vec<Sums>,
    anticausal: Vec<Sums>,
    /// The extension behind the record, where this is its last part.
    tail: Option<Tail>,
}

#[derive(Debug, Clone)]
struct Tail {
    samples: usize,
    sums: Vec<[Sums; 2]>,
    /// The last sample of the extension.
    last: Vec<f64>,
}

impl DecimatedPart {
    /// A part of a record that is not filtered: its samples.
    pub(super) fn of_samples(rows: Series) -> Self {
        Self { rows, lengths: Vec::new(), causal: Vec::new(), anticausal: Vec::new(), tail: None }
    }

    fn samples(&self) -> usize {
        self.lengths.iter().sum()
    }
}

/// One part on its way through the sums.
pub(super) struct PartPass<'a, F> {
    sums: &'a PoleSums,
    shape: Shape,
    kept: Kept,
    fill: F,
    /// Channels, filled up with zeros to whole tiles.
    width: usize,
    /// The first samples of the record, which the extension needs before their turn, and the last ones.
    head: Vec<f64>,
    tail: Vec<f64>,
    weights: Vec<[f64; WEIGHTS]>,
    /// The values of the last block, whose place the next one takes: what fills up the width stays zero.
    spare: Vec<f64>,
}

impl<'a, F: FnMut(usize, &mut [f64])> PartPass<'a, F> {
    pub(super) fn new(sums: &'a PoleSums, shape: Shape, kept: Kept, fill: F) -> Self {
        let width = shape.channels.next_multiple_of(LANES);
        let tail = vec![0.0; (shape.padding + 1) * width];
        Self { sums, shape, kept, fill, width, head: Vec::new(), tail, weights: Vec::new(), spare: Vec::new() }
    }

    /// The part with these kept samples.
    pub(super) fn run(mut self, rows: Range<usize>) -> DecimatedPart {
        let mut output = Series::zeros(rows.len(), self.shape.channels);
        let mut lengths = Vec::with_capacity(rows.len());
        let mut causal = vec![Sums::default(); self.width];
        let mut behind = Vec::with_capacity(rows.len());
        for (place, row) in rows.clone().enumerate() {
            let block = if row == 0 { self.first_block(&mut causal) } else { self.block(self.samples_of(row)) };
            let sums = self.sums_of(&block);
            let decay = self.sums.decay(block.samples);
            causal.iter_mut().zip(&sums).for_each(|(s, [added, _])| *s = s.decayed(&decay, added));
            self.write_causal(&block, &causal, output.sample_mut(place));
            lengths.push(block.samples);
            behind.push(sums);
            self.spare = block.values;
        }
        let anticausal = self.add_anticausal(&lengths, &behind, &mut output);
        let is_last = self.kept.first + self.kept.step * (rows.end - 1) + 1 == self.shape.samples;
        let tail = is_last.then(|| self.tail());
        DecimatedPart { rows: output, lengths, causal, anticausal, tail }
    }

    /// The samples behind the kept one before this, up to this.
    fn samples_of(&self, row: usize) -> Range<usize> {
        let end = self.kept.first + row * self.kept.step + 1;
        end.saturating_sub(self.kept.step)..end
    }

    fn sums_of(&mut self, block: &Block) -> Vec<[Sums; 2]> {
        if self.weights.len() != block.samples {
            self.weights = self.sums.weights(block.samples);
        }
        block_sums(block, self.width, &self.weights)
    }

    /// The samples in `range` of the record.
    fn block(&mut self, range: Range<usize>) -> Block {
        let mut values = std::mem::take(&mut self.spare);
        values.resize(range.len() * self.width, 0.0);
        let Shape { samples, channels, padding } = self.shape;
        for (k, sample) in range.clone().zip(values.chunks_mut(self.width)) {
            match self.head.get(k * self.width..(k + 1) * self.width) {
                Some(known) => sample.copy_from_slice(known),
                None => (self.fill)(k, &mut sample[..channels]),
            }
            if let Some(place) = (k + padding + 1).checked_sub(samples) {
                self.tail[place * self.width..][..self.width].copy_from_slice(sample);
            }
        }
        Block { samples: range.len(), values }
    }

    /// The extension before the record and its samples up to the first one kept. The sums before it are those of a
    /// record that has always had its first value.
    fn first_block(&mut self, causal: &mut [Sums]) -> Block {
        let (padding, width) = (self.shape.padding, self.width);
        let mut head = vec![0.0; (padding + 1) * width];
        let fill = &mut self.fill;
        head.chunks_mut(width).enumerate().for_each(|(k, sample)| fill(k, &mut sample[..self.shape.channels]));
        let mut values: Vec<f64> = Vec::new();
        for k in (1..=padding).rev() {
            values.extend((0..width).map(|c| 2.0 * head[c] - head[k * width + c]));
        }
        causal.iter_mut().zip(&values).for_each(|(sums, x)| *sums = self.sums.steady(*x));
        self.head = head;
        let record = self.block(0..self.kept.first + 1);
        values.extend(record.values);
        Block { samples: padding + record.samples, values }
    }

    /// The extension behind the record.
    fn tail(&mut self) -> Tail {
        let (padding, width) = (self.shape.padding, self.width);
        let last = &self.tail[padding * width..];
        let reflected = (1..=padding).flat_map(|k| {
            let sample = &self.tail[(padding - k) * width..][..width];
            last.iter().zip(sample).map(|(l, x)| 2.0 * l - x)
        });
        let block = Block { samples: padding, values: reflected.collect() };
        let sums = self.sums_of(&block);
        Tail { samples: padding, sums, last: block.values[(padding - 1) * width..].to_vec() }
    }

    /// `sum_j c_j s_j + g x` at the last sample of a block.
    fn write_causal(&self, block: &Block, causal: &[Sums], output: &mut [f64]) {
        let last = &block.values[(block.samples - 1) * self.width..];
        for ((y, causal), x) in output.iter_mut().zip(causal).zip(last) {
            *y = self.sums.output(causal) + self.sums.at_sample * x;
        }
    }

    /// Adds the anticausal sums from the last row to the first, and returns those before the part.
    fn add_anticausal(&self, lengths: &[usize], behind: &[Vec<[Sums; 2]>], output: &mut Series) -> Vec<Sums> {
        let mut anticausal = vec![Sums::default(); self.width];
        for (row, (length, sums)) in lengths.iter().zip(behind).enumerate().rev() {
            let decay = self.sums.decay(*length);
            output.sample_mut(row).iter_mut().zip(&anticausal).for_each(|(y, t)| *y += self.sums.output(t));
            anticausal.iter_mut().zip(sums).for_each(|(t, [_, added])| *t = t.decayed(&decay, added));
        }
        anticausal
    }
}

/// The parts of a record on their way to rows.
#[derive(Debug)]
pub(super) struct Joined<'a> {
    sums: &'a PoleSums,
    /// Rows of the whole record that have not come yet.
    missing: usize,
    /// Samples that a part's rows look ahead.
    ahead: usize,
    /// Causal sums at the end of the last part that is finished.
    before: Option<Vec<Sums>>,
    waiting: VecDeque<DecimatedPart>,
}

impl<'a> Joined<'a> {
    pub(super) fn new(sums: &'a PoleSums, rows: usize) -> Self {
        Self { sums, missing: rows, ahead: sums.reach(NOTHING), before: None, waiting: VecDeque::new() }
    }

    /// Takes the next part, and gives the rows of those that are finished by it.
    pub(super) fn take(&mut self, part: DecimatedPart) -> Vec<Series> {
        self.missing -= part.rows.len().min(self.missing);
        self.waiting.push_back(part);
        let mut finished = Vec::new();
        while self.is_first_finished() {
            let Some(part) = self.waiting.pop_front() else { break };
            finished.push(self.finish(part));
        }
        finished
    }

    fn is_first_finished(&self) -> bool {
        let behind: usize = self.waiting.iter().skip(1).map(DecimatedPart::samples).sum();
        self.missing == 0 || behind >= self.ahead
    }

    fn finish(&mut self, part: DecimatedPart) -> Series {
        let DecimatedPart { mut rows, lengths, mut causal, tail, .. } = part;
        if let Some(before) = self.before.take() {
            self.add_before(before.clone(), &lengths, &mut rows);
            let decay = self.sums.decay(lengths.iter().sum());
            causal = before.iter().zip(&causal).map(|(b, own)| b.decayed(&decay, own)).collect();
        }
        let behind = tail.map_or_else(|| self.behind(&causal), |tail| self.behind_record(&tail, &causal));
        self.add_behind(behind, &lengths, &mut rows);
        self.before = Some(causal);
        rows
    }

    /// Adds what lies before a part to its rows.
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

    /// Adds what lies behind a part to its rows.
    fn add_behind(&self, mut behind: Vec<Sums>, lengths: &[usize], rows: &mut Series) {
        let mut samples = 0;
        for (row, length) in lengths.iter().enumerate().rev() {
            if samples > self.ahead {
                break;
            }
            let decay = self.sums.decay(*length);
            for (y, behind) in rows.sample_mut(row).iter_mut().zip(&mut behind) {
                *y += self.sums.output(behind);
                *behind = behind.decayed(&decay, &Sums::default());
            }
            samples += length;
        }
    }

    /// Anticausal sums, behind a part with these causal ones at its end, of the parts that wait.
    fn behind(&self, causal: &[Sums]) -> Vec<Sums> {
        let through = |sums: &[Sums], part: &DecimatedPart, own: &[Sums]| -> Vec<Sums> {
            let decay = self.sums.decay(part.samples());
            sums.iter().zip(own).map(|(s, own)| s.decayed(&decay, own)).collect()
        };
        let end = self.waiting.iter().fold(causal.to_vec(), |causal, part| through(&causal, part, &part.causal));
        let tail = self.waiting.back().and_then(|part| part.tail.as_ref());
        let behind = tail.map_or_else(|| vec![Sums::default(); causal.len()], |tail| self.behind_record(tail, &end));
        self.waiting.iter().rev().fold(behind, |behind, part| through(&behind, part, &part.anticausal))
    }

    /// Those of the extension behind the record, and of the steady state in which the backward pass starts.
    fn behind_record(&self, tail: &Tail, causal: &[Sums]) -> Vec<Sums> {
        let decay = self.sums.decay(tail.samples);
        let of_channel = |((causal, [added, behind]), x): ((&Sums, &[Sums; 2]), &f64)| {
            let end = self.sums.end(&causal.decayed(&decay, added), *x);
            end.decayed(&decay, behind)
        };
        causal.iter().zip(&tail.sums).zip(&tail.last).map(of_channel).collect()
    }
}
