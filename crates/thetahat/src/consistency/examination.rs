use super::{
    elimination::{Elimination, Equality},
    error::ConsistencyError,
    fit::starting_point,
    interior::{Margin, largest_margin, least_violations},
    set::{Condition, ConditionBlock, ConsistentSet},
};
use crate::{base_parameters::BaseParameters, linear_algebra::Matrix};

/// Whether base parameters follow from standard parameters that a robot can have, and if not, why.
#[derive(Debug, Clone, PartialEq)]
pub struct Examination {
    /// The largest t with every condition's matrix at least t times the a-priori one, for some standard parameters with
    /// these base parameters; at most 1. Below zero the base parameters are not consistent.
    pub margin: f64,
    /// Whether the margin is not below zero, but for rounding.
    pub consistent: bool,
    /// The standard parameters that have the margin.
    pub standard: Vec<f64>,
    /// Smallest eigenvalue of all pseudo-inertia matrices of `standard`.
    pub smallest_eigenvalue: f64,
    /// The conditions that no standard parameters with these base parameters meet, as few as possible, and what each
    /// lacks in units of its a-priori matrix; empty for consistent parameters.
    pub outside: Vec<(Condition, f64)>,
    /// `margin = sum_i combination_i theta_i + constant`: a combination of base parameters that every consistent vector
    /// has above zero.
    pub combination: Vec<f64>,
}

/// A margin above this, below zero, is rounding.
const ROUNDING: f64 = -1e-8;
/// What a condition lacks, relative to what all lack, that makes it one of those outside.
const OUTSIDE: f64 = 1e-3;

/// Examines base parameters.
///
/// # Errors
/// [`ConsistencyError`] for a wrong number of values, values that are not finite, and known values that contradict each
/// other or the base parameters.
pub fn examine(set: &ConsistentSet, base: &BaseParameters, estimate: &[f64]) -> Result<Examination, ConsistencyError> {
    if estimate.len() != base.len() {
        let (expected, found) = (base.len(), estimate.len());
        return Err(ConsistencyError::WrongSize { what: "the estimate", expected, found });
    }
    if !estimate.iter().all(|v| v.is_finite()) {
        return Err(ConsistencyError::NotFinite);
    }
    let mut equalities = image(base, estimate);
    let own = equalities.len();
    equalities.extend(set.known().equalities.iter().cloned());
    let elimination = Elimination::new(&equalities, set.scale())?;
    let conditions = conditions_in_unknowns(set, &elimination);
    let start = elimination.unknowns_of(&starting_point(set));
    let best = largest_margin(&conditions, start, f64::INFINITY)?;
    let outside = outside(&conditions, &best)?;
    let combination = combination(set, &elimination, &best, own);
    let standard = elimination.standard(&best.y);
    let eigenvalues = set.pseudo_inertias(&standard);
    let smallest_eigenvalue = eigenvalues.iter().map(|p| p.smallest_eigenvalue()).fold(f64::INFINITY, f64::min);
    let consistent = best.margin >= ROUNDING;
    Ok(Examination { margin: best.margin, consistent, standard, smallest_eigenvalue, outside, combination })
}

impl Examination {
    /// How many standard deviations the combination lies below zero; none for consistent parameters. `covariance` is
    /// the covariance of the base parameters.
    #[must_use]
    pub fn deviations(&self, covariance: &Matrix) -> Option<f64> {
        let spread = covariance.times(&self.combination);
        let variance: f64 = spread.iter().zip(&self.combination).map(|(s, c)| s * c).sum();
        (!self.consistent && variance > 0.0).then(|| -self.margin / variance.sqrt())
    }
}

/// `K theta = theta_b`, one equality for each base parameter.
fn image(base: &BaseParameters, estimate: &[f64]) -> Vec<Equality> {
    let equality = |(parameter, value): (&crate::base_parameters::BaseParameter, &f64)| {
        let own = [(parameter.kept, 1.0)];
        let terms = own.iter().chain(&parameter.regrouped).copied().collect();
        Equality { name: parameter.name.clone(), terms, value: *value }
    };
    base.parameters().iter().zip(estimate).map(equality).collect()
}

fn conditions_in_unknowns(set: &ConsistentSet, elimination: &Elimination) -> Vec<ConditionBlock> {
    let reduced = |c: ConditionBlock| ConditionBlock { block: elimination.block(&c.block), ..c };
    set.conditions().into_iter().map(reduced).collect()
}

fn outside(conditions: &[ConditionBlock], best: &Margin) -> Result<Vec<(Condition, f64)>, ConsistencyError> {
    if best.margin >= ROUNDING {
        return Ok(Vec::new());
    }
    let lacking = least_violations(conditions, &best.y, best.margin)?;
    let all: f64 = lacking.iter().sum();
    let named = conditions.iter().zip(lacking).filter(|(_, lack)| *lack > OUTSIDE * all);
    let mut named: Vec<(Condition, f64)> = named.map(|(c, lack)| (c.condition.clone(), lack)).collect();
    named.sort_by(|a, b| b.1.total_cmp(&a.1));
    Ok(named)
}

/// How the margin depends on each base parameter: `sum_k tr(Z_k dS_k)` over the standard parameters that it moves.
fn combination(set: &ConsistentSet, elimination: &Elimination, best: &Margin, own: usize) -> Vec<f64> {
    let mut slope = vec![0.0; set.scale().len()];
    for (condition, dual) in set.conditions().iter().zip(&best.duals) {
        condition.block.add_adjoint(dual, 1.0, &mut slope);
    }
    (0..own).map(|e| elimination.sensitivity(&slope, e)).collect()
}
