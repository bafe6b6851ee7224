//! The rows on which causes are tested: of long recordings every so many.

use std::borrow::Cow;

use crate::run::model::rows::ModelRows;
use thetahat_estimation::regression::RowLayout;

/// Rows of a joint up to which all of them are tested.
const MOST_ROWS: usize = 8000;
/// Rows of a joint that are left at least.
const ROWS: usize = 4000;

pub(super) struct TestedRows<'a> {
    pub(super) all: &'a ModelRows,
    pub(super) rows: Cow<'a, ModelRows>,
    /// One row of so many is tested.
    pub(super) step: usize,
    kept: Vec<bool>,
}

impl<'a> TestedRows<'a> {
    pub(super) fn new(all: &'a ModelRows) -> Self {
        let of_joint = all.rows_of_joint();
        let step = if of_joint > MOST_ROWS { of_joint / ROWS } else { 1 };
        let kept: Vec<bool> =
            all.layout.blocks().iter().flat_map(|block| (0..block.rows.len()).map(|k| k % step == 0)).collect();
        let rows = if step == 1 { Cow::Borrowed(all) } else { Cow::Owned(every(all, step, &kept)) };
        Self { all, rows, step, kept }
    }

    /// The tested ones of values of all rows.
    pub(super) fn select<T: Copy>(&self, values: Vec<T>) -> Vec<T> {
        if self.step == 1 { values } else { selected(&values, &self.kept) }
    }
}

fn every(all: &ModelRows, step: usize, kept: &[bool]) -> ModelRows {
    let recordings = 0..all.layout.recordings();
    let rows: Vec<usize> = recordings.map(|r| all.layout.block(0, r).len().div_ceil(step)).collect();
    ModelRows {
        x: all.x.select_rows(kept),
        y: selected(&all.y, kept),
        layout: RowLayout::new(all.layout.joints(), &rows),
        decimators: all.decimators.clone(),
        weights: selected(&all.weights, kept),
    }
}

fn selected<T: Copy>(values: &[T], kept: &[bool]) -> Vec<T> {
    values.iter().zip(kept).filter(|(_, kept)| **kept).map(|(value, _)| *value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_ground::linear_algebra::Matrix;

    fn rows(of_recordings: &[usize]) -> ModelRows {
        let layout = RowLayout::new(2, of_recordings);
        let count = layout.len();
        let y: Vec<f64> = (0..count).map(|k| k as f64).collect();
        let x = Matrix::from_columns(count, y.clone());
        ModelRows { x, weights: y.clone(), y, layout, decimators: Vec::new() }
    }

    #[test]
    fn a_short_recording_is_tested_in_all_rows() {
        let all = rows(&[3000, 4000]);
        let tested = TestedRows::new(&all);
        assert_eq!((tested.step, tested.rows.y.len()), (1, all.y.len()));
    }

    /// 9001 and 11 000 rows of two joints: every fifth of each recording and joint.
    #[test]
    fn a_long_recording_is_tested_in_rows_of_each_joint_and_recording() {
        let all = rows(&[9001, 11_000]);
        let tested = TestedRows::new(&all);
        assert_eq!((tested.step, tested.rows.rows_of_joint()), (5, 1801 + 2200));
        let second = tested.rows.layout.block(1, 1);
        assert_eq!(tested.rows.y[second.start..second.start + 2], [29_002.0, 29_007.0]);
        assert_eq!(tested.rows.y, tested.select(all.y.clone()));
        assert_eq!(tested.rows.x.column(0), tested.rows.y);
    }
}
