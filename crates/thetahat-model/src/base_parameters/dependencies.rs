use thetahat_ground::linear_algebra::Matrix;

/// The columns of an observation matrix from left to right: those that are independent, and what the others are of them.
#[derive(Debug)]
pub(super) struct Dependencies {
    /// Independent columns, rising.
    pub(super) kept: Vec<usize>,
    /// Columns that those before them span, rising. Columns that act on nothing are neither here nor there.
    pub(super) spanned: Vec<usize>,
    /// `X_spanned = X_kept coefficients`.
    pub(super) coefficients: Matrix,
}
