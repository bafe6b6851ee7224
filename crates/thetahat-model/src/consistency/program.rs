//! The convex problem of this module: a quadratic form over affine matrices that must be positive semidefinite.

use super::symmetric::{Cholesky, Symmetric};
use thetahat_ground::linear_algebra::{Matrix, dot};

/// A symmetric matrix that is affine in the unknowns, `S(x) = S_0 + sum_v x_v E_v`, and must be positive semidefinite.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Block {
    pub(super) constant: Symmetric,
    pub(super) terms: Vec<Term>,
    pub(super) barrier: Barrier,
}

/// `E_v` of one unknown, by its entries on and below the diagonal.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Term {
    pub(super) unknown: usize,
    pub(super) entries: Vec<(usize, usize, f64)>,
}

/// A convex function of a block, `weight D(S | S_ref) = weight (-log det S + tr(C S) + constant)`.
///
/// With a reference `C = S_ref^-1`, and the constant makes D zero at the reference; without, `C = 0`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Barrier {
    /// A constant weight; none for a constraint, whose weight falls to nearly zero during the solution.
    pub(super) weight: Option<f64>,
    pub(super) slope: Symmetric,
    pub(super) constant: f64,
}

/// Minimise `|A x - b|^2 + c^T x + constant` plus the divergences of the blocks that keep their weight.
///
/// The objective must be nonnegative everywhere.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Program {
    pub(super) matrix: Matrix,
    pub(super) right_side: Vec<f64>,
    pub(super) linear: Vec<f64>,
    pub(super) constant: f64,
    pub(super) blocks: Vec<Block>,
}

impl Barrier {
    /// The barrier of a constraint, with the divergence from `reference` if given.
    pub(super) fn vanishing(size: usize, reference: Option<&Symmetric>) -> Self {
        Self::new(None, size, reference.and_then(Symmetric::cholesky).as_ref())
    }

    /// The divergence from a reference, with a weight that is kept.
    pub(super) fn kept(weight: f64, reference: &Cholesky, size: usize) -> Self {
        Self::new(Some(weight), size, Some(reference))
    }

    fn new(weight: Option<f64>, size: usize, reference: Option<&Cholesky>) -> Self {
        let Some(factor) = reference else {
            return Self { weight, slope: Symmetric::zeros(size), constant: 0.0 };
        };
        Self { weight, slope: factor.inverse(), constant: factor.log_determinant() - size as f64 }
    }

    /// The barrier with a fraction of the pull towards the reference.
    pub(super) fn with_pull(self, part: f64) -> Self {
        Self { slope: self.slope.times(part), ..self }
    }

    /// The weight when constraints have the weight `vanishing`.
    pub(super) fn weight_at(&self, vanishing: f64) -> f64 {
        self.weight.unwrap_or(vanishing)
    }

    /// `-log det S + tr(C S) + constant`, of S and its factor.
    pub(super) fn divergence(&self, s: &Symmetric, factor: &Cholesky) -> f64 {
        self.slope.inner(s) - factor.log_determinant() + self.constant
    }
}

impl Term {
    /// The nonzero entries of a matrix.
    pub(super) fn new(unknown: usize, matrix: &Symmetric) -> Self {
        let places = (0..matrix.size()).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let entries = places.map(|(i, j)| (i, j, matrix.at(i, j))).filter(|(_, _, v)| *v != 0.0).collect();
        Self { unknown, entries }
    }

    /// `tr(E M)`.
    pub(super) fn inner(&self, m: &Symmetric) -> f64 {
        self.entries.iter().map(|&(i, j, v)| if i == j { v * m.at(i, i) } else { 2.0 * v * m.at(i, j) }).sum()
    }

    /// E as a matrix.
    pub(super) fn matrix(&self, size: usize) -> Symmetric {
        let mut out = Symmetric::zeros(size);
        self.entries.iter().for_each(|&(i, j, v)| out.add(i, j, v));
        out
    }
}

impl Block {
    /// `constant + factor x_unknown >= 0`.
    pub(super) fn scalar(constant: f64, unknown: usize, factor: f64) -> Self {
        let terms = vec![Term { unknown, entries: vec![(0, 0, factor)] }];
        Self { constant: Symmetric::diagonal(&[constant]), terms, barrier: Barrier::vanishing(1, None) }
    }

    /// `S(x)`.
    pub(super) fn value(&self, x: &[f64]) -> Symmetric {
        self.constant.plus(&self.change(x), 1.0)
    }

    /// `sum_v dx_v E_v`.
    pub(super) fn change(&self, dx: &[f64]) -> Symmetric {
        let mut out = Symmetric::zeros(self.constant.size());
        for term in &self.terms {
            term.entries.iter().for_each(|&(i, j, v)| out.add(i, j, v * dx[term.unknown]));
        }
        out
    }

    /// Adds `factor tr(E_v M)` to the entry of each unknown.
    pub(super) fn add_adjoint(&self, m: &Symmetric, factor: f64, out: &mut [f64]) {
        self.terms.iter().for_each(|term| out[term.unknown] += factor * term.inner(m));
    }
}

impl Program {
    /// `A x - b`.
    fn residual(&self, x: &[f64]) -> Vec<f64> {
        self.matrix.times(x).iter().zip(&self.right_side).map(|(a, b)| a - b).collect()
    }

    /// `|A x - b|^2 + c^T x + constant`.
    pub(super) fn smooth_part(&self, x: &[f64]) -> f64 {
        let residual = self.residual(x);
        dot(&residual, &residual) + dot(&self.linear, x) + self.constant
    }

    /// `-(2 A^T (A x - b) + c)`.
    pub(super) fn descent_of_smooth_part(&self, x: &[f64]) -> Vec<f64> {
        let slope = self.matrix.transpose_times(&self.residual(x));
        slope.iter().zip(&self.linear).map(|(a, c)| -2.0 * a - c).collect()
    }

    /// Number of rows of all constraint blocks: the duality gap at barrier weight nu is nu times this.
    pub(super) fn constraint_rows(&self) -> usize {
        self.blocks.iter().filter(|b| b.barrier.weight.is_none()).map(|b| b.constant.size()).sum()
    }
}
