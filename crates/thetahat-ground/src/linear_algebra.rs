//! Dense linear algebra: the only module that uses the library faer.
//!
//! Least squares are solved by QR with column pivoting, never by normal equations.
//!
//! ```
//! use thetahat_ground::linear_algebra::{Matrix, PivotedQr};
//! // The line 1 + 2 t through four points.
//! let x = Matrix::from_fn(4, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
//! let qr = PivotedQr::new(&x);
//! let theta = qr.solve(&[1.0, 3.0, 5.0, 7.0]);
//! assert!((theta[0] - 1.0).abs() < 1e-12 && (theta[1] - 2.0).abs() < 1e-12);
//! assert_eq!(qr.rank(1e-9), 2);
//! ```

use faer::{
    Conj, Mat, MatMut, MatRef, Par, Side,
    dyn_stack::{MemBuffer, MemStack},
    linalg::{
        householder::{
            apply_block_householder_sequence_on_the_left_in_place_scratch as scratch_of_q,
            apply_block_householder_sequence_on_the_left_in_place_with_conj as apply_q,
            apply_block_householder_sequence_transpose_on_the_left_in_place_scratch as scratch_of_q_transposed,
            apply_block_householder_sequence_transpose_on_the_left_in_place_with_conj as apply_q_transposed,
        },
        solvers::{ColPivQr, Llt, Qr},
    },
    prelude::*,
};

