//! Torques or accelerations as linear functions of the sensitivities of the state.

use pulp::{Simd, WithSimd};

use super::columns::{ColumnBlocks, Wide, add_product, solve_columns};

/// `explicit - A S_q - B S_dq`, with the sensitivities S of positions and velocities, for all columns.
pub(super) struct LinearTerms {
    /// A, n by n, row by row.
    pub(super) by_position: Vec<f64>,
    /// B, n by n, row by row.
    pub(super) by_velocity: Vec<f64>,
    /// The part without S, n rows.
    pub(super) explicit: ColumnBlocks,
}

impl LinearTerms {
    pub(super) fn zeros(n: usize, columns: usize) -> Self {
        let zeros = || vec![0.0; n * n];
        Self { by_position: zeros(), by_velocity: zeros(), explicit: ColumnBlocks::zeros(n, columns) }
    }

    pub(super) fn fill_with_zeros(&mut self) {
        self.by_position.fill(0.0);
        self.by_velocity.fill(0.0);
        self.explicit.fill_with_zeros();
    }

    /// The value of the terms, n rows.
    pub(super) fn evaluate(&self, state: &ColumnBlocks, out: &mut ColumnBlocks) {
        pulp::Arch::new().dispatch(Evaluation { terms: self, state, out });
    }

    /// The slopes of the sensitivities, positions before velocities, where the terms are `M` times those of the velocities;
    /// `mass` are the factors of M.
    pub(super) fn slopes(&self, state: &ColumnBlocks, mass: &[f64], out: &mut ColumnBlocks) {
        pulp::Arch::new().dispatch(Slopes { terms: self, state, mass, out });
    }

    /// The rows of a block.
    #[inline(always)]
    fn evaluate_block(&self, block: usize, state: &ColumnBlocks, out: &mut [Wide]) {
        let n = out.len();
        let (q, dq) = state.block(block).split_at(n);
        for (i, (out, explicit)) in out.iter_mut().zip(self.explicit.block(block)).enumerate() {
            let mut sum = *explicit;
            for j in 0..n {
                add_product(&mut sum, -self.by_position[i * n + j], &q[j]);
                add_product(&mut sum, -self.by_velocity[i * n + j], &dq[j]);
            }
            *out = sum;
        }
    }
}

struct Evaluation<'a> {
    terms: &'a LinearTerms,
    state: &'a ColumnBlocks,
    out: &'a mut ColumnBlocks,
}

impl WithSimd for Evaluation<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for block in 0..self.state.blocks() {
            self.terms.evaluate_block(block, self.state, self.out.block_mut(block));
        }
    }
}

struct Slopes<'a> {
    terms: &'a LinearTerms,
    state: &'a ColumnBlocks,
    mass: &'a [f64],
    out: &'a mut ColumnBlocks,
}

impl WithSimd for Slopes<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.state.rows() / 2;
        for block in 0..self.state.blocks() {
            let (of_positions, of_velocities) = self.out.block_mut(block).split_at_mut(n);
            of_positions.copy_from_slice(&self.state.block(block)[n..]);
            self.terms.evaluate_block(block, self.state, of_velocities);
            solve_columns(self.mass, of_velocities);
        }
    }
}
