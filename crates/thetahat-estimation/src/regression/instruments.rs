use thetahat_ground::linear_algebra::{Matrix, PivotedQr};

/// The algebra of instrumental variables in an orthonormal basis Q of the instruments Z.
///
/// `theta = (Q^T X)^-1 Q^T y`, so that no condition number is squared; with `theta_hat - theta = A^T e` the influence is
/// `A = Q (Q^T X)^-T`. All arguments are whitened alike.
#[derive(Debug, Clone)]
pub struct InstrumentalVariables {
    /// Q, r x b.
    pub basis: Matrix,
    /// `Q^T X`, b x b.
    pub projected: Matrix,
    /// Factors of `Q^T X`.
    pub factors: PivotedQr,
}

impl InstrumentalVariables {
    /// Projects X on the basis. `factorise` factorises `Q^T X`: with unchanged columns, or with columns of equal norm.
    #[must_use]
    pub fn new(basis: Matrix, x: &Matrix, factorise: fn(&Matrix) -> PivotedQr) -> Self {
        let projected = basis.transposed_times(x);
        let factors = factorise(&projected);
        Self { basis, projected, factors }
    }

    /// The estimate from y.
    #[must_use]
    pub fn solve(&self, y: &[f64]) -> Vec<f64> {
        self.factors.solve(&self.basis.transpose_times(y))
    }

    /// `(Q^T X)^-1`.
    #[must_use]
    pub fn inverse(&self) -> Matrix {
        self.factors.solve_matrix(&Matrix::identity(self.projected.rows()))
    }

    /// `A = Q (Q^T X)^-T`.
    #[must_use]
    pub fn influence(&self) -> Matrix {
        self.basis.times_matrix(&self.inverse().transpose())
    }
}
