//! Solves equalities once: the standard parameters become an affine function of fewer unknowns.

use super::{
    error::ConsistencyError,
    program::{Block, Term},
    symmetric::Symmetric,
};
use thetahat_ground::linear_algebra::Matrix;

/// `sum_v coefficient_v x_v = value`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Equality {
    pub(super) name: String,
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) value: f64,
}

/// `x = particular values + N y`: x standard parameters, `values` the right sides of the equalities, y the unknowns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Elimination {
    /// The standard parameter of each unknown.
    free: Vec<usize>,
    /// Row of N of each standard parameter: unknowns and coefficients.
    rows: Vec<Vec<(usize, f64)>>,
    /// The change of each standard parameter per unit of each equality's right side.
    particular: Matrix,
    offset: Vec<f64>,
}

/// Size of a coefficient, relative to the largest of its equality, below which it is rounding.
const ROUNDING: f64 = 1e-10;

/// An equality during the elimination, with its combination of the given ones.
struct Row {
    coefficients: Vec<f64>,
    combination: Vec<f64>,
    pivot: usize,
}

impl Elimination {
    /// Solves equalities in `count` parameters by Gauss-Jordan elimination; pivots have the largest coefficient times
    /// `scale`, the usual size of each parameter.
    ///
    /// # Errors
    /// [`ConsistencyError::ContradictoryValues`] for an equality that the others contradict.
    pub(super) fn new(equalities: &[Equality], scale: &[f64]) -> Result<Self, ConsistencyError> {
        Self::with(equalities, scale, equalities.len())
    }

    /// [`Elimination::new`] in which only the first `binding` equalities must not contradict others. Any other is dropped if
    /// earlier ones contradict it.
    ///
    /// # Errors
    /// As [`Elimination::new`].
    pub(super) fn with(equalities: &[Equality], scale: &[f64], binding: usize) -> Result<Self, ConsistencyError> {
        let (count, many) = (scale.len(), equalities.len());
        let mut solved: Vec<Row> = Vec::new();
        for (place, equality) in equalities.iter().enumerate() {
            let mut row = Row::new(equality, place, count, many);
            let size = row.largest(scale).1;
            solved.iter().for_each(|known| row.subtract(known, row.coefficients[known.pivot]));
            let (pivot, left) = row.largest(scale);
            if left <= ROUNDING * size {
                let redundant = row.check_redundant(equalities, place, size);
                if place < binding {
                    redundant?;
                }
                continue;
            }
            row.normalise(pivot);
            for known in &mut solved {
                known.subtract(&row, known.coefficients[pivot]);
            }
            solved.push(row);
        }
        let values: Vec<f64> = equalities.iter().map(|e| e.value).collect();
        Ok(Self::from_rows(&solved, count, &values))
    }

    fn from_rows(solved: &[Row], count: usize, values: &[f64]) -> Self {
        let free: Vec<usize> = (0..count).filter(|v| solved.iter().all(|row| row.pivot != *v)).collect();
        let mut rows = vec![Vec::new(); count];
        free.iter().enumerate().for_each(|(y, &v)| rows[v].push((y, 1.0)));
        let mut particular = Matrix::zeros(count, values.len());
        for row in solved {
            let others = free.iter().enumerate().map(|(y, &v)| (y, -row.coefficients[v]));
            rows[row.pivot] = others.filter(|(_, c)| c.abs() > ROUNDING * ROUNDING).collect();
            row.combination.iter().enumerate().for_each(|(e, c)| *particular.at_mut(row.pivot, e) = *c);
        }
        let offset = if values.is_empty() { vec![0.0; count] } else { particular.times(values) };
        Self { free, rows, particular, offset }
    }

    /// Number of unknowns left.
    pub(super) fn unknowns(&self) -> usize {
        self.free.len()
    }

    /// x of y.
    pub(super) fn standard(&self, y: &[f64]) -> Vec<f64> {
        let value =
            |(row, offset): (&Vec<(usize, f64)>, &f64)| row.iter().map(|&(k, c)| c * y[k]).sum::<f64>() + offset;
        self.rows.iter().zip(&self.offset).map(value).collect()
    }

    /// The unknowns of a vector of standard parameters, whether or not it satisfies the equalities.
    pub(super) fn unknowns_of(&self, x: &[f64]) -> Vec<f64> {
        self.free.iter().map(|&v| x[v]).collect()
    }

    /// `A N`.
    pub(super) fn matrix(&self, a: &Matrix) -> Matrix {
        let mut out = Matrix::zeros(a.rows(), self.free.len());
        for (v, row) in self.rows.iter().enumerate() {
            for &(y, c) in row {
                out.column_mut(y).iter_mut().zip(a.column(v)).for_each(|(o, a)| *o += c * a);
            }
        }
        out
    }

    /// `A` times the part of x that does not depend on y.
    pub(super) fn constant_part(&self, a: &Matrix) -> Vec<f64> {
        a.times(&self.offset)
    }

