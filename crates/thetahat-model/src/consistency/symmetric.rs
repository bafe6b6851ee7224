//! Small symmetric matrices, such as the pseudo-inertia matrix, with their Cholesky factors.

use thetahat_ground::linear_algebra::dot;

/// Most sweeps of rotations; five are usual.
const SWEEPS: usize = 30;

/// A small symmetric matrix, all entries stored row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetric {
    size: usize,
    values: Vec<f64>,
}

/// The lower triangular L of `S = L L^T`, row by row.
#[derive(Debug, Clone)]
pub(super) struct Cholesky {
    size: usize,
    lower: Vec<f64>,
}

impl Symmetric {
    /// A matrix of zeros.
    #[must_use]
    pub fn zeros(size: usize) -> Self {
        Self { size, values: vec![0.0; size * size] }
    }

    /// A matrix from its diagonal.
    #[must_use]
    pub fn diagonal(values: &[f64]) -> Self {
        let mut out = Self::zeros(values.len());
        values.iter().enumerate().for_each(|(i, v)| out.add(i, i, *v));
        out
    }

    /// Number of rows.
    #[must_use]
    pub fn size(&self) -> usize {
        self.size
    }

    /// The entry at row `i`, column `j`.
    #[must_use]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.values[i * self.size + j]
    }

    /// Adds `value` to the entries (i, j) and (j, i).
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        self.values[i * self.size + j] += value;
        if i != j {
            self.values[j * self.size + i] += value;
        }
    }

    /// `A + factor B`.
    #[must_use]
    pub fn plus(&self, other: &Self, factor: f64) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| a + factor * b).collect();
        Self { size: self.size, values }
    }

    /// `factor A`.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self { size: self.size, values: self.values.iter().map(|v| factor * v).collect() }
    }

    /// `tr(A B)`.
    #[must_use]
    pub fn inner(&self, other: &Self) -> f64 {
        dot(&self.values, &other.values)
    }

    /// Eigenvalues, rising; none if an entry is not finite.
    ///
    /// Jacobi's rotations (Golub and Van Loan, *Matrix Computations*, section 8.5): for four rows they take a tenth of the time
    /// of a general method.
    #[must_use]
    pub fn eigenvalues(&self) -> Vec<f64> {
        if !self.values.iter().all(|v| v.is_finite()) {
            return Vec::new();
        }
        let mut rotated = self.clone();
        let n = self.size;
        for _ in 0..SWEEPS {
            let off: f64 =
                (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| rotated.at(i, j).powi(2)).sum();
            let all = dot(&rotated.values, &rotated.values);
            if off <= f64::EPSILON.powi(2) * all {
                break;
            }
            (0..n).flat_map(|i| (0..i).map(move |j| (j, i))).for_each(|(p, q)| rotated.rotate(p, q));
        }
        let mut values: Vec<f64> = (0..n).map(|i| rotated.at(i, i)).collect();
        values.sort_by(f64::total_cmp);
        values
    }

    /// The rotation that makes the entry (p, q) zero.
    fn rotate(&mut self, p: usize, q: usize) {
        let (n, off) = (self.size, self.at(p, q));
        if off == 0.0 {
            return;
        }
        let half = (self.at(q, q) - self.at(p, p)) / (2.0 * off);
        let tangent = half.signum() / (half.abs() + (half * half + 1.0).sqrt());
        let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
        let sine = tangent * cosine;
        for k in 0..n {
            let (a, b) = (self.values[k * n + p], self.values[k * n + q]);
            (self.values[k * n + p], self.values[k * n + q]) = (cosine * a - sine * b, sine * a + cosine * b);
        }
        for k in 0..n {
            let (a, b) = (self.values[p * n + k], self.values[q * n + k]);
            (self.values[p * n + k], self.values[q * n + k]) = (cosine * a - sine * b, sine * a + cosine * b);
        }
    }

    /// The smallest eigenvalue; NaN if an entry is not finite.
    #[must_use]
    pub fn smallest_eigenvalue(&self) -> f64 {
        self.eigenvalues().first().copied().unwrap_or(f64::NAN)
    }

    /// `(A B C + C B A) / 2` for symmetric A, B, C.
    pub(super) fn between(left: &Self, middle: &Self, right: &Self) -> Self {
        let n = left.size;
        if n == 1 {
            return Self { size: 1, values: vec![left.values[0] * middle.values[0] * right.values[0]] };
        }
        let full = product(n, &product(n, &left.values, &middle.values), &right.values);
        Self { size: n, values: full }.symmetrised()
    }

    /// `(M + M^T) / 2` of entries that are not symmetric.
    fn symmetrised(mut self) -> Self {
        let n = self.size;
        for i in 0..n {
            for j in 0..i {
                let mean = 0.5 * (self.values[i * n + j] + self.values[j * n + i]);
                (self.values[i * n + j], self.values[j * n + i]) = (mean, mean);
            }
        }
        self
    }

    /// `sum_ij v_ij (A e_i e_j^T B + its transpose) / 2`: `(A E B + B E A) / 2` for a sparse E by its entries.
    pub(super) fn around(left: &Self, entries: &[(usize, usize, f64)], right: &Self) -> Self {
        let n = left.size;
        let mut out = Self::zeros(n);
        let mut add = |i: usize, j: usize, v: f64| {
            let row = &right.values[j * n..j * n + n];
            for (k, out) in out.values.chunks_exact_mut(n).enumerate() {
                let factor = v * left.values[k * n + i];
                out.iter_mut().zip(row).for_each(|(o, r)| *o += factor * r);
            }
        };
        for &(i, j, v) in entries {
            add(i, j, v);
            if i != j {
                add(j, i, v);
            }
        }
        out.symmetrised()
    }

    /// The Cholesky factor; none if the matrix is not positive definite.
    pub(super) fn cholesky(&self) -> Option<Cholesky> {
        let n = self.size;
        let mut lower = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let sum = self.at(i, j) - (0..j).map(|k| lower[i * n + k] * lower[j * n + k]).sum::<f64>();
                lower[i * n + j] = if i > j {
                    sum / lower[j * n + j]
                } else if sum > 0.0 {
                    sum.sqrt()
                } else {
                    return None;
                };
            }
        }
        lower.iter().all(|v| v.is_finite()).then_some(Cholesky { size: n, lower })
    }
}

