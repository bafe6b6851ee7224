use std::{borrow::Cow, ops::Range};

use thetahat_ground::linear_algebra::Matrix;

/// Rows that follow one another in time: one joint's rows in one recording, or in one stretch of the recording.
///
/// Correlation in time never crosses the ends of a block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowBlock {
    /// The joint, from zero.
    pub joint: usize,
    /// The recording, from zero.
    pub recording: usize,
    /// The stretch of time, from zero, counted over all recordings; blocks of different joints with the same number are simultaneous.
    pub stretch: usize,
    /// Its rows in y, X and Z.
    pub rows: Range<usize>,
}

/// The joint, recording and stretch of time of a block.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlockKey {
    /// The joint, from zero.
    pub joint: usize,
    /// The recording, from zero.
    pub recording: usize,
    /// The stretch of time, as in [`RowBlock::stretch`].
    pub stretch: usize,
}

/// The positions of the rows of each joint, recording and stretch of time in y, X and Z.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RowLayout {
    joints: usize,
    recordings: usize,
    blocks: Vec<RowBlock>,
    /// The part of each row that a mask leaves; `None` without a mask.
    shares: Option<Vec<f64>>,
}

impl RowLayout {
    /// The layout of an identification: joint by joint, for each joint recording by recording, with a given number of rows per
    /// joint in each recording. A recording is one stretch of time.
    #[must_use]
    pub fn new(joints: usize, rows_of_recordings: &[usize]) -> Self {
        let mut layout = Self { joints, recordings: rows_of_recordings.len(), blocks: Vec::new(), shares: None };
        for joint in 0..joints {
            for (recording, &rows) in rows_of_recordings.iter().enumerate() {
                layout.push(BlockKey { joint, recording, stretch: recording }, rows);
            }
        }
        layout
    }

    /// A layout without rows, to which blocks are added.
    #[must_use]
    pub fn empty(joints: usize, recordings: usize) -> Self {
        Self { joints, recordings, blocks: Vec::new(), shares: None }
    }

    /// The same with the part of each row that a mask leaves, which multiplies its error and columns. `None` for rows without a
    /// mask.
    #[must_use]
    pub fn with_shares(self, shares: Option<Vec<f64>>) -> Self {
        Self { shares, ..self }
    }

    /// The part of each row of a range that a mask leaves; `None` without a mask.
    #[must_use]
    pub fn shares(&self, rows: Range<usize>) -> Option<&[f64]> {
        self.shares.as_ref().map(|shares| &shares[rows])
    }

