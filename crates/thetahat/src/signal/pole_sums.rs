//! Forward-backward filtering where few samples are kept: sums over blocks instead of two recursions over all samples.
//!
//! The poles of the low-pass are simple, so that one pass is `H(z) = d + sum_j r_j / (1 - p_j z^-1)`. With the causal sums
//! `s_j[k] = sum_(l <= k) p_j^(k-l) x[l]` and the anticausal ones `t_j[k] = sum_(l > k) p_j^(l-k) x[l]` the output of both
//! passes over `x[0..n]` is
//!
//! ```text
//! y[k] = sum_j c_j (s_j[k] + t_j[k]) + g x[k] + sum_j e_j p_j^(n-k)
//! c_j  = r_j H(1/p_j) = r_j (d + sum_i r_i / (1 - p_i p_j))
//! g    = d (d + sum_j r_j)
//! e_j  = r_j (y1 / (1 - p_j) - sum_i r_i p_i s_i[n-1] / (1 - p_i p_j))
//! ```
//!
//! where `y1 = d x[n-1] + sum_j r_j s_j[n-1]` is the last output of the forward pass, from which the backward pass starts in
//! its steady state, as the forward pass does from `x[0]`: `s_j[-1] = x[0] / (1 - p_j)`. From one kept sample to the next,
//! q later, `s_j` and `t_j` take a factor `p_j^q` and a weighted sum of the q samples between. Those sums are all
//! that is done for every sample; nothing is recursive in them, and the samples need not be stored.
//!
//! Poles come in conjugate pairs, of which one is kept and the real part of its terms doubled.

use std::ops::Range;

use num_complex::Complex64;

use super::SecondOrderSections;
use super::forward_backward::{Kept, Shape};
use crate::series::Series;

/// Channels of one tile: two vectors of four.
const LANES: usize = 8;
/// Weights of one block: real and imaginary parts, causal and anticausal, of four pairs of poles.
const PAIRS: usize = 4;
const WEIGHTS: usize = 4 * PAIRS;

/// A low-pass of order eight with complex poles as a sum over its poles.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PoleSums {
    /// One of each conjugate pair.
    poles: [Complex64; PAIRS],
    /// `r_j`
    residues: [Complex64; PAIRS],
    /// `c_j`
    two_sided: [Complex64; PAIRS],
    /// `d`
    direct: f64,
    /// `g`
    at_sample: f64,
}

impl PoleSums {
    /// The sums of a filter; none if it has not four pairs of complex poles.
    pub(super) fn new(filter: &SecondOrderSections) -> Option<Self> {
        let sections: [[f64; 5]; PAIRS] = filter.sections().try_into().ok()?;
        let mut poles = [Complex64::ZERO; PAIRS];
        for (pole, [.., a1, a2]) in poles.iter_mut().zip(&sections) {
            let squared = a2 - 0.25 * a1 * a1;
            if squared.is_nan() || squared <= 0.0 {
                return None;
            }
            *pole = Complex64::new(-0.5 * a1, squared.sqrt());
        }
        let direct = sections.iter().map(|[_, _, b2, _, a2]| b2 / a2).product();
        let residues = std::array::from_fn(|j| residue(&sections, &poles, j));
        let mut sums = Self { poles, residues, two_sided: residues, direct, at_sample: 0.0 };
        sums.two_sided = std::array::from_fn(|j| residues[j] * (direct + sums.mirrored(&residues, poles[j])));
        sums.at_sample = direct * (direct + twice_real(&residues, &[Complex64::ONE; PAIRS]));
        Some(sums)
    }

    /// `sum_i a_i / (1 - p_i p)` over all poles, for a real sequence: pairs `a_i, p_i` and their conjugates.
    fn mirrored(&self, a: &[Complex64; PAIRS], p: Complex64) -> Complex64 {
        let term = |i: usize| {
            a[i] / (Complex64::ONE - self.poles[i] * p) + a[i].conj() / (Complex64::ONE - self.poles[i].conj() * p)
        };
        (0..PAIRS).map(term).sum()
    }

    /// The kept samples of a record, filtered as [`forward_backward`](super::forward_backward::forward_backward) does
    /// it. `fill` writes the channels of one sample after the other.
    pub(super) fn filter_and_keep(&self, shape: Shape, kept: Kept, fill: impl FnMut(usize, &mut [f64])) -> Series {
        let mut pass = Pass::new(self, shape, fill);
        let mut output = Series::zeros(kept.indices(shape.samples).count(), shape.channels);
        let mut next = 0;
        for (row, k) in kept.indices(shape.samples).enumerate() {
            let block = if row == 0 { pass.first_block(k) } else { pass.block(next..k + 1) };
            pass.take(block);
            pass.write_causal(output.sample_mut(row));
            next = k + 1;
        }
        let tail = pass.last_block();
        pass.take(tail);
        pass.add_anticausal(&mut output);
        output
    }
}

