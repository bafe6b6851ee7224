//! Sums of sensitivities and their slopes.

use pulp::{Simd, WithSimd};

use super::columns::{ColumnBlocks, add_product};

/// At least the slopes of a step of any method.
const MOST_SLOPES: usize = 7;

/// `out = start + sum weights slopes`.
pub(super) fn combine<'a>(
    start: &ColumnBlocks,
    terms: impl Iterator<Item = (&'a ColumnBlocks, f64)>,
    out: &mut ColumnBlocks,
) {
    let mut used: [(&ColumnBlocks, f64); MOST_SLOPES] = [(start, 0.0); MOST_SLOPES];
    let mut count = 0;
    for (slot, term) in used.iter_mut().zip(terms.filter(|(_, weight)| *weight != 0.0)) {
        *slot = term;
        count += 1;
    }
    pulp::Arch::new().dispatch(Combination { start, terms: &used[..count], out });
}

struct Combination<'a> {
    start: &'a ColumnBlocks,
    terms: &'a [(&'a ColumnBlocks, f64)],
    out: &'a mut ColumnBlocks,
}

impl WithSimd for Combination<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for block in 0..self.start.blocks() {
            let (start, out) = (self.start.block(block), self.out.block_mut(block));
            for (row, out) in out.iter_mut().enumerate() {
                let mut sum = start[row];
                for (slopes, weight) in self.terms {
                    add_product(&mut sum, *weight, &slopes.block(block)[row]);
                }
                *out = sum;
            }
        }
    }
}