    /// The same, or ones without a mask.
    #[doc(hidden)]
    #[must_use]
    pub fn shares_or_ones(&self, rows: Range<usize>) -> Cow<'_, [f64]> {
        self.shares(rows.clone()).map_or_else(|| vec![1.0; rows.len()].into(), Cow::Borrowed)
    }

    /// Whether there is a mask.
    #[must_use]
    pub fn is_masked(&self) -> bool {
        self.shares.is_some()
    }

    /// The number of rows, each weighted by the square of the part that a mask leaves.
    #[must_use]
    pub fn counted(&self, rows: Range<usize>) -> f64 {
        self.shares(rows.clone()).map_or(rows.len() as f64, |shares| shares.iter().map(|s| s * s).sum())
    }

    /// The same for each joint.
    #[must_use]
    pub fn counted_by_joint(&self) -> Vec<f64> {
        (0..self.joints).map(|joint| self.of_joint(joint).map(|rows| self.counted(rows)).sum()).collect()
    }

    /// Appends a block of `rows` rows.
    pub fn push(&mut self, key: BlockKey, rows: usize) {
        let BlockKey { joint, recording, stretch } = key;
        let start = self.len();
        self.blocks.push(RowBlock { joint, recording, stretch, rows: start..start + rows });
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.blocks.last().map_or(0, |last| last.rows.end)
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Number of recordings.
    #[must_use]
    pub fn recordings(&self) -> usize {
        self.recordings
    }

    /// Every block, in the order of the rows.
    #[must_use]
    pub fn blocks(&self) -> &[RowBlock] {
        &self.blocks
    }

    /// The rows of a joint, block by block.
    pub fn of_joint(&self, joint: usize) -> impl Iterator<Item = Range<usize>> + '_ {
        self.blocks.iter().filter(move |b| b.joint == joint).map(|b| b.rows.clone())
    }

    /// The indices of the rows of a joint.
    pub fn rows_of_joint(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        self.of_joint(joint).flatten()
    }

    /// Whether a mask leaves at least half of a row.
    fn is_used(&self, row: usize) -> bool {
        self.shares.as_ref().is_none_or(|shares| shares[row] >= 0.5)
    }

    /// The indices of a joint's rows of which a mask leaves at least half.
    pub fn used_rows_of_joint(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        self.rows_of_joint(joint).filter(|row| self.is_used(*row))
    }

    /// The rows of a joint in a recording; empty if it has none.
    #[must_use]
    pub fn block(&self, joint: usize, recording: usize) -> Range<usize> {
        let found = self.blocks.iter().find(|b| b.joint == joint && b.recording == recording);
        found.map_or(0..0, |b| b.rows.clone())
    }

    /// The values of each joint in runs of consecutive rows: its blocks, split at rows of which a mask leaves less than half.
    #[must_use]
    pub fn runs<'a>(&self, rows: &'a [f64]) -> Vec<Vec<&'a [f64]>> {
        let used = |row: &usize| self.is_used(*row);
        let of_block = |block: Range<usize>| {
            let ends: Vec<usize> = block.clone().filter(|row| !used(row)).chain([block.end]).collect();
            let starts = std::iter::once(block.start).chain(ends.clone().into_iter().map(|end| end + 1));
            let runs = starts.zip(ends).filter(|(start, end)| start < end);
            runs.map(|(start, end)| &rows[start..end]).collect::<Vec<_>>()
        };
        (0..self.joints).map(|joint| self.of_joint(joint).flat_map(of_block).collect()).collect()
    }

    /// The values of each joint, block by block.
    #[must_use]
    pub fn split<'a>(&self, rows: &'a [f64]) -> Vec<Vec<&'a [f64]>> {
        (0..self.joints).map(|joint| self.of_joint(joint).map(|r| &rows[r]).collect()).collect()
    }

    /// The values of each joint, its blocks concatenated.
    #[must_use]
    pub fn by_joint(&self, rows: &[f64]) -> Vec<Vec<f64>> {
        self.split(rows).iter().map(|blocks| blocks.concat()).collect()
    }

    /// The sum of the squares of each joint's values.
    #[must_use]
    pub fn squares(&self, rows: &[f64]) -> Vec<f64> {
        let squares = |block: &&[f64]| block.iter().map(|v| v * v).sum::<f64>();
        self.split(rows).iter().map(|blocks| blocks.iter().map(squares).sum()).collect()
    }

    /// One value for each row, computed from its block.
    #[must_use]
    pub fn spread<T: Copy>(&self, of_block: impl Fn(&RowBlock) -> T) -> Vec<T> {
        self.blocks.iter().flat_map(|b| std::iter::repeat_n(of_block(b), b.rows.len())).collect()
    }

    /// Stacks the rows of the recordings, each given joint by joint, into the rows of all.
    #[must_use]
    pub fn stack_vectors(&self, mut of_recordings: Vec<Vec<f64>>) -> Vec<f64> {
        if let [only] = &mut of_recordings[..] {
            return std::mem::take(only);
        }
        let mut stacked = Vec::with_capacity(self.len());
        for block in &self.blocks {
            let rows = block.rows.len();
            stacked.extend_from_slice(&of_recordings[block.recording][block.joint * rows..][..rows]);
        }
        stacked
    }

    /// The same for matrices, column by column.
    #[must_use]
    pub fn stack_matrices(&self, mut of_recordings: Vec<Matrix>) -> Matrix {
        if of_recordings.len() == 1 {
            return of_recordings.remove(0);
        }
        let columns = of_recordings.first().map_or(0, Matrix::columns);
        let mut stacked = Matrix::zeros(self.len(), columns);
        for c in 0..columns {
            let column = of_recordings.iter().map(|matrix| matrix.column(c).to_vec()).collect();
            stacked.column_mut(c).copy_from_slice(&self.stack_vectors(column));
        }
        stacked
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_follow_one_another_joint_by_joint() {
        let layout = RowLayout::new(2, &[3, 2]);
        let rows: Vec<Range<usize>> = layout.blocks().iter().map(|b| b.rows.clone()).collect();
        assert_eq!(rows, [0..3, 3..5, 5..8, 8..10]);
        assert_eq!((layout.len(), layout.block(1, 1)), (10, 8..10));
    }

    #[test]
    fn recordings_are_stacked_joint_by_joint() {
        let layout = RowLayout::new(2, &[2, 1]);
        let stacked = layout.stack_vectors(vec![vec![1.0, 2.0, 3.0, 4.0], vec![10.0, 20.0]]);
        assert_eq!(stacked, [1.0, 2.0, 10.0, 3.0, 4.0, 20.0]);
        assert_eq!(layout.by_joint(&stacked), [vec![1.0, 2.0, 10.0], vec![3.0, 4.0, 20.0]]);
        assert_eq!(layout.spread(|b| b.recording), [0, 0, 1, 0, 0, 1]);
        let first = Matrix::from_fn(4, 1, |i, _| (i + 1) as f64);
        let second = Matrix::from_fn(2, 1, |i, _| 10.0 * (i + 1) as f64);
        assert_eq!(layout.stack_matrices(vec![first, second]).column(0), stacked);
    }

    #[test]
    fn blocks_may_be_ordered_by_stretch() {
        let mut layout = RowLayout::empty(2, 1);
        for (joint, stretch) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            layout.push(BlockKey { joint, recording: 0, stretch }, 2);
        }
        assert_eq!(layout.rows_of_joint(1).collect::<Vec<_>>(), [2, 3, 6, 7]);
        assert_eq!(layout.spread(|b| b.stretch), [0, 0, 0, 0, 1, 1, 1, 1]);
    }
}
