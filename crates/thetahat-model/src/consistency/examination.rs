use super::{
    elimination::{Elimination, Equality},
    error::ConsistencyError,
    fit::starting_point,
    interior::{largest_margin, least_violations},
    program::Block,
    set::{Condition, ConditionBlock, ConsistentSet},
    symmetric::Symmetric,
};
use crate::base_parameters::BaseParameters;
use thetahat_ground::linear_algebra::Matrix;

/// Whether base parameters follow from physically possible standard parameters, and if not, why.
///
/// Only robots of at most [`HEAVIEST`] times the a-priori mass count: some parameters would be consistent only with links of
/// many tons.
#[derive(Debug, Clone, PartialEq)]
pub struct Examination {
    /// For consistent parameters the largest t, at most 1, with every condition's matrix at least t times the a-priori one.
    /// Otherwise minus the minimum total violation, each violation in units of its usual value.
    pub margin: f64,
    /// Whether nothing is violated, except for rounding.
    pub consistent: bool,
    /// Standard parameters with these base parameters that attain the margin.
    pub standard: Vec<f64>,
    /// Smallest eigenvalue of all pseudo-inertia matrices of `standard`, SI.
    pub smallest_eigenvalue: f64,
    /// The conditions violated by all standard parameters with these base parameters, as few as possible, and each violation:
    /// for a parameter in its own unit, for a link the least u in kg m^2 with `P + u 1` positive semidefinite. Empty for
    /// consistent parameters.
    pub outside: Vec<(Condition, f64)>,
    /// `margin = sum_i combination_i theta_i + constant`, to first order: a combination of base parameters that is nonnegative
    /// for every consistent vector.
    pub combination: Vec<f64>,
}

/// Largest ratio of a robot's mass to its a-priori mass.
pub const HEAVIEST: f64 = 100.0;

/// Violations whose sum is below this, in units of usual values, are rounding.
const ROUNDING: f64 = 1e-8;
/// Fraction of the total violation above which a condition counts as violated.
const OUTSIDE: f64 = 1e-3;
/// Duality gap of the total violation, relative to it.
const GAP: f64 = 1e-8;

/// Examines base parameters.
///
/// # Errors
/// [`ConsistencyError`] for a wrong number of values and values that are not finite. Known values that contradict the base
/// parameters or each other are left out.
pub fn examine(set: &ConsistentSet, base: &BaseParameters, estimate: &[f64]) -> Result<Examination, ConsistencyError> {
    examine_within(set, base, estimate, GAP)
}

/// [`examine`] with a duality gap relative to the violation: 1e-3 is enough to name the violated conditions, and takes half the
/// time.
///
/// # Errors
/// As [`examine`].
pub fn examine_within(
    set: &ConsistentSet,
    base: &BaseParameters,
    estimate: &[f64],
    gap: f64,
) -> Result<Examination, ConsistencyError> {
    if estimate.len() != base.len() {
        let (expected, found) = (base.len(), estimate.len());
        return Err(ConsistencyError::WrongSize { what: "the estimate", expected, found });
    }
    if !estimate.iter().all(|v| v.is_finite()) {
        return Err(ConsistencyError::NotFinite);
    }
    Fibre::new(set, base, estimate)?.examine(gap)
}

/// The standard parameters with given base parameters, as a function of the remaining unknowns.
struct Fibre<'a> {
    set: &'a ConsistentSet,
    elimination: Elimination,
    conditions: Vec<ConditionBlock>,
    heaviest: Block,
    /// The limit of the mass in the unknowns, if the start satisfies it.
    limits: Vec<Block>,
    start: Vec<f64>,
    base: usize,
}

impl<'a> Fibre<'a> {
    fn new(set: &'a ConsistentSet, base: &BaseParameters, estimate: &[f64]) -> Result<Self, ConsistencyError> {
        let mut equalities = image(base, estimate);
        equalities.extend(set.known().equalities.iter().cloned());
        // A free estimate contradicts fixed values on which it alone depends, for example one friction coefficient.
        let elimination = Elimination::with(&equalities, set.scale(), base.len())?;
        let reduced = |c: ConditionBlock| ConditionBlock { block: elimination.block(&c.block), ..c };
        let conditions = set.conditions().into_iter().map(reduced).collect();
        let start = elimination.unknowns_of(&starting_point(set));
        let heaviest = set.mass_limit(HEAVIEST);
        let limit = elimination.block(&heaviest);
        let holds = !limit.terms.is_empty() && limit.value(&start).at(0, 0) > 0.0;
        let limits = if holds { vec![limit] } else { Vec::new() };
        Ok(Self { set, elimination, conditions, heaviest, limits, start, base: base.len() })
    }

    fn examine(&self, gap: f64) -> Result<Examination, ConsistencyError> {
        let unit = self.set.usual_moment();
        let even: Vec<ConditionBlock> = self.conditions.iter().map(|c| c.with_even_reference(unit)).collect();
        let found = least_violations(&even, &self.limits, &self.start, gap)?;
        let sum: f64 = found.lacking.iter().sum();
        if sum < ROUNDING {
            let best = largest_margin(&self.conditions, &self.limits, found.y, f64::INFINITY)?;
            return Ok(self.examination(best.margin.max(0.0), &best.y, &best.duals, Vec::new()));
        }
        let named = even.iter().zip(&found.lacking).filter(|(_, lack)| **lack > OUTSIDE * sum);
        let mut named: Vec<(&ConditionBlock, f64)> = named.map(|(c, lack)| (c, *lack)).collect();
        named.sort_by(|a, b| b.1.total_cmp(&a.1));
        let outside = named.into_iter().map(|(c, lack)| (c.condition.clone(), lack * c.reference.at(0, 0))).collect();
        Ok(self.examination(-sum, &found.y, &found.duals, outside))
    }

    fn examination(&self, margin: f64, y: &[f64], duals: &[Symmetric], outside: Vec<(Condition, f64)>) -> Examination {
        let standard = self.elimination.standard(y);
        let eigenvalues = self.set.pseudo_inertias(&standard);
        let smallest_eigenvalue = eigenvalues.iter().map(Symmetric::smallest_eigenvalue).fold(f64::INFINITY, f64::min);
        let (consistent, combination) = (outside.is_empty(), self.combination(duals));
        Examination { margin, consistent, standard, smallest_eigenvalue, outside, combination }
    }

    /// The derivatives of the margin with respect to each base parameter: `sum_k tr(Z_k dS_k)` over the standard parameters
    /// that it moves.
    fn combination(&self, duals: &[Symmetric]) -> Vec<f64> {
        let mut slope = vec![0.0; self.set.scale().len()];
        let conditions = self.set.conditions().into_iter().map(|c| c.block);
        for (block, dual) in conditions.chain([self.heaviest.clone()]).zip(duals) {
            block.add_adjoint(dual, 1.0, &mut slope);
        }
        (0..self.base).map(|e| self.elimination.sensitivity(&slope, e)).collect()
    }
}

impl Examination {
    /// Number of standard deviations by which the combination is below zero; none for consistent parameters. `covariance` is
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
