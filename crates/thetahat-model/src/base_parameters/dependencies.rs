use thetahat_ground::linear_algebra::Matrix;

/// The columns of an observation matrix from left to right: the independent ones, and the others expressed by them.
#[derive(Debug)]
pub(super) struct Dependencies {
    /// Independent columns, rising.
    pub(super) kept: Vec<usize>,
    /// Columns spanned by earlier ones, rising. Columns without effect are in neither list.
    pub(super) spanned: Vec<usize>,
    /// `X_spanned = X_kept coefficients`.
    pub(super) coefficients: Matrix,
}
