//! The rows of a law, whitened by the deviations of its joints, in the parts that are left out in turn.

use super::{
    folds::{FOLDS, ModelFolds},
    law::Law,
    rows::ModelRows,
};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::consistency::LeastSquares;

/// Whitened rows of one law: triangular factors of each part, and of the rows that belong to none.
pub(super) struct Whitened {
    pub(super) x: Matrix,
    pub(super) y: Vec<f64>,
    /// Deviation by which each row is divided, over the one in which errors are compared.
    pub(super) part: Vec<f64>,
    /// The factor of `[X y]` of each part; the last is that of the rows near borders.
    factors: Vec<Matrix>,
    /// The part of each row.
    of_row: Vec<usize>,
}

impl Whitened {
    pub(super) fn new(rows: &ModelRows, folds: &ModelFolds, compared: &[f64], deviations: &[f64]) -> Self {
        let part = rows.layout.spread(|block| deviations[block.joint] / compared[block.joint]);
        let scale: Vec<f64> = rows.layout.spread(|block| 1.0 / deviations[block.joint]);
        let scale: Vec<f64> = scale.iter().zip(&rows.weights).map(|(s, w)| s * w).collect();
        let x = rows.x.scale_rows(&scale);
        let y: Vec<f64> = rows.y.iter().zip(&scale).map(|(y, s)| y * s).collect();
        let per_joint = folds.of_row.len();
        let of_row: Vec<usize> = (0..y.len()).map(|k| folds.of_row[k % per_joint].unwrap_or(FOLDS)).collect();
        let right = Matrix::from_fn(y.len(), 1, |k, _| y[k]);
        let both = Matrix::side_by_side(&[&x, &right]);
        let factor = |part: usize| {
            let keep: Vec<bool> = of_row.iter().map(|p| *p == part).collect();
            both.select_rows(&keep).triangular_factor()
        };
        Self { factors: (0..=FOLDS).map(factor).collect(), x, y, part, of_row }
    }

    /// The least squares of all rows.
    pub(super) fn all(&self, law: &Law) -> Option<LeastSquares> {
        let parts: Vec<&Matrix> = self.factors.iter().filter(|f| f.rows() > 0).collect();
        least_squares(&parts, law)
    }

    /// Those without some parts, and without the rows near borders.
    pub(super) fn without(&self, out: &[usize], law: &Law) -> Option<LeastSquares> {
        let kept = (0..FOLDS).filter(|part| !out.contains(part)).map(|part| &self.factors[part]);
        least_squares(&kept.filter(|f| f.rows() > 0).collect::<Vec<_>>(), law)
    }

    pub(super) fn rows_of(&self, part: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.y.len()).filter(move |k| self.of_row[*k] == part)
    }
}

fn least_squares(parts: &[&Matrix], law: &Law) -> Option<LeastSquares> {
    let factor = Matrix::stack(parts).triangular_factor();
    let columns = factor.columns() - 1;
    let r = factor.select_columns(&(0..columns).collect::<Vec<_>>());
    LeastSquares::in_base(&r, factor.column(columns).to_vec(), law.base, law.set.parameter_table().len()).ok()
}
