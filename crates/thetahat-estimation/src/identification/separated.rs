//! The columns that a motion separates from one another.

use super::fit::independent_columns;
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, norm};

/// Part of a dependent column that another must make to be named with it.
const SMALLEST_PART: f64 = 1e-6;

/// Length of a column without effect, relative to the longest: rounding.
const NO_EFFECT: f64 = 1e-12;

/// A column that others span.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DependentColumn {
    /// The column.
    pub column: usize,
    /// The separated columns that span it, the strongest first; none if it has no effect.
    pub spanned_by: Vec<usize>,
}

/// The columns of a matrix that are independent, and those that they span.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeparatedColumns {
    /// Independent columns, ascending.
    pub kept: Vec<usize>,
    /// The others, ascending.
    pub dependent: Vec<DependentColumn>,
}

impl SeparatedColumns {
    /// Of a matrix with more rows than columns, to the accuracy with which estimates need them.
    #[must_use]
    pub fn of(x: &Matrix) -> Self {
        let (mut kept, mut dependent) = independent_columns(x);
        kept.sort_unstable();
        dependent.sort_unstable();
        if dependent.is_empty() {
            return Self { kept, dependent: Vec::new() };
        }
        let separated = x.select_columns(&kept);
        let qr = PivotedQr::new(&separated);
        let longest = (0..x.columns()).map(|column| norm(x.column(column))).fold(0.0, f64::max);
        let of_column = |&column: &usize| {
            let has_effect = norm(x.column(column)) > NO_EFFECT * longest;
            let spanned_by = has_effect.then(|| spanned_by(&qr, &separated, &kept, x.column(column)));
            DependentColumn { column, spanned_by: spanned_by.unwrap_or_default() }
        };
        let dependent = dependent.iter().map(of_column).collect();
        Self { kept, dependent }
    }

    /// The kept columns whose estimates include a part of a dependent one.
    pub fn including(&self) -> impl Iterator<Item = usize> {
        self.dependent.iter().flat_map(|dependent| dependent.spanned_by.iter().copied())
    }
}

fn spanned_by(qr: &PivotedQr, separated: &Matrix, kept: &[usize], column: &[f64]) -> Vec<usize> {
    let length = norm(column);
    let part = |(k, coefficient): (usize, &f64)| (coefficient.abs() * norm(separated.column(k)) / length, kept[k]);
    let mut parts: Vec<(f64, usize)> = qr.solve(column).iter().enumerate().map(part).collect();
    parts.retain(|(part, _)| *part > SMALLEST_PART);
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    parts.into_iter().map(|(_, column)| column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns t, 1, 3 t - 2, 0 and t squared.
    fn matrix() -> Matrix {
        let value = |k: usize, column: usize| {
            let t = 0.1 * k as f64;
            [t, 1.0, 3.0 * t - 2.0, 0.0, t * t][column]
        };
        Matrix::from_fn(50, 5, value)
    }

    #[test]
    fn a_sum_is_dependent_with_its_terms() {
        let found = SeparatedColumns::of(&matrix());
        assert_eq!((found.kept.len(), found.dependent.len()), (3, 2));
        assert!(found.kept.contains(&4) && !found.kept.contains(&3));
        let zero = found.dependent.iter().find(|d| d.column == 3).unwrap();
        assert!(zero.spanned_by.is_empty());
        let sum = found.dependent.iter().find(|d| d.column != 3).unwrap();
        let mut group = sum.spanned_by.clone();
        group.push(sum.column);
        group.sort_unstable();
        assert_eq!(group, [0, 1, 2]);
    }

    #[test]
    fn independent_columns_are_kept() {
        let found = SeparatedColumns::of(&matrix().select_columns(&[0, 1, 4]));
        assert_eq!((found.kept, found.dependent), (vec![0, 1, 2], Vec::new()));
    }
}
