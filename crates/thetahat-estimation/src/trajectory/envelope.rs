//! Symmetric positive definite matrices with few entries off the diagonal, and their Cholesky factor.

use thetahat_ground::linear_algebra::dot;

/// Part of a diagonal entry below which what elimination leaves of it is rounding: that unknown cannot be determined.
const ROUNDING: f64 = 1e-14;

/// A symmetric matrix: each row from its first entry that may differ from zero to the diagonal.
#[derive(Clone)]
pub(super) struct Envelope {
    /// Row i from the diagonal backwards: entry `(i, i - m)` at `m`.
    rows: Vec<Vec<f64>>,
}

/// The factor `L` with `A = L L^T`, in the same envelope.
pub(super) struct EnvelopeFactor {
    rows: Vec<Vec<f64>>,
}

impl Envelope {
    /// A matrix of zeros.
    pub fn zeros(size: usize) -> Self {
        Self { rows: vec![vec![0.0]; size] }
    }

    /// Adds to the entries `(i, j)` and `(j, i)`.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let (row, back) = (&mut self.rows[i.max(j)], i.abs_diff(j));
        if back >= row.len() {
            row.resize(back + 1, 0.0);
        }
        row[back] += value;
    }

    /// The entry `(i, i)`.
    pub fn diagonal(&self, i: usize) -> f64 {
        self.rows[i][0]
    }

    /// The Cholesky factor. An unknown that the others express gets an infinite pivot, with which it is zero in every solution.
    pub fn factor(mut self) -> EnvelopeFactor {
        for i in 0..self.rows.len() {
            let (before, from_here) = self.rows.split_at_mut(i);
            let row = &mut from_here[0];
            for back in (1..row.len()).rev() {
                let other = &before[i - back];
                let common = (row.len() - back).min(other.len()) - 1;
                let known = dot(&row[back + 1..=back + common], &other[1..=common]);
                row[back] = (row[back] - known) / other[0];
            }
            let pivot = row[0] - dot(&row[1..], &row[1..]);
            row[0] = if pivot > ROUNDING * row[0] { pivot.sqrt() } else { f64::INFINITY };
        }
        EnvelopeFactor { rows: self.rows }
    }
}

impl EnvelopeFactor {
    /// The solution `x` of `A x = b`.
    pub fn solve(&self, mut b: Vec<f64>) -> Vec<f64> {
        for (i, row) in self.rows.iter().enumerate() {
            let known: f64 = (1..row.len()).map(|back| row[back] * b[i - back]).sum();
            b[i] = (b[i] - known) / row[0];
        }
        for (i, row) in self.rows.iter().enumerate().rev() {
            b[i] /= row[0];
            for back in 1..row.len() {
                b[i - back] -= row[back] * b[i];
            }
        }
        b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arrow of bands: solved, and multiplied again.
    #[test]
    fn a_solution_satisfies_the_equations() {
        let entries = [(0, 0, 4.0), (1, 0, 1.0), (1, 1, 5.0), (2, 2, 3.0), (3, 1, -2.0), (3, 2, 0.5), (3, 3, 6.0)];
        let mut matrix = Envelope::zeros(4);
        entries.iter().for_each(|&(i, j, value)| matrix.add(j, i, value));
        let x = matrix.factor().solve(vec![1.0, -2.0, 3.0, 4.0]);
        let mut product = [0.0; 4];
        for (i, j, value) in entries {
            product[i] += value * x[j];
            if i != j {
                product[j] += value * x[i];
            }
        }
        for (found, expected) in product.iter().zip([1.0, -2.0, 3.0, 4.0]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }

    #[test]
    fn an_unknown_that_others_express_is_zero() {
        let mut matrix = Envelope::zeros(3);
        for (i, j) in [(0, 0), (1, 0), (1, 1), (2, 2)] {
            matrix.add(i, j, 2.0);
        }
        let x = matrix.factor().solve(vec![4.0, 4.0, 6.0]);
        assert!((x[0] - 2.0).abs() < 1e-14 && x[1] == 0.0 && (x[2] - 3.0).abs() < 1e-14, "{x:?}");
    }
}
