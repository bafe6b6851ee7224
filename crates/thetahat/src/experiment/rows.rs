//! Where the rows of several recordings stand in y, X and Z.

use crate::{
    linear_algebra::Matrix,
    statistics::{JointRows, RowBlocks},
};

/// The rows of y, X and Z: joint by joint, in each joint recording by recording, in each recording in time order.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rows {
    joints: usize,
    /// Rows per joint of each recording.
    of_recording: Vec<usize>,
}

impl Rows {
    pub(super) fn new(joints: usize, of_recording: Vec<usize>) -> Self {
        Self { joints, of_recording }
    }

    /// Rows of each joint.
    pub(super) fn per_joint(&self) -> usize {
        self.of_recording.iter().sum()
    }

    /// Which rows are one series in time.
    pub(crate) fn blocks(&self) -> RowBlocks {
        RowBlocks::new(self.joints, self.of_recording.clone())
    }

    /// The rows of each joint, one range for each recording.
    pub(super) fn joint_rows(&self) -> JointRows {
        JointRows::new(&self.blocks())
    }

    /// The recording, from zero, of each row of a joint.
    pub(super) fn recording_of_row(&self) -> Vec<usize> {
        self.of_recording.iter().enumerate().flat_map(|(r, &rows)| vec![r; rows]).collect()
    }

    /// One value for each recording, repeated for each of its rows.
    pub(super) fn spread(&self, of_recording: &[f64]) -> Vec<f64> {
        let of_joint: Vec<f64> = self.recording_of_row().into_iter().map(|r| of_recording[r]).collect();
        of_joint.repeat(self.joints)
    }

    /// The rows of all recordings from those of each.
    pub(super) fn stack_vectors(&self, mut parts: Vec<Vec<f64>>) -> Vec<f64> {
        if let [only] = &mut parts[..] {
            return std::mem::take(only);
        }
        let mut stacked = Vec::with_capacity(self.joints * self.per_joint());
        for joint in 0..self.joints {
            for (part, rows) in parts.iter().zip(&self.of_recording) {
                stacked.extend_from_slice(&part[joint * rows..][..*rows]);
            }
        }
        stacked
    }

    /// The same for matrices, column by column.
    pub(super) fn stack_matrices(&self, mut parts: Vec<Matrix>) -> Matrix {
        if parts.len() == 1 {
            return parts.remove(0);
        }
        let columns = parts.first().map_or(0, Matrix::columns);
        let mut stacked = Matrix::zeros(self.joints * self.per_joint(), columns);
        for c in 0..columns {
            let of_parts = parts.iter().map(|part| part.column(c).to_vec()).collect();
            stacked.column_mut(c).copy_from_slice(&self.stack_vectors(of_parts));
        }
        stacked
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_joint_by_joint_and_in_each_recording_by_recording() {
        let rows = Rows::new(2, vec![2, 1]);
        let stacked = rows.stack_vectors(vec![vec![1.0, 2.0, 3.0, 4.0], vec![10.0, 20.0]]);
        assert_eq!(stacked, [1.0, 2.0, 10.0, 3.0, 4.0, 20.0]);
        assert_eq!(rows.joint_rows().joints, [vec![0..2, 2..3], vec![3..5, 5..6]]);
        assert_eq!(rows.spread(&[0.5, 2.0]), [0.5, 0.5, 2.0, 0.5, 0.5, 2.0]);
        let first = Matrix::from_fn(4, 1, |i, _| (i + 1) as f64);
        let second = Matrix::from_fn(2, 1, |i, _| 10.0 * (i + 1) as f64);
        assert_eq!(rows.stack_matrices(vec![first, second]).column(0), stacked);
    }
}
