//! The banded least squares of one step of a fit.

use super::{envelope::Envelope, local_column::LocalColumn};

/// Unknowns of a time law.
pub(super) const UNKNOWNS: usize = 4;

/// Unknowns that belong to a law or a point, in the order of time.
pub(super) struct Block<'a> {
    pub columns: &'a [LocalColumn],
    pub unknowns: Vec<Unknown>,
    /// Whether they are those of a law, which are damped and wanted.
    pub is_law: bool,
}

/// An unknown: the derivative of joint j is a column times a factor.
pub(super) struct Unknown {
    /// Which column of the block.
    pub column: usize,
    /// One factor for each joint, times the joint's weight.
    pub factors: Vec<f64>,
    /// Product of the derivatives and the weighted residual.
    pub gradient: f64,
}

impl<'a> Block<'a> {
    /// The unknowns of a point, one for each joint. The residual of the best points has no part along them.
    pub fn of_point(column: &'a LocalColumn, weights: &[f64]) -> Self {
        let factors = |j: usize| (0..weights.len()).map(|i| if i == j { weights[j] } else { 0.0 }).collect();
        let unknown = |j: usize| Unknown { column: 0, factors: factors(j), gradient: 0.0 };
        let unknowns = (0..weights.len()).map(unknown).collect();
        Self { columns: std::slice::from_ref(column), unknowns, is_law: false }
    }

    fn start(&self) -> usize {
        self.columns.iter().map(|c| c.stretch().start).min().unwrap_or(0)
    }

    fn end(&self) -> usize {
        self.columns.iter().map(|c| c.stretch().end).max().unwrap_or(0)
    }

    /// Adds the products with the unknowns of another block; the blocks' unknowns begin at `at`.
    fn add_products(&self, other: &Self, at: [usize; 2], normal: &mut Envelope) {
        let products: Vec<Vec<f64>> =
            self.columns.iter().map(|a| other.columns.iter().map(|b| a.dot(b)).collect()).collect();
        for (i, a) in self.unknowns.iter().enumerate() {
            let lower = if at[0] == at[1] { i + 1 } else { other.unknowns.len() };
            for (j, b) in other.unknowns[..lower].iter().enumerate() {
                let joints: f64 = a.factors.iter().zip(&b.factors).map(|(a, b)| a * b).sum();
                normal.add(at[0] + i, at[1] + j, joints * products[a.column][b.column]);
            }
        }
    }
}

/// The normal equations of a step.
pub(super) struct LinearStep {
    normal: Envelope,
    gradient: Vec<f64>,
    /// The first unknown of each law.
    laws: Vec<usize>,
}

/// The normal equations of blocks in the order of time.
pub(super) fn normal_equations(blocks: &[Block]) -> LinearStep {
    let mut first = vec![0];
    blocks.iter().for_each(|block| first.push(first[first.len() - 1] + block.unknowns.len()));
    let mut normal = Envelope::zeros(first[blocks.len()]);
    let mut latest_end = Vec::with_capacity(blocks.len());
    for (i, block) in blocks.iter().enumerate() {
        latest_end.push(latest_end.last().copied().unwrap_or(0).max(block.end()));
        let common = (0..=i).rev().take_while(|&j| j == i || latest_end[j] > block.start());
        common.for_each(|j| block.add_products(&blocks[j], [first[i], first[j]], &mut normal));
    }
    let gradient = blocks.iter().flat_map(|block| block.unknowns.iter().map(|u| u.gradient)).collect();
    let laws = (0..blocks.len()).filter(|&i| blocks[i].is_law).map(|i| first[i]).collect();
    LinearStep { normal, gradient, laws }
}

impl LinearStep {
    /// The step of the laws' unknowns, damped by `damping` times the squared norm of each one's derivatives.
    pub fn solve(&self, damping: f64) -> Vec<f64> {
        let mut damped = self.normal.clone();
        let unknowns = || self.laws.iter().flat_map(|&first| first..first + UNKNOWNS);
        unknowns().for_each(|i| damped.add(i, i, damping * self.normal.diagonal(i)));
        let step = damped.factor().solve(self.gradient.clone());
        unknowns().map(|i| step[i]).collect()
    }
}
