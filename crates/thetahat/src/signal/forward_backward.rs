//! The one kernel of this room: a cascade of sections over many channels, forward and then backward in time.
//!
//! Eight channels at a time, a set, are copied out of the series and filtered in place. The innermost loop runs over
//! the eight, which the compiler turns into vector instructions; a section passes over a block of samples with its
//! state in registers, and the block stays in the first-level cache while all sections pass over it. Two sets are
//! copied together: to read the series takes as long as one pass, and a little longer if by single sets.
//!
//! Legend: `x` input, `w` after the poles, `y` output of a section. All zeros that matter are at `z = -1` (SciPy's
//! others, at 0, do nothing), so a numerator is a sum of neighbours: the forward pass adds them section by section;
//! the backward pass runs the poles alone and forms `y[k] = sum_j binomial(order, j) w[k + j]` where `y[k]` is kept.

use std::iter::zip;

use crate::series::Series;

use super::SecondOrderSections;

/// Channels filtered together.
const LANES: usize = 8;
/// Sets of channels copied together.
const SETS: usize = 2;
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
}

/// The kept samples of `input`, filtered forward and backward, with `padding` samples of odd extension at both ends
/// and each pass started in the steady state of its first value.
///
/// The record must be longer than the padding, and the padding at least as long as the order.
pub(super) fn forward_backward(filter: &SecondOrderSections, padding: usize, input: &Series, kept: Kept) -> Series {
    let mut output = Series::zeros(kept.indices(input.len()).count(), input.channels());
    let extended = Extended { series: input, padding };
    let first_channels: Vec<usize> = (0..input.channels()).step_by(LANES).collect();
    let mut sets = vec![ChannelSet::new(filter, extended.len()); first_channels.len().min(SETS)];
    for first_channels in first_channels.chunks(SETS) {
        let sets = &mut sets[..first_channels.len()];
        zip(sets.iter_mut(), first_channels).for_each(|(set, &c)| set.first_channel = c);
        load(sets, extended);
        for set in sets {
            set.forward();
            set.backward();
            let samples = kept.indices(input.len()).enumerate();
            samples.for_each(|(row, k)| set.store(padding + k, output.sample_mut(row)));
        }
    }
    output
}

/// Copies the channels of some sets, extended at both ends.
fn load(sets: &mut [ChannelSet], input: Extended) {
    for k in 0..input.len() {
        sets.iter_mut().for_each(|set| set.load(input, k));
    }
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

    /// Eight channels at sample `k` of the extended record.
    #[inline]
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
#[derive(Clone)]
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

    fn load(&mut self, input: Extended, k: usize) {
        self.record[k] = input.lanes(k, self.first_channel).map(|x| self.gain * x);
    }

    fn forward(&mut self) {
        let mut x = self.record[0];
        self.sections.iter_mut().for_each(|section| x = section.settle(section.zeros, x));
        for block in self.record.chunks_mut(BLOCK) {
            self.sections.iter_mut().for_each(|section| section.pass(section.zeros, block.iter_mut()));
        }
    }

    /// Leaves `w` in the record, without the numerator and the gain.
    fn backward(&mut self) {
        let mut x = self.record[self.record.len() - 1];
        self.sections.iter_mut().for_each(|section| x = section.settle(0, x));
        for block in self.record.rchunks_mut(BLOCK) {
            self.sections.iter_mut().for_each(|section| section.pass(0, block.iter_mut().rev()));
        }
    }

    /// Writes the channels at sample `k` of the extended record, after the backward pass.
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
#[derive(Clone)]
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