/// `A B` of square matrices, row by row.
fn product(n: usize, a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; n * n];
    for (row, out) in a.chunks_exact(n).zip(out.chunks_exact_mut(n)) {
        for (a, b) in row.iter().zip(b.chunks_exact(n)) {
            out.iter_mut().zip(b).for_each(|(o, b)| *o += a * b);
        }
    }
    out
}

impl Cholesky {
    /// `log det S`.
    pub(super) fn log_determinant(&self) -> f64 {
        (0..self.size).map(|i| 2.0 * self.lower[i * self.size + i].ln()).sum()
    }

    /// `S^-1`.
    pub(super) fn inverse(&self) -> Symmetric {
        let n = self.size;
        let columns: Vec<Vec<f64>> = (0..n).map(|j| self.forward(|i| if i == j { 1.0 } else { 0.0 })).collect();
        let mut out = Symmetric::zeros(n);
        for i in 0..n {
            (0..=i).for_each(|j| out.add(i, j, dot(&columns[i], &columns[j])));
        }
        out
    }

    /// The smallest eigenvalue of `L^-1 B L^-T`: the largest t with `B - t S` positive semidefinite.
    pub(super) fn smallest_ratio(&self, b: &Symmetric) -> f64 {
        let n = self.size;
        if n == 1 {
            return b.values[0] / (self.lower[0] * self.lower[0]);
        }
        let half: Vec<Vec<f64>> = (0..n).map(|j| self.forward(|i| b.at(i, j))).collect();
        let mut whitened = Symmetric::zeros(n);
        let rows: Vec<Vec<f64>> = (0..n).map(|i| self.forward(|k| half[k][i])).collect();
        for (i, row) in rows.iter().enumerate() {
            (0..=i).for_each(|j| whitened.add(i, j, row[j]));
        }
        whitened.smallest_eigenvalue()
    }

    /// `L^-1 b`.
    fn forward(&self, b: impl Fn(usize) -> f64) -> Vec<f64> {
        let n = self.size;
        let mut x = Vec::with_capacity(n);
        for i in 0..n {
            let known = dot(&self.lower[i * n..i * n + i], &x);
            x.push((b(i) - known) / self.lower[i * n + i]);
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Symmetric {
        let mut s = Symmetric::diagonal(&[2.0, 3.0, 1.0]);
        s.add(1, 0, 0.5);
        s.add(2, 0, -0.3);
        s
    }

    #[test]
    fn the_inverse_of_a_factor_inverts_the_matrix() {
        let (s, inverse) = (example(), example().cholesky().unwrap().inverse());
        let identity = Symmetric::between(&s, &inverse, &Symmetric::diagonal(&[1.0; 3]));
        assert!(identity.plus(&Symmetric::diagonal(&[1.0; 3]), -1.0).eigenvalues().iter().all(|v| v.abs() < 1e-14));
        let product: f64 = s.eigenvalues().iter().product();
        assert!((s.cholesky().unwrap().log_determinant() - product.ln()).abs() < 1e-14);
    }

    #[test]
    fn the_smallest_ratio_is_where_the_difference_becomes_singular() {
        let (s, mut b) = (example(), Symmetric::diagonal(&[1.0, -2.0, 0.4]));
        b.add(2, 1, 0.7);
        let ratio = s.cholesky().unwrap().smallest_ratio(&b);
        assert!(b.plus(&s, -ratio).smallest_eigenvalue().abs() < 1e-13);
        assert!(b.plus(&s, -ratio + 1e-6).cholesky().is_some());
    }

    #[test]
    fn an_indefinite_matrix_has_no_factor() {
        assert!(Symmetric::diagonal(&[1.0, 0.0]).cholesky().is_none());
        assert!(Symmetric::diagonal(&[1.0, f64::NAN]).cholesky().is_none());
    }
}
