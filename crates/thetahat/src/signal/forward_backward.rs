//! The one kernel of this room: a cascade of sections over many channels, forward and then backward in time.
//!
//! Eight channels at a time are filtered in place in a buffer of their own. The innermost loop runs
//! over the eight, which the compiler turns into vector instructions; a section passes over a block of samples with
//! its state in registers, and the block stays in the first-level cache while all sections pass over it. A few sets
//! advance side by side, so that a sample's channels are read together.
//!
//! Legend: `x` input, `w` after the poles, `y` output of a section. All zeros that matter are at `z = -1` (SciPy's
//! others, at 0, do nothing), so a numerator is a sum of neighbours: the forward pass adds them section by section;
//! the backward pass runs the poles alone and forms `y[k] = sum_j binomial(order, j) w[k + j]` where `y[k]` is kept.

use std::iter::zip;
use std::ops::Range;

use crate::series::Series;

use super::SecondOrderSections;

/// Channels filtered together.
const LANES: usize = 8;
/// Sets of channels that advance side by side.
const SETS: usize = 4;
/// Samples per block: 8 kB of values.
const BLOCK: usize = 128;

/// One sample of the channels filtered together.
type Lanes = [f64; LANES];

/// The samples to keep of a record: `first`, `first + step`, ...
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Kept {
    pub first: usize,
    pub step: usize,
}

impl Kept {
    pub const ALL: Self = Self { first: 0, step: 1 };

    pub fn indices(self, samples: usize) -> impl Iterator<Item = usize> {
        (self.first..samples).step_by(self.step)
    }

    /// The rows of the output whose samples lie in `samples`.
    fn rows(self, samples: &Range<usize>) -> Range<usize> {
        let rows_before = |k: usize| k.saturating_sub(self.first).div_ceil(self.step);
        rows_before(samples.start)..rows_before(samples.end)
    }
}

/// The kept samples of `input`, filtered forward and backward, with `padding` samples of odd extension at both ends
/// and each pass started in the steady state of its first value.
///
/// The record must be longer than the padding, and the padding at least as long as the order.
pub(super) fn forward_backward(filter: &SecondOrderSections, padding: usize, input: &Series, kept: Kept) -> Series {
    let mut output = Series::zeros(kept.indices(input.len()).count(), input.channels());
    let extended = Extended { series: input, padding };
    let first_channels: Vec<usize> = (0..input.channels()).step_by(LANES).collect();
    let side_by_side = first_channels.len().min(SETS);
    let mut sets: Vec<ChannelSet> = (0..side_by_side).map(|_| ChannelSet::new(filter, extended.len())).collect();
    for first_channels in first_channels.chunks(side_by_side) {
        let sets = &mut sets[..first_channels.len()];
        zip(sets.iter_mut(), first_channels).for_each(|(set, &c)| set.first_channel = c);
        run(sets, extended, kept, &mut output);
    }
    output
}

/// Both passes over some sets of channels, block by block.
fn run(sets: &mut [ChannelSet], input: Extended, kept: Kept, output: &mut Series) {
    sets.iter_mut().for_each(|set| set.start_forward(input));
    for block in blocks(input.len()) {
        for k in block.clone() {
            sets.iter_mut().for_each(|set| set.load(input, k));
        }
        sets.iter_mut().for_each(|set| set.forward(block.clone()));
    }
    sets.iter_mut().for_each(ChannelSet::start_backward);
    for block in blocks(input.len()).rev() {
        sets.iter_mut().for_each(|set| set.backward(block.clone()));
        let samples = input.inside(&block);
        for row in kept.rows(&samples) {
            let k = input.padding + kept.first + row * kept.step;
            sets.iter().for_each(|set| set.store(k, output.sample_mut(row)));
        }
    }
}

fn blocks(samples: usize) -> impl DoubleEndedIterator<Item = Range<usize>> {
    (0..samples.div_ceil(BLOCK)).map(move |i| i * BLOCK..samples.min((i + 1) * BLOCK))
}

/// A series extended at both ends by its odd reflection about the first and the last sample, `2 x[0] - x[k]`.
#[derive(Clone, Copy)]
struct Extended<'a> {
    series: &'a Series,
    padding: usize,
}

impl Extended<'_> {
    fn len(self) -> usize {
        self.series.len() + 2 * self.padding
    }

    /// The part of the block that lies in the series, counted from its first sample.
    fn inside(self, block: &Range<usize>) -> Range<usize> {
        let clamp = |k: usize| k.saturating_sub(self.padding).min(self.series.len());
        clamp(block.start)..clamp(block.end)
    }

    /// Eight channels at sample `k` of the extended record.
    fn lanes(self, k: usize, first_channel: usize) -> Lanes {
        let at = |k: usize| lanes_of(self.series.sample(k), first_channel);
        let last = self.series.len() - 1;
        if k < self.padding {
            reflected(at(0), at(self.padding - k))
        } else if k - self.padding <= last {
            at(k - self.padding)
        } else {
            reflected(at(last), at(2 * last - (k - self.padding)))
        }
    }
}