/// A dense matrix, stored column by column.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// A matrix of zeros.
    #[must_use]
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, values: vec![0.0; rows * columns] }
    }

    /// The identity.
    #[must_use]
    pub fn identity(size: usize) -> Self {
        Self::from_fn(size, size, |i, j| if i == j { 1.0 } else { 0.0 })
    }

    /// A matrix from a function of row and column.
    #[must_use]
    #[inline]
    pub fn from_fn(rows: usize, columns: usize, f: impl Fn(usize, usize) -> f64) -> Self {
        let mut values = Vec::with_capacity(rows * columns);
        (0..columns).for_each(|j| values.extend((0..rows).map(|i| f(i, j))));
        Self { rows, columns, values }
    }

    /// A symmetric matrix from the rows of its lower half; `None` of another number of values.
    #[must_use]
    pub fn from_lower_half(size: usize, values: &[f64]) -> Option<Self> {
        let at = |i: usize, j: usize| values[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        (values.len() == size * (size + 1) / 2).then(|| Self::from_fn(size, size, at))
    }

    /// A matrix from its values, column by column.
    ///
    /// # Panics
    /// If `rows` is zero or does not divide the number of values.
    #[must_use]
    pub fn from_columns(rows: usize, values: Vec<f64>) -> Self {
        assert!(rows > 0 && values.len().is_multiple_of(rows), "{} values in {rows} rows", values.len());
        Self { rows, columns: values.len() / rows, values }
    }

    /// Number of rows.
    #[must_use]
    #[inline]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    #[inline]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The entry at row `i`, column `j`.
    #[must_use]
    #[inline]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.values[j * self.rows + i]
    }

    /// All values, column by column; consumes the matrix.
    #[must_use]
    #[inline]
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// The entry at row `i`, column `j`, to write.
    #[inline]
    pub fn at_mut(&mut self, i: usize, j: usize) -> &mut f64 {
        &mut self.values[j * self.rows + i]
    }

    /// Column `j`.
    #[must_use]
    #[inline]
    pub fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.rows..(j + 1) * self.rows]
    }

    /// Column `j`, to write.
    #[inline]
    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * self.rows..(j + 1) * self.rows]
    }

    /// A copy of the columns named by `indices`, in that order.
    #[must_use]
    pub fn select_columns(&self, indices: &[usize]) -> Self {
        let mut values = Vec::with_capacity(self.rows * indices.len());
        indices.iter().for_each(|&j| values.extend_from_slice(self.column(j)));
        Self { rows: self.rows, columns: indices.len(), values }
    }

    /// A copy of the rows for which `keep` holds.
    #[must_use]
    pub fn select_rows(&self, keep: &[bool]) -> Self {
        let rows = keep.iter().filter(|&&k| k).count();
        let mut values = Vec::with_capacity(rows * self.columns);
        let kept = |j| self.column(j).iter().zip(keep).filter(|(_, k)| **k).map(|(v, _)| *v);
        (0..self.columns).for_each(|j| values.extend(kept(j)));
        Self { rows, columns: self.columns, values }
    }

    /// The matrix with each row multiplied by its weight.
    #[must_use]
    pub fn scale_rows(&self, weights: &[f64]) -> Self {
        let mut values = Vec::with_capacity(self.values.len());
        (0..self.columns).for_each(|j| values.extend(self.column(j).iter().zip(weights).map(|(v, w)| w * v)));
        Self { values, ..*self }
    }

    /// The matrix with each column multiplied by its factor.
    #[must_use]
    pub fn scale_columns(&self, factors: &[f64]) -> Self {
        let mut values = Vec::with_capacity(self.values.len());
        factors.iter().enumerate().for_each(|(j, factor)| values.extend(self.column(j).iter().map(|v| factor * v)));
        Self { values, ..*self }
    }

    /// `A x`.
    #[must_use]
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        from_faer((self.view() * MatRef::from_column_major_slice(x, self.columns, 1)).as_ref()).values
    }

    /// `A^T x`.
    #[must_use]
    pub fn transpose_times(&self, x: &[f64]) -> Vec<f64> {
        from_faer((self.view().transpose() * MatRef::from_column_major_slice(x, self.rows, 1)).as_ref()).values
    }

    /// `A + factor B`.
    #[must_use]
    pub fn plus(&self, other: &Self, factor: f64) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| a + factor * b).collect();
        Self { values, ..*self }
    }

    /// A copy of a range of rows.
    #[must_use]
    pub fn row_range(&self, range: std::ops::Range<usize>) -> Self {
        let mut values = Vec::with_capacity(range.len() * self.columns);
        (0..self.columns).for_each(|j| values.extend_from_slice(&self.column(j)[range.clone()]));
        Self { rows: range.len(), columns: self.columns, values }
    }

    /// `A^-1 x` of a symmetric matrix; `None` where it is not positive definite.
    #[must_use]
    pub fn inverse_times(&self, x: &[f64]) -> Option<Vec<f64>> {
        let factor = self.view().llt(faer::Side::Lower).ok()?;
        let rhs = MatRef::from_column_major_slice(x, self.rows, 1);
        Some(from_faer(factor.solve(rhs).as_ref()).values)
    }

    /// `A^-1 B` of a symmetric matrix; `None` where it is not positive definite.
    #[must_use]
    pub fn inverse_times_matrix(&self, b: &Self) -> Option<Self> {
        let factor = self.view().llt(faer::Side::Lower).ok()?;
        Some(from_faer(factor.solve(b.view()).as_ref()))
    }

    /// The Cholesky factor of a symmetric matrix, of which the lower half is read; `None` where it is not positive definite.
    #[must_use]
    pub fn cholesky(&self) -> Option<CholeskyFactor> {
        self.view().llt(Side::Lower).ok().map(|factor| CholeskyFactor { factor })
    }

    /// `x^T A^-1 x` of a symmetric matrix; `None` where it is not positive definite.
    #[must_use]
    pub fn inverse_quadratic_form(&self, x: &[f64]) -> Option<f64> {
        let solved = self.inverse_times(x)?;
        Some(solved.iter().zip(x).map(|(s, x)| s * x).sum())
    }

    /// `A B`.
    #[must_use]
    pub fn times_matrix(&self, other: &Self) -> Self {
        from_faer((self.view() * other.view()).as_ref())
    }

    /// `A^T B`.
    #[must_use]
    pub fn transposed_times(&self, other: &Self) -> Self {
        from_faer((self.view().transpose() * other.view()).as_ref())
    }

    /// `A B^T`.
    #[must_use]
    pub fn times_transposed(&self, other: &Self) -> Self {
        from_faer((self.view() * other.view().transpose()).as_ref())
    }

    /// `A^T`.
    #[must_use]
    pub fn transpose(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self.at(j, i))
    }

    /// The inverse of a square matrix, or `None` where it is singular to working precision.
    #[must_use]
    pub fn inverse(&self) -> Option<Self> {
        let qr = PivotedQr::new(self);
        (qr.rank(SINGULAR) == self.columns).then(|| qr.solve_matrix(&Self::identity(self.rows)))
    }

    /// Stacks matrices with the same number of columns vertically.
    #[must_use]
    pub fn stack(parts: &[&Self]) -> Self {
        let columns = parts.first().map_or(0, |part| part.columns);
        let values = (0..columns).flat_map(|j| parts.iter().flat_map(move |part| part.column(j))).copied().collect();
        Self { rows: parts.iter().map(|part| part.rows).sum(), columns, values }
    }

    /// Joins matrices with the same number of rows horizontally.
    #[must_use]
    pub fn side_by_side(parts: &[&Self]) -> Self {
        let values = parts.iter().map(|part| part.values.as_slice()).collect::<Vec<_>>().concat();
        let columns = parts.iter().map(|part| part.columns).sum();
        Self { rows: parts.first().map_or(0, |part| part.rows), columns, values }
    }

    /// R of `A = Q R`, without pivoting, with a diagonal that is not negative: as many rows as A has, but no more than
    /// columns.
    ///
    /// Orthonormal transformations of the rows of A leave R unchanged, so that R replaces A in any least-squares problem
    /// in its columns.
    #[must_use]
    pub fn triangular_factor(&self) -> Self {
        let mut r = from_faer(self.view().qr().thin_R());
        for i in 0..r.rows {
            if r.at(i, i) < 0.0 {
                (i..r.columns).for_each(|j| *r.at_mut(i, j) = -r.at(i, j));
            }
        }
        r
    }

    /// Eigenvalues, rising, and eigenvectors, column by column, of a symmetric matrix; `None` where an entry is not finite.
    #[must_use]
    pub fn symmetric_eigen(&self) -> Option<(Vec<f64>, Self)> {
        if !self.values.iter().all(|v| v.is_finite()) {
            return None;
        }
        let eigen = self.view().self_adjoint_eigen(Side::Lower).ok()?;
        let values = eigen.S().column_vector();
        Some(((0..self.rows).map(|i| values[i]).collect(), from_faer(eigen.U())))
    }

    /// Singular values, largest first; `None` where an entry is not finite.
    #[must_use]
    pub fn singular_values(&self) -> Option<Vec<f64>> {
        if !self.values.iter().all(|v| v.is_finite()) {
            return None;
        }
        self.view().singular_values().ok()
    }

    /// The ratio of the largest to the smallest singular value; infinite for a singular matrix.
    #[must_use]
    pub fn condition_number(&self) -> f64 {
        match self.singular_values().as_deref() {
            Some([largest, .., smallest]) if *smallest > 0.0 => largest / smallest,
            Some([_]) => 1.0,
            _ => f64::INFINITY,
        }
    }

    fn view(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.values, self.rows, self.columns)
    }
}

