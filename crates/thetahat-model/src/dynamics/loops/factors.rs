//! Least squares with `J_p`: modified Gram-Schmidt, which is as accurate as Householder's method when right-hand sides are treated as
//! further columns.

use crate::dynamics::{model::ClosedTree, workspace::LoopScratch};
use thetahat_ground::linear_algebra::{dot, norm};

/// Part of a column of `J_p`, relative to the longest, below which the passive joint can move while the others stand still.
const SINGULAR: f64 = 1e-4;

impl ClosedTree {
    /// Factors `J_p` of the scratch.
    ///
    /// # Errors
    /// The passive joint, as a coordinate of the tree, that the conditions do not determine.
    pub(super) fn factor(&self, scratch: &mut LoopScratch) -> Result<(), usize> {
        let (n, count, rows) = (self.tree.coordinate_count(), self.passive.len(), self.equations);
        let LoopScratch { jacobian, basis, triangle, .. } = scratch;
        for (column, &c) in self.passive.iter().enumerate() {
            (0..rows).for_each(|row| basis[column * rows + row] = jacobian[row * n + c]);
        }
        let longest = basis.chunks_exact(rows.max(1)).map(norm).fold(0.0, f64::max);
        for column in 0..count {
            let (before, own) = basis.split_at_mut(column * rows);
            let own = &mut own[..rows];
            for (k, direction) in before.chunks_exact(rows).enumerate() {
                let along = dot(direction, own);
                triangle[k * count + column] = along;
                own.iter_mut().zip(direction).for_each(|(x, d)| *x -= along * d);
            }
            let length = norm(own);
            if length.is_nan() || length <= SINGULAR * longest {
                return Err(self.passive[column]);
            }
            triangle[column * count + column] = length;
            own.iter_mut().for_each(|x| *x /= length);
        }
        Ok(())
    }

    /// Solves `J_p x = rest` for the right-hand side in the scratch, which keeps what no `x` explains; the solution is in `solved`.
    pub(super) fn solve(&self, scratch: &mut LoopScratch) {
        let (count, rows) = (self.passive.len(), self.equations);
        let LoopScratch { basis, triangle, rest, solved, .. } = scratch;
        for (x, direction) in solved.iter_mut().zip(basis.chunks_exact(rows.max(1))) {
            *x = dot(direction, rest);
            rest.iter_mut().zip(direction).for_each(|(r, d)| *r -= *x * d);
        }
        for k in (0..count).rev() {
            let later: f64 = (k + 1..count).map(|i| triangle[k * count + i] * solved[i]).sum();
            solved[k] = (solved[k] - later) / triangle[k * count + k];
        }
    }
}
