use thetahat_ground::real::Real;

/// Solves `M x = b` in place by `M = L D L^T`; see [`factorise`].
#[inline(always)]
pub(super) fn solve_positive_definite<T: Real>(m: &mut [T], b: &mut [T]) -> Result<(), (usize, T)> {
    factorise(m, b.len())?;
    solve_factorised(m, b);
    Ok(())
}

/// `M = L D L^T` in place; M is n by n, row by row, of which only the lower triangle is used, and it is overwritten by L with
/// `1/D` on its diagonal.
///
/// The error is the index and value of a pivot that is not positive. Written by hand because it runs in every right-hand side
/// of the simulation, where nothing may allocate.
#[inline(always)]
#[doc(hidden)]
pub fn factorise<T: Real>(m: &mut [T], n: usize) -> Result<(), (usize, T)> {
    for j in 0..n {
        let (above, row) = m.split_at_mut(j * n);
        // Entry i of the row becomes (L D)_ji, then L_ji; the squares of L, weighted by D, are subtracted from the pivot.
        for i in 0..j {
            row[i] -= products(row[i], &above[i * n..], &row[..i]);
        }
        let mut pivot = row[j];
        for i in 0..j {
            let l = row[i] * above[i * n + i];
            pivot -= l * row[i];
            row[i] = l;
        }
        if !pivot.is_positive() {
            return Err((j, pivot));
        }
        row[j] = pivot.like(1.0) / pivot;
    }
    Ok(())
}

/// Solves `L D L^T x = b` in place.
#[inline(always)]
#[doc(hidden)]
pub fn solve_factorised<T: Real>(m: &[T], b: &mut [T]) {
    let n = b.len();
    for i in 0..n {
        b[i] -= products(b[i], &m[i * n..], &b[..i]);
    }
    for i in (0..n).rev() {
        let mut sum = b[i].like(0.0);
        for k in i + 1..n {
            sum += m[k * n + i] * b[k];
        }
        b[i] = b[i] * m[i * n + i] - sum;
    }
}

/// Computes `M`, both triangles, from its factors.
#[doc(hidden)]
pub fn multiply_factors(factors: &[f64], n: usize, m: &mut [f64]) {
    for i in 0..n {
        for j in 0..=i {
            let (row_i, row_j) = (&factors[i * n..], &factors[j * n..]);
            let before: f64 = (0..j).map(|k| row_i[k] * row_j[k] / factors[k * n + k]).sum();
            let own = if i == j { 1.0 } else { row_i[j] };
            let value = before + own / factors[j * n + j];
            (m[i * n + j], m[j * n + i]) = (value, value);
        }
    }
}

/// `sum_i a_i b_i` over the entries of b.
#[inline(always)]
fn products<T: Real>(kind: T, a: &[T], b: &[T]) -> T {
    let a = &a[..b.len()];
    let mut sum = kind.like(0.0);
    for (i, b) in b.iter().enumerate() {
        sum += a[i] * *b;
    }
    sum
}