/// L of `A = L L^T`, to solve with more than once.
#[derive(Debug, Clone)]
pub struct CholeskyFactor {
    factor: Llt<f64>,
}

impl CholeskyFactor {
    /// `A^-1 b`.
    #[must_use]
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let right = MatRef::from_column_major_slice(b, b.len(), 1);
        from_faer(self.factor.solve(right).as_ref()).values
    }

    /// `A^-1 B`.
    #[must_use]
    pub fn solve_matrix(&self, b: &Matrix) -> Matrix {
        from_faer(self.factor.solve(b.view()).as_ref())
    }

    /// The lower triangular L.
    #[must_use]
    pub fn lower(&self) -> Matrix {
        from_faer(self.factor.L())
    }
}

/// Relative size of a diagonal entry of R below which a square matrix counts as singular.
const SINGULAR: f64 = 1e-13;

/// Norm of a column, relative to the largest, below which the column counts as rounding error.
const ROUNDING: f64 = 1e-14;

fn from_faer(a: MatRef<'_, f64>) -> Matrix {
    let mut values = Vec::with_capacity(a.nrows() * a.ncols());
    a.col_iter().for_each(|column| values.extend(column.iter()));
    Matrix { rows: a.nrows(), columns: a.ncols(), values }
}

/// `A P = Q R` with column pivoting, for a matrix with at least as many rows as columns.
///
/// In two steps, `A = Q_1 R_1` without pivoting and `R_1 P = Q_2 R`: columns of `A` and `R_1` have the same norms and
/// angles, so that both have the same pivots, and the first step, which has all the rows, can work on blocks of
/// columns.
///
/// The factorisation may be of a matrix with scaled columns, `A D P = Q R_D`; solutions and factors are returned for `A`.
#[derive(Debug, Clone)]
pub struct PivotedQr {
    first: Qr<f64>,
    pivoted: ColPivQr<f64>,
    rows: usize,
    columns: usize,
    /// D, by which each column of `A` was multiplied.
    scale: Vec<f64>,
}

