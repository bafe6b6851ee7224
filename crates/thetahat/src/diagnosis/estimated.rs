use std::borrow::Cow;

use thetahat_estimation::{
    identification::{Method, Outcome, Status},
    regression::{Regression, RowLayout},
};
use thetahat_ground::linear_algebra::Matrix;

/// A run of a case with what its diagnosis needs.
pub(crate) struct MethodEstimate {
    pub(crate) method: Method,
    /// Its rows, with their weights.
    pub(crate) regression: Regression,
    pub(crate) outcome: Outcome,
}

/// The converged run of a method.
pub(super) fn converged(runs: &[MethodEstimate], method: Method) -> Option<&MethodEstimate> {
    runs.iter().find(|e| e.method == method && e.outcome.status == Status::Converged)
}

/// X, y and Z of a run, whitened alike.
pub(super) struct Whitened<'a> {
    pub(super) x: Cow<'a, Matrix>,
    pub(super) y: Cow<'a, [f64]>,
    pub(super) z: Cow<'a, Matrix>,
    pub(super) layout: &'a RowLayout,
}

impl<'a> Whitened<'a> {
    pub(super) fn new(run: &'a MethodEstimate) -> Option<Self> {
        let (regression, z) = (&run.regression, run.outcome.instruments.as_ref()?);
        Some(Self {
            x: regression.whiten_matrix(&regression.x),
            y: regression.whiten(&regression.y),
            z: regression.whiten_matrix(z),
            layout: &regression.layout,
        })
    }
}
