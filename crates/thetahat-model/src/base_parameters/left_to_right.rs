use thetahat_ground::linear_algebra::{dot, norm};

/// Size of the remainder of a column of norm about 1 below which it is spanned by earlier ones: rounding leaves less than
/// 1e-13.
const SPANNED: f64 = 1e-11;
/// Size of the remainder above which a column is independent. Between the two limits the whole matrix must decide.
const INDEPENDENT: f64 = 1e-6;

/// Gram-Schmidt with one repetition, column by column: `K = Q R` of the columns kept.
#[derive(Default)]
pub(super) struct LeftToRight {
    basis: Vec<Vec<f64>>,
    /// The columns of R.
    triangle: Vec<Vec<f64>>,
}

/// Whether a column is independent of the earlier ones.
pub(super) enum Column {
    /// Independent; the column is kept.
    Independent,
    /// The sum of the columns kept, with these coefficients.
    Spanned(Vec<f64>),
}

impl LeftToRight {
    /// Examines the next column; `None` if the result is not clear.
    pub(super) fn push(&mut self, mut rest: Vec<f64>) -> Option<Column> {
        let mut along = vec![0.0; self.basis.len()];
        (0..2).for_each(|_| self.take_off(&mut rest, &mut along));
        let size = norm(&rest);
        if size < SPANNED {
            return Some(Column::Spanned(self.coefficients(along)));
        }
        rest.iter_mut().for_each(|r| *r /= size);
        along.push(size);
        self.basis.push(rest);
        self.triangle.push(along);
        (size > INDEPENDENT).then_some(Column::Independent)
    }

    fn take_off(&self, rest: &mut [f64], along: &mut [f64]) {
        for (b, along) in self.basis.iter().zip(along) {
            let part = dot(b, rest);
            *along += part;
            rest.iter_mut().zip(b).for_each(|(r, b)| *r -= part * b);
        }
    }

    /// `R^-1 along`.
    fn coefficients(&self, mut along: Vec<f64>) -> Vec<f64> {
        for (j, r) in self.triangle.iter().enumerate().rev() {
            let value = along[j] / r[j];
            along[..j].iter_mut().zip(r).for_each(|(a, r)| *a -= value * r);
            along[j] = value;
        }
        along
    }
}
