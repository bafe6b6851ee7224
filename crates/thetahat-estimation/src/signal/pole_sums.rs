//! Forward-backward filtering that keeps few samples: sums over intervals instead of two recursions over all samples.
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
//! q later, `s_j` and `t_j` take a factor `p_j^q` and a weighted sum of the q samples between. Those sums are the only work done for every
//! sample; they are not recursive, and the samples need not be stored.
//!
//! Poles come in conjugate pairs, of which one is kept and the real part of its terms doubled.

use num_complex::Complex64;

use super::design::SecondOrderSections;

/// Channels of one tile: two vectors of four.
pub(super) const LANES: usize = 8;
/// Weights of one interval: real and imaginary parts, causal and anticausal, of four pairs of poles.
pub(super) const PAIRS: usize = 4;
pub(super) const WEIGHTS: usize = 4 * PAIRS;

/// A low-pass of order eight with complex poles, as a sum over its poles.
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
    pub(super) at_sample: f64,
}

impl PoleSums {
    /// The pole sums of a filter; none if it does not have four pairs of complex poles.
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

    /// `2 Re sum_j c_j a_j`: the contribution of sums to the output at their sample.
    pub(super) fn output(&self, sums: &Sums) -> f64 {
        twice_real(&self.two_sided, &sums.0)
    }

    /// `p_j^samples`.
    pub(super) fn decay(&self, samples: usize) -> [Complex64; PAIRS] {
        power(&self.poles, samples)
    }

    /// The number of samples after which every power of a pole is below `remainder`.
    pub(super) fn reach(&self, remainder: f64) -> usize {
        let largest = self.poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
        (remainder.ln() / largest.ln()).ceil() as usize
    }

    /// The causal sums of a channel that has been constant at `x`.
    pub(super) fn steady(&self, x: f64) -> Sums {
        Sums(self.poles.map(|p| x * (Complex64::ONE - p).inv()))
    }

    /// `e_j p_j / c_j` from the causal sums at the last sample `x` of the extended recording: the steady state in which the
    /// backward pass starts, as anticausal sums at that sample.
    pub(super) fn end(&self, last: &Sums, x: f64) -> Sums {
        let forward = self.direct * x + twice_real(&self.residues, &last.0);
        let weighted = std::array::from_fn(|i| self.residues[i] * self.poles[i] * last.0[i]);
        let end = |j: usize| forward / (Complex64::ONE - self.poles[j]) - self.mirrored(&weighted, self.poles[j]);
        Sums(std::array::from_fn(|j| self.residues[j] * end(j) * self.poles[j] / self.two_sided[j]))
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

/// Consecutive samples of the extended recording, `width` values each.
pub(super) struct Interval {
    pub(super) samples: usize,
    pub(super) values: Vec<f64>,
}

/// One complex number for each pair of poles: sums of a channel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Sums(pub(super) [Complex64; PAIRS]);

impl Sums {
    /// `decay_j self_j + added_j`
    pub(super) fn decayed(&self, decay: &[Complex64; PAIRS], added: &Self) -> Self {
        Self(std::array::from_fn(|j| decay[j] * self.0[j] + added.0[j]))
    }
}

/// The sums over one interval, channel by channel: its contribution to the causal sums at its last sample, and to the anticausal sums at
/// the sample before its first.
pub(super) fn interval_sums(interval: &Interval, width: usize, weights: &[[f64; WEIGHTS]]) -> Vec<[Sums; 2]> {
    let mut of_channels = vec![[Sums::default(); 2]; width];
    for (tile, of_tile) in of_channels.chunks_exact_mut(LANES).enumerate() {
        let columns = TileOfInterval { values: &interval.values[tile * LANES..], width, weights };
        let sums = pulp::Arch::new().dispatch(columns);
        for (lane, [causal, anticausal]) in of_tile.iter_mut().enumerate() {
            for j in 0..PAIRS {
                let [re, im, anticausal_re, anticausal_im] = [0, 1, 2, 3].map(|part| sums[part * PAIRS + j][lane]);
                causal.0[j] = Complex64::new(re, im);
                anticausal.0[j] = Complex64::new(anticausal_re, anticausal_im);
            }
        }
    }
    of_channels
}

fn power(poles: &[Complex64; PAIRS], exponent: usize) -> [Complex64; PAIRS] {
    poles.map(|p| p.powu(exponent as u32))
}

impl PoleSums {
    pub(super) fn weights(&self, samples: usize) -> Vec<[f64; WEIGHTS]> {
        weights_of(&self.poles, samples)
    }
}

/// The weights of the samples `m = 1 ... n` of an interval: real and imaginary parts of `p_j^(n-m)`, then of `p_j^m`.
fn weights_of(poles: &[Complex64; PAIRS], samples: usize) -> Vec<[f64; WEIGHTS]> {
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

/// Eight channels of an interval: all the work done for every sample. Compiled once for each instruction set; callees must be inlined.
struct TileOfInterval<'a> {
    values: &'a [f64],
    width: usize,
    weights: &'a [[f64; WEIGHTS]],
}

impl pulp::WithSimd for TileOfInterval<'_> {
    type Output = [[f64; LANES]; WEIGHTS];

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let mut sums = [[0.0; LANES]; WEIGHTS];
        // Four weights at a time, so that their sums stay in registers.
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