impl PivotedQr {
    /// Factorises `a` unchanged.
    #[must_use]
    pub fn new(a: &Matrix) -> Self {
        let first = a.view().qr();
        let pivoted = first.thin_R().col_piv_qr();
        Self { first, pivoted, rows: a.rows, columns: a.columns, scale: vec![1.0; a.columns] }
    }

    /// Factorises `a` with its columns scaled to norms between 1 and 2.
    /// Pivots and rank then do not depend on the units of the columns, and a matrix whose columns differ by orders of
    /// magnitude keeps its digits. The factors are powers of two, so that scaling itself rounds nothing. A column at the rounding level of
    /// the largest is scaled by the largest column's factor, so that it stays at that level.
    #[must_use]
    pub fn with_equal_columns(a: &Matrix) -> Self {
        let sizes: Vec<f64> = (0..a.columns).map(|j| norm(a.column(j))).collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let of_size = |size: &f64| to_unit_magnitude(if *size < ROUNDING * largest { largest } else { *size });
        let scale: Vec<f64> = sizes.iter().map(of_size).collect();
        Self { scale: scale.clone(), ..Self::new(&a.scale_columns(&scale)) }
    }

    /// Number of diagonal entries of R above `tolerance` times the largest.
    ///
    /// Entries that are not finite do not count, so the rank of a matrix with a NaN is not full.
    #[must_use]
    pub fn rank(&self, tolerance: f64) -> usize {
        let r = self.pivoted.thin_R();
        let diagonal = (0..self.columns.min(self.rows)).map(|i| r[(i, i)].abs());
        let largest = diagonal.clone().fold(0.0, f64::max);
        diagonal.filter(|d| *d > tolerance * largest).count()
    }

    /// The least-squares solution of `A x = y`.
    #[must_use]
    pub fn solve(&self, y: &[f64]) -> Vec<f64> {
        self.solve_view(MatRef::from_column_major_slice(y, self.rows, 1)).values
    }

    /// The least-squares solution of `A X = B`.
    #[must_use]
    pub fn solve_matrix(&self, b: &Matrix) -> Matrix {
        self.solve_view(b.view())
    }

    fn solve_view(&self, b: MatRef<'_, f64>) -> Matrix {
        let mut rotated = b.to_owned();
        self.rotate(rotated.as_mut());
        let solution = self.pivoted.solve_lstsq(rotated.get(..self.columns, ..));
        from_faer(solution.as_ref()).scale_rows(&self.scale)
    }

    /// `Q_1^T B`, in place.
    fn rotate(&self, b: MatMut<'_, f64>) {
        let (basis, factor) = (self.first.Q_basis(), self.first.Q_coeff());
        let scratch = scratch_of_q_transposed::<f64>(self.rows, factor.nrows(), b.ncols());
        apply_q_transposed(basis, factor, Conj::No, b, Par::Seq, MemStack::new(&mut MemBuffer::new(scratch)));
    }