/// `r_j`: the numerator over the denominator without the factor of this pole, at `z = p_j`.
fn residue(sections: &[[f64; 5]; PAIRS], poles: &[Complex64; PAIRS], j: usize) -> Complex64 {
    let back = poles[j].inv();
    let numerator: Complex64 = sections.iter().map(|[b0, b1, b2, ..]| b0 + back * (b1 + back * b2)).product();
    let factor = |i: usize| {
        let conjugate = Complex64::ONE - poles[i].conj() * back;
        if i == j { conjugate } else { conjugate * (Complex64::ONE - poles[i] * back) }
    };
    numerator / (0..PAIRS).map(factor).product::<Complex64>()
}

/// `sum_j a_j b_j` over pairs and their conjugates.
fn twice_real(a: &[Complex64; PAIRS], b: &[Complex64; PAIRS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| 2.0 * (a * b).re).sum()
}

/// Consecutive samples of the extended record, `width` values each.
struct Block {
    samples: usize,
    values: Vec<f64>,
}

/// What a block adds to the sums of one channel, and to the anticausal ones of all samples before it.
#[derive(Clone, Copy, Default)]
struct Sums([Complex64; PAIRS]);

/// One record on its way through the sums.
struct Pass<'a, F> {
    sums: &'a PoleSums,
    shape: Shape,
    fill: F,
    /// Channels, filled up with zeros to whole tiles.
    width: usize,
    /// The first samples, which the extension needs before their turn, and the last ones.
    head: Vec<f64>,
    tail: Vec<f64>,
    /// The last sample taken.
    sample: Vec<f64>,
    /// `s_j` of each channel there.
    causal: Vec<Sums>,
    /// Of each block: its length, and the anticausal sums over it of each channel.
    behind: Vec<(usize, Vec<Sums>)>,
    weights: Vec<[f64; WEIGHTS]>,
}

impl<'a, F: FnMut(usize, &mut [f64])> Pass<'a, F> {
    fn new(sums: &'a PoleSums, shape: Shape, mut fill: F) -> Self {
        let width = shape.channels.next_multiple_of(LANES);
        let mut head = vec![0.0; (shape.padding + 1) * width];
        head.chunks_mut(width).enumerate().for_each(|(k, sample)| fill(k, &mut sample[..shape.channels]));
        Self {
            sums,
            shape,
            fill,
            width,
            tail: vec![0.0; head.len()],
            head,
            sample: vec![0.0; width],
            causal: Vec::new(),
            behind: Vec::new(),
            weights: Vec::new(),
        }
    }

