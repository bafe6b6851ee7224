//! The kernel of this module: a cascade of sections over many channels, forward and then backward in time.
//!
//! Eight channels at a time, a set, are filtered in place. The innermost loop runs over the eight, which the compiler
//! turns into vector instructions; a section passes over a block of samples with its state in registers, and the block
//! stays in the first-level cache while all sections pass over it. The samples come one by one, as they are computed, and go to their sets
//! at once: no series of all channels is stored in addition.
//!
//! Legend: `x` input, `w` after the poles, `y` output of a section. All zeros that matter are at `z = -1` (SciPy's
//! others, at 0, do nothing), so a numerator is a sum of neighbours: the forward pass adds them section by section;
//! the backward pass runs the poles alone and forms `y[k] = sum_j binomial(order, j) w[k + j]` where `y[k]` is kept.

use std::iter::zip;

use thetahat_ground::series::Series;

use super::design::SecondOrderSections;

/// Channels filtered together.
const LANES: usize = 8;
/// Samples per block: 8 kB of values.
const BLOCK: usize = 128;

/// One sample of the channels filtered together.
type Lanes = [f64; LANES];

/// The samples to keep of a recording: `first`, `first + step`, ...
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

/// Size of a recording: samples, channels and the number of samples by which it is extended at both ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub samples: usize,
    pub channels: usize,
    pub padding: usize,
}

/// The kept samples of a recording, filtered forward and backward, with an odd extension at both ends, `2 x[0] - x[k]`, and
/// each pass started in the steady state of its first value. `fill` writes the channels of one sample after the other.
///
/// The recording must be longer than the padding, and the padding at least as long as the order.
pub(super) fn forward_backward(
    filter: &SecondOrderSections,
    shape: Shape,
    kept: Kept,
    mut fill: impl FnMut(usize, &mut [f64]),
) -> Series {
    // Each set is made anew rather than cloned: untouched zeroed memory is free.
    let samples = shape.samples + 2 * shape.padding;
    let mut sets: Vec<ChannelSet> =
        (0..shape.channels.div_ceil(LANES)).map(|_| ChannelSet::new(filter, samples)).collect();
    // Channels that fill up the last set stay zero. A block of samples is computed, then distributed to the sets.
    let width = sets.len() * LANES;
    let mut block = vec![0.0; BLOCK * width];
    for first in (0..shape.samples).step_by(BLOCK) {
        let count = BLOCK.min(shape.samples - first);
        for (k, sample) in block.chunks_mut(width).take(count).enumerate() {
            fill(first + k, &mut sample[..shape.channels]);
        }
        let (lanes, _) = block.as_chunks::<LANES>();
        let stride = sets.len();
        for (s, set) in sets.iter_mut().enumerate() {
            set.load(shape.padding + first, lanes[s..].iter().step_by(stride).take(count));
        }
    }
    let mut output = Series::zeros(kept.indices(shape.samples).count(), shape.channels);
    for (first_channel, set) in zip((0..).step_by(LANES), &mut sets) {
        set.extend(shape.padding);
        pulp::Arch::new().dispatch(BothPasses(set));
        for (row, k) in kept.indices(shape.samples).enumerate() {
            set.store(shape.padding + k, &mut output.sample_mut(row)[first_channel..]);
        }
    }
    output
}

/// Eight channels: their extended recording, and the filter with their state.
struct ChannelSet {
    record: Vec<Lanes>,
    /// The gain of the whole cascade, which is in neither the sections nor the numerator.
    gain: f64,
    sections: Vec<Section>,
    /// `binomial(order, j)`: the coefficients of `(1 + z^-1)^order`.
    numerator: Vec<f64>,
}

impl ChannelSet {
    fn new(filter: &SecondOrderSections, samples: usize) -> Self {
        Self {
            record: vec![[0.0; LANES]; samples],
            gain: filter.sections()[0][0],
            sections: filter.sections().iter().map(Section::new).collect(),
            numerator: binomials(filter.order()),
        }
    }

    /// Loads samples of the extended recording from `k` on.
    fn load<'a>(&mut self, k: usize, samples: impl Iterator<Item = &'a Lanes>) {
        for (into, lanes) in zip(&mut self.record[k..], samples) {
            *into = lanes.map(|x| self.gain * x);
        }
    }

    /// Extends the recording at both ends by its odd reflection about the first and the last sample.
    fn extend(&mut self, padding: usize) {
        let last = self.record.len() - 1 - padding;
        for k in 1..=padding {
            self.record[padding - k] = reflected(&self.record[padding], &self.record[padding + k]);
            self.record[last + k] = reflected(&self.record[last], &self.record[last - k]);
        }
    }

    #[inline(always)]
    fn forward(&mut self) {
        let mut x = self.record[0];
        for section in &mut self.sections {
            x = section.settle(section.zeros, x);
        }
        for block in self.record.chunks_mut(BLOCK) {
            for section in &mut self.sections {
                section.pass(section.zeros, block.iter_mut());
            }
        }
    }

    /// Leaves `w` in the recording, without the numerator and the gain.
    #[inline(always)]
    fn backward(&mut self) {
        let mut x = self.record[self.record.len() - 1];
        for section in &mut self.sections {
            x = section.settle(0, x);
        }
        for block in self.record.rchunks_mut(BLOCK) {
            for section in &mut self.sections {
                section.pass(0, block.iter_mut().rev());
            }
        }
    }

    /// Writes the channels at sample `k` of the extended recording, after the backward pass.
    fn store(&self, k: usize, channels: &mut [f64]) {
        let mut sum = [0.0; LANES];
        for (c, w) in zip(&self.numerator, &self.record[k..]) {
            sum = std::array::from_fn(|l| sum[l] + c * w[l]);
        }
        zip(channels, sum).for_each(|(y, sum)| *y = self.gain * sum);
    }
}

/// Both passes over a set, compiled once for each instruction set; the machine's widest is used. All give the same rounding. All callees
/// are `inline(always)` and loops, not closures: anything that is not inlined is compiled for the narrowest instruction set.
struct BothPasses<'a>(&'a mut ChannelSet);

impl pulp::WithSimd for BothPasses<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.0.forward();
        self.0.backward();
    }
}

/// `2 centre - x`.
fn reflected(centre: &Lanes, x: &Lanes) -> Lanes {
    std::array::from_fn(|l| 2.0 * centre[l] - x[l])
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

    /// Sets the state to that after an endless constant input, and returns the output of that state.
    #[inline(always)]
    fn settle(&mut self, zeros: usize, x: Lanes) -> Lanes {
        self.w1 = x.map(|x| x / (1.0 + self.a1 + self.a2));
        self.w2 = self.w1;
        self.w1.map(|w| w * (1 << zeros) as f64)
    }

    /// Filters the samples in place, with none, one or two of the section's zeros.
    #[inline(always)]
    fn pass<'a>(&mut self, zeros: usize, samples: impl Iterator<Item = &'a mut Lanes>) {
        match zeros {
            0 => self.pass_with(samples, |w, _, _| w),
            1 => self.pass_with(samples, |_, s, _| s),
            _ => self.pass_with(samples, |_, s, s1| s + s1),
        }
    }

    /// `output` selects from `w[k]`, `s[k] = w[k] + w[k-1]` and `s[k-1]`.
    #[inline(always)]
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