    /// The columns in pivoted order: those that the first ones span come last.
    #[must_use]
    pub fn pivots(&self) -> &[usize] {
        self.pivoted.P().arrays().0
    }

    /// The orthonormal factor, rows by columns.
    #[must_use]
    pub fn thin_q(&self) -> Matrix {
        let inner = self.pivoted.compute_thin_Q();
        let mut q = Mat::zeros(self.rows, inner.ncols());
        q.get_mut(..inner.nrows(), ..).copy_from(&inner);
        let (basis, factor) = (self.first.Q_basis(), self.first.Q_coeff());
        let scratch = scratch_of_q::<f64>(self.rows, factor.nrows(), q.ncols());
        apply_q(basis, factor, Conj::No, q.as_mut(), Par::Seq, MemStack::new(&mut MemBuffer::new(scratch)));
        from_faer(q.as_ref())
    }

    /// The triangular factor in pivoted column order, columns by columns.
    #[must_use]
    pub fn thin_r(&self) -> Matrix {
        let unscaled: Vec<f64> = self.pivots().iter().map(|&p| 1.0 / self.scale[p]).collect();
        from_faer(self.pivoted.thin_R()).scale_columns(&unscaled)
    }

    /// `(A^T A)^-1` from the triangular factor, without forming the product `A^T A`.
    #[must_use]
    pub fn inverse_gram(&self) -> Matrix {
        let r = from_faer(self.pivoted.thin_R());
        let mut inverse = Matrix::identity(self.columns).view().to_owned();
        r.view().solve_upper_triangular_in_place(inverse.as_mut());
        let gram = &inverse * inverse.transpose();
        let forward = self.pivots();
        let mut out = Matrix::zeros(self.columns, self.columns);
        for (i, &pi) in forward.iter().enumerate() {
            for (j, &pj) in forward.iter().enumerate() {
                *out.at_mut(pi, pj) = self.scale[pi] * self.scale[pj] * gram[(i, j)];
            }
        }
        out
    }
}

/// The power of two that brings a size to between 1 and 2; 1 for zero and for sizes that are not finite.
fn to_unit_magnitude(size: f64) -> f64 {
    let factor = (-size.log2().floor()).exp2();
    if factor.is_normal() { factor } else { 1.0 }
}

/// The scalar product, in four interleaved sums.
///
/// Surplus entries of the longer vector are ignored.
#[must_use]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (a, rest_a) = a[..length].as_chunks::<4>();
    let (b, rest_b) = b[..length].as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        (0..4).for_each(|i| sums[i] += a[i] * b[i]);
    }
    sums.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f64>()
}

