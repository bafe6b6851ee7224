//! Accelerations from torques: the mass matrix, the torques at zero acceleration, and `L D L^T`.

use super::{expression::Expression, mass_matrix::place};

/// Solves `M x = b` for the lower triangle of a positive definite matrix; the error is the coordinate at which a numeric matrix
/// is not positive definite.
pub(super) fn solve<'g>(mut m: Vec<Expression<'g>>, mut b: Vec<Expression<'g>>) -> Result<Vec<Expression<'g>>, usize> {
    let n = b.len();
    let mut inverse_pivots = Vec::with_capacity(n);
    for j in 0..n {
        let pivot = factor_row(&mut m, j, &inverse_pivots);
        if pivot.number().is_some_and(|number| number <= 0.0) {
            return Err(j);
        }
        inverse_pivots.push(pivot.builder().constant(1.0) / pivot);
    }
    for i in 0..n {
        b[i] = (0..i).fold(b[i], |sum, k| sum - m[place(i, k)] * b[k]);
    }
    for i in (0..n).rev() {
        b[i] = (i + 1..n).fold(b[i] * inverse_pivots[i], |sum, k| sum - m[place(k, i)] * b[k]);
    }
    Ok(b)
}

/// Replaces row `j` by that of `L`, and returns its pivot.
fn factor_row<'g>(m: &mut [Expression<'g>], j: usize, inverse_pivots: &[Expression<'g>]) -> Expression<'g> {
    for i in 0..j {
        m[place(j, i)] = (0..i).fold(m[place(j, i)], |sum, k| sum - m[place(i, k)] * m[place(j, k)]);
    }
    let mut pivot = m[place(j, j)];
    for i in 0..j {
        let entry = m[place(j, i)] * inverse_pivots[i];
        pivot = pivot - entry * m[place(j, i)];
        m[place(j, i)] = entry;
    }
    pivot
}
