//! The rows of a law, whitened by the deviations of its joints, in the parts that are left out in turn.

use super::{law::Law, law_factors::LawFactors, parts::FOLDS};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::consistency::LeastSquares;

/// Whitened rows of one law: triangular factors of each part, and of the rows that belong to none.
pub(super) struct Whitened {
    /// The factor of `[X y]` of each part; the last is that of the rows near borders.
    factors: Vec<Matrix>,
}

impl Whitened {
    pub(super) fn new(rows: &LawFactors, deviations: &[f64]) -> Self {
        let factor = |part: usize| {
            let own = rows.blocks.iter().filter(|block| block.part == part);
            let scaled: Vec<Matrix> = own
                .map(|block| {
                    let scale = block.weight / deviations[block.joint];
                    block.factor.scale_rows(&vec![scale; block.factor.rows()])
                })
                .collect();
            match scaled.is_empty() {
                true => Matrix::zeros(0, rows.parameters + 1),
                false => Matrix::stack(&scaled.iter().collect::<Vec<_>>()).triangular_factor(),
            }
        };
        Self { factors: (0..=FOLDS).map(factor).collect() }
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
}

fn least_squares(parts: &[&Matrix], law: &Law) -> Option<LeastSquares> {
    if parts.is_empty() {
        return None;
    }
    let factor = Matrix::stack(parts).triangular_factor();
    let columns = factor.columns() - 1;
    let r = factor.select_columns(&(0..columns).collect::<Vec<_>>());
    LeastSquares::in_base(&r, factor.column(columns).to_vec(), law.base, law.set.parameter_table().len()).ok()
}
