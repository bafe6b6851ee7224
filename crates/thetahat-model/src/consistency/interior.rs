//! A point strictly inside all conditions, or the proof that none exists.

use super::{
    error::ConsistencyError,
    interior_point::{Minimum, Stop, minimise},
    program::{Block, Program},
    set::ConditionBlock,
    symmetric::Symmetric,
};
use thetahat_ground::linear_algebra::Matrix;

/// The largest margin t, at most one, with `S_k(y) - t S_k_ref` positive semidefinite for all k.
pub(super) struct Margin {
    pub(super) margin: f64,
    pub(super) y: Vec<f64>,
    /// The multipliers of the conditions and limits; `sum_k tr(Z_k S_k_ref) = 1` where the margin is below one.
    pub(super) duals: Vec<Symmetric>,
}

/// A margin that is enough to start from.
const ENOUGH: f64 = 0.05;
/// A margin that counts as zero.
const NONE: f64 = 1e-8;
/// Gap of a margin, in units of the a-priori parameters.
const GAP: f64 = 1e-10;
/// Fraction of the largest violation that is added to each condition's own at the start.
const OFF_BOUNDARY: f64 = 0.1;
/// Fraction of all multipliers above which a condition is in conflict.
const IN_CONFLICT: f64 = 0.01;

/// A point strictly inside: `start` itself if it is inside.
pub(super) fn inside(conditions: &[ConditionBlock], start: Vec<f64>) -> Result<Vec<f64>, ConsistencyError> {
    if margin_of(conditions, &start) > NONE {
        return Ok(start);
    }
    let found = largest_margin(conditions, &[], start, ENOUGH)?;
    if found.margin > NONE {
        return Ok(found.y);
    }
    let share = |(c, dual): &(&ConditionBlock, &Symmetric)| dual.inner(&c.reference) > IN_CONFLICT;
    let conflicting = conditions.iter().zip(&found.duals).filter(share).map(|(c, _)| c.condition.to_string()).collect();
    Err(ConsistencyError::NoInterior { margin: found.margin, conflicting })
}

/// The largest t with `S_k - t S_k_ref` positive semidefinite at this point.
pub(super) fn margin_of(conditions: &[ConditionBlock], y: &[f64]) -> f64 {
    conditions.iter().map(|c| c.margin(y)).fold(f64::INFINITY, f64::min)
}

/// The largest margin, or one that is `enough`. `limits` hold without a margin.
pub(super) fn largest_margin(
    conditions: &[ConditionBlock],
    limits: &[Block],
    y: Vec<f64>,
    enough: f64,
) -> Result<Margin, ConsistencyError> {
    let unknowns = y.len();
    let here = margin_of(conditions, &y).min(1.0);
    if !here.is_finite() {
        return Err(ConsistencyError::NotSolved);
    }
    let shifted = conditions.iter().map(|c| c.shifted(unknowns, -1.0));
    let mut blocks: Vec<Block> = shifted.chain(limits.iter().cloned()).collect();
    blocks.push(Block::scalar(1.0, unknowns, -1.0));
    let mut linear = vec![0.0; unknowns + 1];
    linear[unknowns] = -1.0;
    let matrix = Matrix::zeros(1, unknowns + 1);
    let program = Program { matrix, right_side: vec![0.0], linear, constant: 1.0, blocks };
    let stop = Stop { relative_gap: GAP, absolute_gap: GAP, objective: 1.0 - enough };
    let start = y.into_iter().chain([here - here.abs().max(1.0)]).collect();
    let Some(Minimum { mut x, mut duals, .. }) = minimise(&program, start, &stop) else {
        return Err(ConsistencyError::NotSolved);
    };
    duals.truncate(conditions.len() + limits.len());
    let margin = x.pop().unwrap_or(f64::NEG_INFINITY);
    Ok(Margin { margin, y: x, duals })
}

/// The violations of the conditions, each in units of its reference, where their sum is least.
pub(super) struct Violations {
    pub(super) lacking: Vec<f64>,
    pub(super) y: Vec<f64>,
    /// The multipliers of the conditions and limits.
    pub(super) duals: Vec<Symmetric>,
}

/// The least violations, from any point; `limits` hold without violation. `gap` is relative to their sum.
pub(super) fn least_violations(
    conditions: &[ConditionBlock],
    limits: &[Block],
    y: &[f64],
    gap: f64,
) -> Result<Violations, ConsistencyError> {
    let (unknowns, many) = (y.len(), conditions.len());
    let shifted = conditions.iter().enumerate().map(|(k, c)| c.shifted(unknowns + k, 1.0));
    let bounds = (0..many).map(|k| Block::scalar(0.0, unknowns + k, 1.0));
    let linear = (0..unknowns + many).map(|i| if i < unknowns { 0.0 } else { 1.0 }).collect();
    let matrix = Matrix::zeros(1, unknowns + many);
    let blocks = shifted.chain(limits.iter().cloned()).chain(bounds).collect();
    let program = Program { matrix, right_side: vec![0.0], linear, constant: 0.0, blocks };
    // More than the point's violation, to keep the start off the boundary.
    let least: Vec<f64> = conditions.iter().map(|c| (-c.margin(y)).max(0.0)).collect();
    let some = OFF_BOUNDARY * least.iter().fold(1.0, |a: f64, b| a.max(*b));
    let start = y.iter().copied().chain(least.iter().map(|l| 1.5 * l + some)).collect();
    let stop = Stop { relative_gap: gap, absolute_gap: GAP, objective: f64::NEG_INFINITY };
    let Minimum { x, mut duals, .. } = minimise(&program, start, &stop).ok_or(ConsistencyError::NotSolved)?;
    duals.truncate(many + limits.len());
    let (y, lacking) = x.split_at(unknowns);
    Ok(Violations { lacking: lacking.to_vec(), y: y.to_vec(), duals })
}
