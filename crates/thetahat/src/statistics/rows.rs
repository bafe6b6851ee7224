use std::ops::Range;

/// Where the rows of each joint and recording stand: joint by joint, in each joint recording by recording, in each
/// recording in time order.
///
/// A block is what one joint gives in one recording: a time series of its own, across whose ends no correlation is taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowBlocks {
    joints: usize,
    of_recording: Vec<usize>,
}

impl RowBlocks {
    /// The layout of `joints` joints with so many rows per joint in each recording.
    #[must_use]
    pub fn new(joints: usize, of_recording: Vec<usize>) -> Self {
        Self { joints, of_recording }
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.joints * self.per_joint()
    }

    /// Whether there is none.
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
        self.of_recording.len()
    }

    /// The rows of a joint in a recording, both counted from zero.
    #[must_use]
    pub fn block(&self, joint: usize, recording: usize) -> Range<usize> {
        let start = joint * self.per_joint() + self.of_recording[..recording].iter().sum::<usize>();
        start..start + self.of_recording[recording]
    }

    /// Every block, joint by joint.
    pub fn blocks(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        (0..self.joints).flat_map(move |j| (0..self.recordings()).map(move |r| self.block(j, r)))
    }

    fn per_joint(&self) -> usize {
        self.of_recording.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_follow_one_another_joint_by_joint() {
        let rows = RowBlocks::new(2, vec![3, 2]);
        assert_eq!(rows.blocks().collect::<Vec<_>>(), [0..3, 3..5, 5..8, 8..10]);
        assert_eq!((rows.len(), rows.block(1, 1)), (10, 8..10));
    }
}