/// The Euclidean norm.
#[must_use]
pub fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The columns grow to the middle, so that pivoting is no identity and no swap.
    fn example() -> Matrix {
        let size = [1.0, 7.0, 3.0];
        Matrix::from_fn(7, 3, |i, j| size[j] * ((3 * i + 5 * j * j + i * j) as f64 * 0.7).sin())
    }

    #[test]
    fn least_squares_residual_is_orthogonal_to_the_columns() {
        let a = example();
        let y: Vec<f64> = (0..7).map(|i| (i as f64).cos()).collect();
        let x = PivotedQr::new(&a).solve(&y);
        let residual: Vec<f64> = a.times(&x).iter().zip(&y).map(|(p, y)| y - p).collect();
        for j in 0..3 {
            let dot: f64 = a.column(j).iter().zip(&residual).map(|(a, r)| a * r).sum();
            assert!(dot.abs() < 1e-13, "column {j}: {dot:e}");
        }
    }

    #[test]
    fn triangular_factors_stand_for_their_matrices() {
        let a = example();
        let (above, below) = (a.select_rows(&[true, true, false, false, false, false, false]), a.clone());
        let parts = Matrix::stack(&[&above.triangular_factor(), &below.triangular_factor()]).triangular_factor();
        let r = Matrix::stack(&[&above, &below]).triangular_factor();
        assert_eq!((r.rows(), above.triangular_factor().rows()), (3, 2));
        for i in 0..3 {
            assert!(r.at(i, i) > 0.0);
            for j in 0..3 {
                assert!((r.at(i, j) - parts.at(i, j)).abs() < 1e-13 && (j >= i || r.at(i, j) == 0.0));
            }
        }
    }

    #[test]
    fn a_symmetric_matrix_is_its_eigenvalues_on_its_eigenvectors() {
        let a = example().transposed_times(&example());
        let (values, vectors) = a.symmetric_eigen().unwrap();
        let back = vectors.scale_columns(&values).times_matrix(&vectors.transpose());
        for i in 0..3 {
            (0..3).for_each(|j| assert!((back.at(i, j) - a.at(i, j)).abs() < 1e-12 * a.at(1, 1)));
        }
    }

    #[test]
    fn pivots_name_the_columns_in_their_order() {
        let mut a = example();
        a.column_mut(0).fill(0.0);
        let qr = PivotedQr::new(&a);
        assert_eq!(qr.pivots(), [1, 2, 0]);
        assert_eq!(qr.rank(1e-12), 2);
    }

    #[test]
    fn inverse_gram_inverts_the_gram_matrix() {
        let a = example();
        let product = a.transpose().times_matrix(&a).times_matrix(&PivotedQr::new(&a).inverse_gram());
        for i in 0..3 {
            for j in 0..3 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((product.at(i, j) - expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn scaled_columns_change_nothing_but_the_rounding() {
        let a = example().scale_columns(&[1e-4, 1.0, 1e6]);
        let y: Vec<f64> = (0..7).map(|i| (i as f64).cos()).collect();
        let (scaled, plain) = (PivotedQr::with_equal_columns(&a), PivotedQr::with_equal_columns(&example()));
        let (x, expected) = (scaled.solve(&y), plain.solve(&y));
        for (j, factor) in [1e-4, 1.0, 1e6].into_iter().enumerate() {
            assert!((x[j] * factor / expected[j] - 1.0).abs() < 1e-12);
            let gram = scaled.inverse_gram().at(j, j) * factor * factor;
            assert!((gram / plain.inverse_gram().at(j, j) - 1.0).abs() < 1e-12);
        }
        assert_eq!((scaled.rank(1e-10), PivotedQr::new(&a).rank(1e-10)), (3, 2));
        let of_r = scaled.thin_r().condition_number() / a.condition_number();
        assert!((of_r - 1.0).abs() < 1e-3, "the condition number is that of the matrix as it is: {of_r}");
    }

    #[test]
    fn columns_of_zeros_and_of_rounding_stay_what_they_are() {
        for size in [0.0, 1e-16] {
            let a = example().scale_columns(&[size, 1.0, 1.0]);
            assert_eq!(PivotedQr::with_equal_columns(&a).rank(1e-12), 2);
        }
    }

    #[test]
    fn the_inverse_quadratic_form_is_that_of_the_inverse() {
        let a = example();
        let gram = a.transpose().times_matrix(&a);
        let x = [1.0, -2.0, 0.5];
        let solved = gram.inverse().unwrap().times(&x);
        let expected: f64 = solved.iter().zip(&x).map(|(s, x)| s * x).sum();
        assert!((gram.inverse_quadratic_form(&x).unwrap() / expected - 1.0).abs() < 1e-10);
        assert!(Matrix::zeros(2, 2).inverse_quadratic_form(&[1.0, 1.0]).is_none());
        assert_eq!(a.row_range(1..3).plus(&a.row_range(1..3), -1.0), Matrix::zeros(2, 3));
    }

    #[test]
    fn singular_matrix_has_no_inverse_and_an_infinite_condition_number() {
        let a = Matrix::from_fn(3, 3, |i, j| (i + j) as f64);
        assert!(a.inverse().is_none());
        assert!(a.condition_number() > 1e15);
    }

    #[test]
    fn nan_is_not_full_rank() {
        let mut a = example();
        *a.at_mut(2, 1) = f64::NAN;
        assert!(PivotedQr::new(&a).rank(1e-12) < 3);
        assert!(a.condition_number().is_infinite());
    }
}
