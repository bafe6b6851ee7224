//! A matrix of few rows and many columns, eight columns side by side.

/// Columns of a block.
pub(super) const WIDTH: usize = 8;

/// One row of a block.
pub(super) type Wide = [f64; WIDTH];

/// A matrix, block after block of eight columns, and row after row in a block: a kernel that works on one block keeps it in
/// registers and in the nearest cache. The columns that fill up the last block are zero.
#[derive(Debug, Clone)]
pub(super) struct ColumnBlocks {
    rows: usize,
    values: Vec<Wide>,
}

impl ColumnBlocks {
    pub(super) fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, values: vec![[0.0; WIDTH]; rows * columns.div_ceil(WIDTH)] }
    }

    pub(super) fn fill_with_zeros(&mut self) {
        self.values.fill([0.0; WIDTH]);
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.values.copy_from_slice(&other.values);
    }

    /// Number of blocks.
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

    /// Adds `factor` times a row of another matrix with as many columns to a row.
    pub(super) fn add_row(&mut self, row: usize, factor: f64, other: &Self, other_row: usize) {
        for block in 0..self.blocks() {
            add_product(&mut self.block_mut(block)[row], factor, &other.block(block)[other_row]);
        }
    }

    /// Writes the first rows to `to`, row after row, as many columns as there is room for in each.
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
