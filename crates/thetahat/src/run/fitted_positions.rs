//! Fits of recorded positions with other settings or another robot than described, to be compared.

use super::identification::Identification;
use crate::{
    diagnosis::{MethodEstimate, independent_rows},
    preparation::{Case, PreparationError},
};
use thetahat_estimation::{
    identification::{Method, Status},
    regression::RowLayout,
};
use thetahat_report::results::RunResult;

/// A fit of the positions that converged.
pub(super) struct FittedPositions {
    pub(super) run: RunResult,
    pub(super) residual: PositionResidual,
}

/// The residual of a fit of positions, joint by joint.
pub(super) struct PositionResidual {
    /// Sums of its squares.
    pub(super) squares: Vec<f64>,
    /// Independent samples in it.
    pub(super) effective: Vec<f64>,
}

impl PositionResidual {
    pub(super) fn new(layout: &RowLayout, residual: &[f64]) -> Self {
        let effective = layout.runs(residual).iter().map(|stretches| independent_rows(stretches)).collect();
        Self { squares: layout.squares(residual), effective }
    }

    /// The residual of an estimate; none if there is no fit.
    pub(super) fn of(estimate: &MethodEstimate) -> Option<Self> {
        let fit = estimate.outcome.fit.as_ref()?;
        let residual = estimate.regression.residual(&fit.prediction);
        Some(Self::new(&estimate.regression.layout, &residual))
    }

    /// Change of `sum_j n_j log(squares_j) + k log(n)` with k more parameters, where n are the independent samples of this residual.
    pub(super) fn criterion_change(&self, other: &Self, more_parameters: f64) -> f64 {
        let changes = self.effective.iter().zip(self.squares.iter().zip(&other.squares));
        let fit: f64 = changes.map(|(n, (before, after))| n * (after / before).ln()).sum();
        fit + more_parameters * self.effective.iter().sum::<f64>().ln()
    }
}

impl Identification {
    /// The positions fitted by CLOE; none if it does not converge.
    ///
    /// # Errors
    /// [`PreparationError`] where a recording cannot be filtered.
    pub(super) fn fitted_positions(
        &self,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Option<FittedPositions>, PreparationError> {
        let case = Case { methods: Some(vec![Method::CLOE]), ..Case::nominal() };
        let problems = self.problems(progress)?;
        let assessed = self.assess_all(&problems, std::slice::from_ref(&case), progress)?;
        let fitted = assessed.into_iter().flatten().find_map(|(run, estimate)| {
            let residual = PositionResidual::of(&estimate).filter(|_| run.status == Status::Converged)?;
            Some(FittedPositions { run, residual })
        });
        Ok(fitted)
    }
}