    /// The samples in `range` of the record.
    fn block(&mut self, range: Range<usize>) -> Block {
        let mut values = vec![0.0; range.len() * self.width];
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
    fn first_block(&mut self, kept: usize) -> Block {
        let padding = self.shape.padding;
        let mut values: Vec<f64> = Vec::new();
        for k in (1..=padding).rev() {
            values.extend((0..self.width).map(|c| 2.0 * self.head[c] - self.head[k * self.width + c]));
        }
        let steady = self.sums.poles.map(|p| (Complex64::ONE - p).inv());
        self.causal = values[..self.width].iter().map(|x| Sums(steady.map(|s| s * x))).collect();
        let record = self.block(0..kept + 1);
        values.extend(record.values);
        Block { samples: padding + record.samples, values }
    }

    /// The extension behind the record.
    fn last_block(&self) -> Block {
        let (padding, width) = (self.shape.padding, self.width);
        let last = &self.tail[padding * width..];
        let reflected = (1..=padding).flat_map(|k| {
            let sample = &self.tail[(padding - k) * width..][..width];
            last.iter().zip(sample).map(|(l, x)| 2.0 * l - x)
        });
        Block { samples: padding, values: reflected.collect() }
    }

    /// Adds a block to the sums.
    fn take(&mut self, block: Block) {
        self.sample.copy_from_slice(&block.values[(block.samples - 1) * self.width..]);
        if self.weights.len() != block.samples {
            self.weights = weights(&self.sums.poles, block.samples);
        }
        let decay = power(&self.sums.poles, block.samples);
        let mut behind = vec![Sums::default(); self.width];
        for tile in (0..self.width).step_by(LANES) {
            let columns = TileOfBlock { values: &block.values[tile..], width: self.width, weights: &self.weights };
            let sums = pulp::Arch::new().dispatch(columns);
            for lane in 0..LANES {
                let part = |i: usize| Sums::from_parts(|j| (sums[i + j][lane], sums[i + PAIRS + j][lane]));
                let causal = &mut self.causal[tile + lane];
                *causal = Sums(std::array::from_fn(|j| decay[j] * causal.0[j] + part(0).0[j]));
                behind[tile + lane] = part(2 * PAIRS);
            }
        }
        self.behind.push((block.samples, behind));
    }

    /// `sum_j c_j s_j + g x` at the last sample taken.
    fn write_causal(&self, output: &mut [f64]) {
        let PoleSums { two_sided, at_sample, .. } = self.sums;
        for ((y, causal), x) in output.iter_mut().zip(&self.causal).zip(&self.sample) {
            *y = twice_real(two_sided, &causal.0) + at_sample * x;
        }
    }

    /// Adds the anticausal sums, and the steady state in which the backward pass starts, from the last row to the first.
    fn add_anticausal(&self, output: &mut Series) {
        let PoleSums { poles, two_sided, .. } = self.sums;
        let mut ends: Vec<Sums> = (0..self.shape.channels).map(|c| self.end(c)).collect();
        let mut anticausal = vec![Sums::default(); self.shape.channels];
        // e_j p_j^(n-k), with k = n - 1 before the last block.
        ends.iter_mut().for_each(|e| e.0.iter_mut().zip(poles).for_each(|(e, p)| *e *= p));
        for row in (0..output.len()).rev() {
            let (length, behind) = &self.behind[row + 1];
            let decay = power(poles, *length);
            for (c, y) in output.sample_mut(row).iter_mut().enumerate() {
                for (j, decay) in decay.iter().enumerate() {
                    anticausal[c].0[j] = decay * anticausal[c].0[j] + behind[c].0[j];
                    ends[c].0[j] *= decay;
                }
                let end: f64 = ends[c].0.iter().map(|e| 2.0 * e.re).sum();
                *y += twice_real(two_sided, &anticausal[c].0) + end;
            }
        }
    }

    /// `e_j` of a channel.
    fn end(&self, channel: usize) -> Sums {
        let PoleSums { poles, residues, direct, .. } = self.sums;
        let last = &self.causal[channel].0;
        let forward = direct * self.sample[channel] + twice_real(residues, last);
        let weighted = std::array::from_fn(|i| residues[i] * poles[i] * last[i]);
        let end = |j: usize| forward / (Complex64::ONE - poles[j]) - self.sums.mirrored(&weighted, poles[j]);
        Sums(std::array::from_fn(|j| residues[j] * end(j)))
    }
}

impl Sums {
    fn from_parts(parts: impl Fn(usize) -> (f64, f64)) -> Self {
        Self(std::array::from_fn(|j| {
            let (re, im) = parts(j);
            Complex64::new(re, im)
        }))
    }
}

fn power(poles: &[Complex64; PAIRS], exponent: usize) -> [Complex64; PAIRS] {
    poles.map(|p| p.powu(exponent as u32))
}

/// The weights of the samples `m = 1 ... n` of a block: real and imaginary parts of `p_j^(n-m)`, then of `p_j^m`.
fn weights(poles: &[Complex64; PAIRS], samples: usize) -> Vec<[f64; WEIGHTS]> {
    let powers: Vec<[Complex64; PAIRS]> = (0..=samples).map(|m| power(poles, m)).collect();
    let of_sample = |m: usize| {
        let (causal, anticausal) = (powers[samples - m], powers[m]);
        std::array::from_fn(|w| match (w / PAIRS, w % PAIRS) {
            (0, j) => causal[j].re,
            (1, j) => causal[j].im,
            (2, j) => anticausal[j].re,
            (_, j) => anticausal[j].im,
        })
    };
    (1..=samples).map(of_sample).collect()
}

/// Eight channels of a block: all that is done for every sample. Compiled once for each kind of vector instructions; what is
/// called from here must be inlined.
struct TileOfBlock<'a> {
    values: &'a [f64],
    width: usize,
    weights: &'a [[f64; WEIGHTS]],
}

impl pulp::WithSimd for TileOfBlock<'_> {
    type Output = [[f64; LANES]; WEIGHTS];

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let mut sums = [[0.0; LANES]; WEIGHTS];
        // Four weights at a time: their sums stay in registers.
        for group in 0..WEIGHTS / PAIRS {
            let mut of_group = [[0.0; LANES]; PAIRS];
            for (sample, weights) in self.values.chunks(self.width).zip(self.weights) {
                let Some((x, _)) = sample.split_first_chunk::<LANES>() else { break };
                for j in 0..PAIRS {
                    let weight = weights[group * PAIRS + j];
                    for l in 0..LANES {
                        of_group[j][l] += weight * x[l];
                    }
                }
            }
            sums[group * PAIRS..][..PAIRS].copy_from_slice(&of_group);
        }
        sums
    }
}
