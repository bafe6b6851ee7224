//! A matrix of few rows and many columns, in blocks of eight columns.

use pulp::{Simd, WithSimd};

/// Columns of a block.
const WIDTH: usize = 8;

/// One row of a block.
pub(super) type Wide = [f64; WIDTH];

/// A row of zeros.
pub(super) const ZEROS: Wide = [0.0; WIDTH];

/// A matrix, block after block of eight columns, and row after row in a block: a kernel that works on one block keeps it in
/// registers and in the nearest cache. The columns that fill up the last block are zero.
#[derive(Debug, Clone)]
pub(super) struct ColumnBlocks {
    rows: usize,
    values: Vec<Wide>,
}

impl ColumnBlocks {
    pub(super) fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, values: vec![ZEROS; rows * columns.div_ceil(WIDTH)] }
    }

    pub(super) fn fill_with_zeros(&mut self) {
        self.values.fill(ZEROS);
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.values.copy_from_slice(&other.values);
    }

    /// A matrix of zeros with the same number of columns and other rows.
    pub(super) fn with_rows(&self, rows: usize) -> Self {
        Self { rows, values: vec![ZEROS; rows * self.blocks()] }
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// Number of blocks.
    #[inline(always)]
    pub(super) fn blocks(&self) -> usize {
        self.values.len() / self.rows
    }

    /// The rows of a block.
    #[inline(always)]
    pub(super) fn block(&self, block: usize) -> &[Wide] {
        &self.values[block * self.rows..(block + 1) * self.rows]
    }

    /// The same, to write to.
    #[inline(always)]
    pub(super) fn block_mut(&mut self, block: usize) -> &mut [Wide] {
        &mut self.values[block * self.rows..(block + 1) * self.rows]
    }

    #[inline]
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.values[column / WIDTH * self.rows + row][column % WIDTH] += value;
    }

    /// Adds values to the first rows of a column.
    pub(super) fn add_column(&mut self, column: usize, values: impl Iterator<Item = f64>) {
        values.enumerate().for_each(|(row, value)| self.add(row, column, value));
    }

    /// Adds `factor` times a row of another matrix with as many columns to a row.
    pub(super) fn add_row(&mut self, row: usize, factor: f64, other: &Self, other_row: usize) {
        for block in 0..self.blocks() {
            add_product(&mut self.block_mut(block)[row], factor, &other.block(block)[other_row]);
        }
    }

    /// Writes the first rows to `to`, row after row, with as many columns as each has room for.
    pub(super) fn write_rows(&self, rows: usize, to: &mut [f64]) {
        for (row, to) in to.chunks_exact_mut((to.len() / rows).max(1)).enumerate() {
            for (block, to) in to.chunks_mut(WIDTH).enumerate() {
                to.copy_from_slice(&self.block(block)[row][..to.len()]);
            }
        }
    }
}

/// `to += factor x`.
#[inline(always)]
pub(super) fn add_product(to: &mut Wide, factor: f64, x: &Wide) {
    to.iter_mut().zip(x).for_each(|(to, x)| *to += factor * x);
}

/// `out = start + sum weights terms`, of at most seven terms; without a start, from zeros.
pub(super) fn combine(
    start: Option<&ColumnBlocks>,
    terms: &[ColumnBlocks],
    weights: impl IntoIterator<Item = f64>,
    out: &mut ColumnBlocks,
) {
    let mut used = [0.0; WIDTH];
    used.iter_mut().zip(weights).for_each(|(used, weight)| *used = weight);
    pulp::Arch::new().dispatch(Combination { start, terms, weights: &used, out });
}

struct Combination<'a> {
    start: Option<&'a ColumnBlocks>,
    terms: &'a [ColumnBlocks],
    weights: &'a [f64],
    out: &'a mut ColumnBlocks,
}

impl WithSimd for Combination<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let mut used: [Weighted<'_>; WIDTH] = [(0.0, &[]); WIDTH];
        let terms = self.terms.iter().zip(self.weights).filter(|(_, weight)| **weight != 0.0);
        let mut count = 0;
        for (used, (term, weight)) in used.iter_mut().zip(terms) {
            *used = (*weight, &term.values);
            count += 1;
        }
        let (start, out) = (self.start.map(|start| &start.values[..]), &mut self.out.values[..]);
        match count {
            0 => sum::<0>(start, &used, out),
            1 => sum::<1>(start, &used, out),
            2 => sum::<2>(start, &used, out),
            3 => sum::<3>(start, &used, out),
            4 => sum::<4>(start, &used, out),
            5 => sum::<5>(start, &used, out),
            6 => sum::<6>(start, &used, out),
            _ => sum::<7>(start, &used, out),
        }
    }
}

/// A weight and its rows.
type Weighted<'a> = (f64, &'a [Wide]);

/// The sum of the first `K` terms, row by row: the number of terms is a constant for the compiler.
#[inline(always)]
fn sum<const K: usize>(start: Option<&[Wide]>, terms: &[Weighted<'_>; WIDTH], out: &mut [Wide]) {
    let rows = out.len();
    let terms: [Weighted<'_>; K] = std::array::from_fn(|k| (terms[k].0, &terms[k].1[..rows]));
    for (row, out) in out.iter_mut().enumerate() {
        let mut sum = start.map_or(ZEROS, |start| start[row]);
        for (weight, term) in &terms {
            add_product(&mut sum, *weight, &term[row]);
        }
        *out = sum;
    }
}

/// Solves `L D L^T x = b` in place for the columns of a block, with `1/D` on the diagonal of the factors.
#[inline(always)]
pub(super) fn solve_columns(factors: &[f64], b: &mut [Wide]) {
    let n = b.len();
    for i in 1..n {
        let (before, rest) = b.split_at_mut(i);
        for (l, x) in factors[i * n..].iter().zip(&*before) {
            add_product(&mut rest[0], -l, x);
        }
    }
    for i in (0..n).rev() {
        let (before, after) = b.split_at_mut(i + 1);
        let inverse = factors[i * n + i];
        before[i].iter_mut().for_each(|x| *x *= inverse);
        for (k, x) in after.iter().enumerate() {
            add_product(&mut before[i], -factors[(i + 1 + k) * n + i], x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_written_without_what_fills_the_last_block() {
        let mut matrix = ColumnBlocks::zeros(2, 11);
        (0..11).for_each(|column| matrix.add_column(column, [1.0, 10.0].into_iter().map(|row| row * column as f64)));
        let mut rows = [0.0; 22];
        matrix.write_rows(2, &mut rows);
        assert!((0..22).all(|k| rows[k] == [1.0, 10.0][k / 11] * (k % 11) as f64));
    }

    /// `M = L D L^T` of [[4, 2], [2, 3]]: D = (4, 2), l = 0.5.
    #[test]
    fn a_block_is_solved_as_a_vector_is() {
        let mut b = [[8.0; WIDTH], [7.0; WIDTH]];
        b[1][3] = 5.0;
        solve_columns(&[0.25, 0.0, 0.5, 0.5], &mut b);
        for (column, [x, y]) in [(0, [1.25, 1.5]), (3, [1.75, 0.5])] {
            assert!((b[0][column] - x).abs() < 1e-15 && (b[1][column] - y).abs() < 1e-15, "{b:?}");
        }
    }
}