/// The eight channels from `first_channel` on; zeros where there is no channel.
fn lanes_of(sample: &[f64], first_channel: usize) -> Lanes {
    let rest = &sample[first_channel..];
    rest.first_chunk().copied().unwrap_or_else(|| std::array::from_fn(|l| rest.get(l).copied().unwrap_or(0.0)))
}

fn reflected(centre: Lanes, x: Lanes) -> Lanes {
    std::array::from_fn(|l| 2.0 * centre[l] - x[l])
}

/// Eight channels: their record, extended, and the filter with their state.
struct ChannelSet {
    first_channel: usize,
    record: Vec<Lanes>,
    /// The gain of the whole cascade, in neither the sections nor the numerator.
    gain: f64,
    sections: Vec<Section>,
    /// `binomial(order, j)`: the coefficients of `(1 + z^-1)^order`.
    numerator: Vec<f64>,
}

impl ChannelSet {
    fn new(filter: &SecondOrderSections, samples: usize) -> Self {
        Self {
            first_channel: 0,
            record: vec![[0.0; LANES]; samples],
            gain: filter.sections()[0][0],
            sections: filter.sections().iter().map(Section::new).collect(),
            numerator: binomials(filter.order()),
        }
    }

    fn start_forward(&mut self, input: Extended) {
        let mut x = input.lanes(0, self.first_channel).map(|x| self.gain * x);
        for section in &mut self.sections {
            x = section.settle(section.zeros, x);
        }
    }

    fn load(&mut self, input: Extended, k: usize) {
        self.record[k] = input.lanes(k, self.first_channel).map(|x| self.gain * x);
    }

    fn forward(&mut self, block: Range<usize>) {
        let record = &mut self.record[block];
        for section in &mut self.sections {
            section.pass(section.zeros, record.iter_mut());
        }
    }

    fn start_backward(&mut self) {
        let mut x = self.record[self.record.len() - 1];
        for section in &mut self.sections {
            x = section.settle(0, x);
        }
    }

    fn backward(&mut self, block: Range<usize>) {
        for section in &mut self.sections {
            section.pass(0, self.record[block.clone()].iter_mut().rev());
        }
    }

    /// Writes the channels at sample `k` of the extended record.
    fn store(&self, k: usize, sample: &mut [f64]) {
        let mut sum = [0.0; LANES];
        for (c, w) in zip(&self.numerator, &self.record[k..]) {
            sum = std::array::from_fn(|l| sum[l] + c * w[l]);
        }
        for (y, sum) in zip(&mut sample[self.first_channel..], sum) {
            *y = self.gain * sum;
        }
    }
}

/// One row of Pascal's triangle.
fn binomials(order: usize) -> Vec<f64> {
    let mut row = vec![1.0];
    for j in 0..order {
        row.push(row[j] * (order - j) as f64 / (j + 1) as f64);
    }
    row
}

/// One section in the direct form II: `w[k] = x[k] - a1 w[k-1] - a2 w[k-2]`, then a factor `1 + z^-1` for each zero.
struct Section {
    a1: f64,
    a2: f64,
    /// How many zeros the section has at `z = -1`.
    zeros: usize,
    /// `w[k-1]`
    w1: Lanes,
    /// `w[k-2]`
    w2: Lanes,
}

impl Section {
    fn new(&[_, _, b2, a1, a2]: &[f64; 5]) -> Self {
        Self { a1, a2, zeros: if b2 == 0.0 { 1 } else { 2 }, w1: [0.0; LANES], w2: [0.0; LANES] }
    }

    /// Sets the state to that after an endless constant input, and returns the output then.
    fn settle(&mut self, zeros: usize, x: Lanes) -> Lanes {
        self.w1 = x.map(|x| x / (1.0 + self.a1 + self.a2));
        self.w2 = self.w1;
        self.w1.map(|w| w * (1 << zeros) as f64)
    }

    /// Filters the samples in place, with none, one or two of the section's zeros.
    fn pass<'a>(&mut self, zeros: usize, samples: impl Iterator<Item = &'a mut Lanes>) {
        match zeros {
            0 => self.pass_with(samples, |w, _, _| w),
            1 => self.pass_with(samples, |_, s, _| s),
            _ => self.pass_with(samples, |_, s, s1| s + s1),
        }
    }

    /// `output` chooses from `w[k]`, `s[k] = w[k] + w[k-1]` and `s[k-1]`.
    fn pass_with<'a>(&mut self, samples: impl Iterator<Item = &'a mut Lanes>, output: impl Fn(f64, f64, f64) -> f64) {
        let (a1, a2, mut w1, mut w2) = (self.a1, self.a2, self.w1, self.w2);
        let mut s1: Lanes = std::array::from_fn(|l| w1[l] + w2[l]);
        for sample in samples {
            for l in 0..LANES {
                let w = sample[l] - a2 * w2[l] - a1 * w1[l];
                let s = w + w1[l];
                sample[l] = output(w, s, s1[l]);
                (w1[l], w2[l], s1[l]) = (w, w1[l], s);
            }
        }
        (self.w1, self.w2) = (w1, w2);
    }
}