    /// Expresses a block of the standard parameters in the unknowns.
    pub(super) fn block(&self, block: &Block) -> Block {
        let size = block.constant.size();
        let mut matrices: Vec<Option<Symmetric>> = vec![None; self.free.len()];
        for term in &block.terms {
            for &(y, c) in &self.rows[term.unknown] {
                let sum = matrices[y].take().unwrap_or_else(|| Symmetric::zeros(size));
                matrices[y] = Some(sum.plus(&term.matrix(size), c));
            }
        }
        let terms = matrices.iter().enumerate().filter_map(|(y, m)| m.as_ref().map(|m| Term::new(y, m)));
        let terms = terms.filter(|term| !term.entries.is_empty()).collect();
        Block { constant: block.value(&self.offset), terms, barrier: block.barrier.clone() }
    }

    /// `g^T dx / d values`: how a linear function of x depends on the right side of equality `e`, with y kept.
    pub(super) fn sensitivity(&self, g: &[f64], e: usize) -> f64 {
        g.iter().zip(self.particular.column(e)).map(|(g, p)| g * p).sum()
    }
}

impl Row {
    fn new(equality: &Equality, place: usize, count: usize, many: usize) -> Self {
        let mut coefficients = vec![0.0; count];
        equality.terms.iter().for_each(|&(v, c)| coefficients[v] += c);
        let mut combination = vec![0.0; many];
        combination[place] = 1.0;
        Self { coefficients, combination, pivot: 0 }
    }

    fn largest(&self, scale: &[f64]) -> (usize, f64) {
        let sizes = self.coefficients.iter().zip(scale).map(|(c, s)| (c * s).abs()).enumerate();
        sizes.fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best })
    }

    fn subtract(&mut self, other: &Self, factor: f64) {
        if factor != 0.0 {
            let pivot = other.pivot;
            self.coefficients.iter_mut().zip(&other.coefficients).for_each(|(a, b)| *a -= factor * b);
            self.combination.iter_mut().zip(&other.combination).for_each(|(a, b)| *a -= factor * b);
            self.coefficients[pivot] = 0.0;
        }
    }

    fn normalise(&mut self, pivot: usize) {
        let factor = 1.0 / self.coefficients[pivot];
        self.coefficients.iter_mut().chain(&mut self.combination).for_each(|v| *v *= factor);
        self.pivot = pivot;
    }

    fn check_redundant(&self, all: &[Equality], place: usize, size: f64) -> Result<(), ConsistencyError> {
        let rest: f64 = self.combination.iter().zip(all).map(|(c, e)| c * e.value).sum();
        let magnitude: f64 = self.combination.iter().zip(all).map(|(c, e)| (c * e.value).abs()).sum();
        if rest.abs() <= ROUNDING * (magnitude + size) {
            return Ok(());
        }
        let Equality { name, value, .. } = &all[place];
        Err(ConsistencyError::ContradictoryValues { known: name.clone(), found: value - rest, expected: *value })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn equality(terms: &[(usize, f64)], value: f64) -> Equality {
        Equality { name: format!("sum of {}", terms.len()), terms: terms.to_vec(), value }
    }

    #[test]
    fn the_equalities_hold_for_any_unknowns() {
        let given = [equality(&[(0, 1.0), (1, 2.0), (3, -1.0)], 5.0), equality(&[(1, 1.0), (2, 1.0)], 1.0)];
        let elimination = Elimination::new(&given, &[1.0; 4]).unwrap();
        let x = elimination.standard(&[0.7, -0.3]);
        for e in &given {
            assert!((e.terms.iter().map(|&(v, c)| c * x[v]).sum::<f64>() - e.value).abs() < 1e-14);
        }
        assert_eq!(elimination.unknowns_of(&x), [0.7, -0.3]);
    }

    #[test]
    fn an_equality_said_twice_is_one_and_a_contradiction_is_named() {
        let mut given = vec![equality(&[(0, 1.0), (1, 1.0)], 5.0), equality(&[(0, 2.0), (1, 2.0)], 10.0)];
        assert_eq!(Elimination::new(&given, &[1.0; 2]).unwrap().unknowns(), 1);
        given[1].value = 11.0;
        let error = Elimination::new(&given, &[1.0; 2]).unwrap_err();
        assert!(matches!(error, ConsistencyError::ContradictoryValues { expected: 11.0, .. }), "{error}");
    }

    #[test]
    fn an_equality_that_does_not_bind_gives_way() {
        let given = [equality(&[(0, 1.0)], 5.0), equality(&[(0, 1.0)], 6.0), equality(&[(1, 1.0)], 7.0)];
        let elimination = Elimination::with(&given, &[1.0; 3], 1).unwrap();
        assert_eq!(elimination.standard(&[0.5]), [5.0, 7.0, 0.5]);
        assert!(Elimination::with(&given, &[1.0; 3], 2).is_err());
    }
}
