//! A primal-dual interior-point method for [`Program`], with steps controlled on the barrier function.
//!
//! For a weight nu the barrier function is `phi(x) = |A x - b|^2 + c^T x + sum_k w_k D_k(S_k(x))`, with `w_k = nu` for
//! constraints and the kept weight elsewhere. Every iterate lies strictly inside. A step solves
//! `(2 A^T A + sum_k E_k^*(Z_k E_k S_k^-1)) dx = -grad phi`: Newton's method for `S_k Z_k = w_k I`, made symmetric as by
//! Helmberg, Rendl, Vanderbei and Wolkowicz (1996). The matrix is positive definite for any definite `Z_k`, so dx descends
//! on phi, and backtracking makes phi fall at every step. When steps get short, `Z_k = w_k S_k^-1` is used, which is Newton's
//! method on phi. nu falls when the Newton decrement shows that the path is near (Boyd and Vandenberghe, *Convex
//! Optimization*, chapter 11); at the end the duality gap is nu times the rows of the constraints.

use super::{
    program::{Block, Program},
    symmetric::{Cholesky, Symmetric},
};
use thetahat_ground::linear_algebra::{CholeskyFactor, Matrix, dot, norm};

/// When the iteration ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stop {
    /// Duality gap relative to the objective.
    pub(super) relative_gap: f64,
    /// Duality gap that is small enough for any objective.
    pub(super) absolute_gap: f64,
    /// An objective that is low enough.
    pub(super) objective: f64,
}

/// The result of the iteration.
#[derive(Debug, Clone)]
pub(super) struct Minimum {
    pub(super) x: Vec<f64>,
    /// The objective without barriers of constraints.
    pub(super) objective: f64,
    /// Upper bound of the distance to the least objective.
    pub(super) gap: f64,
    /// The multiplier of each block.
    pub(super) duals: Vec<Symmetric>,
    pub(super) iterations: usize,
    /// Whether the gap is as small as requested, or the objective low enough.
    pub(super) converged: bool,
    /// Newton's matrix at the end: half of it is the curvature of the objective in the free directions.
    pub(super) system: Option<ScaledSystem>,
}

/// Iterations after which the method gives up; 15 to 40 are usual.
const MOST_ITERATIONS: usize = 300;
/// Factor of the barrier weight from one point of the path to the next.
const WEIGHT_FACTOR: f64 = 0.1;
/// Squared Newton decrement, over the barrier weight, below which a point counts as on the path.
const NEAR_PATH: f64 = 10.0;
/// Squared Newton decrement, over the duality gap, below which the last point counts as on the path.
const AT_END: f64 = 0.1;
/// Fraction of the way to the boundary that a step may take.
const TO_BOUNDARY: f64 = 0.95;
/// Fraction of the descent predicted by the slope that a step must achieve.
const SUFFICIENT: f64 = 1e-4;
/// Fraction of the plain step's slope that the corrected one must keep.
const STILL_DOWN: f64 = 0.1;
/// A step shorter than this is short: the multipliers are recomputed.
const SHORT: f64 = 0.1;
/// A step shorter than this counts as zero.
const NO_STEP: f64 = 1e-12;
/// Relative changes of the barrier function below this are rounding.
const ROUNDING: f64 = 1e-13;

/// A block at the current point.
struct Slack {
    s: Symmetric,
    factor: Cholesky,
    inverse: Symmetric,
    dual: Symmetric,
}

struct Iterate<'a> {
    program: &'a Program,
    quadratic: Matrix,
    x: Vec<f64>,
    slacks: Vec<Slack>,
    weight: f64,
}

/// A Newton direction at weight nu is `fixed + nu varying`, and so is its slope.
struct Directions {
    system: ScaledSystem,
    fixed: [Vec<f64>; 2],
    varying: [Vec<f64>; 2],
}

/// Minimises a program from a point strictly inside; none if the point is not inside.
pub(super) fn minimise(program: &Program, start: Vec<f64>, stop: &Stop) -> Option<Minimum> {
    let mut iterate = Iterate::new(program, start)?;
    let rows = program.constraint_rows().max(1) as f64;
    let mut iterations = 0;
    loop {
        let objective = iterate.objective();
        let last = (stop.relative_gap * objective.abs()).max(stop.absolute_gap) / rows;
        let Some(directions) = iterate.directions() else {
            return Some(iterate.finish(None, objective, f64::INFINITY, iterations, objective <= stop.objective));
        };
        while iterate.weight > last && directions.decrement(iterate.weight) <= NEAR_PATH * iterate.weight {
            iterate.weight = (WEIGHT_FACTOR * iterate.weight).max(last);
        }
        let decrement = directions.decrement(iterate.weight);
        let gap = iterate.weight * rows + decrement.max(0.0);
        let at_end = iterate.weight <= last * (1.0 + 1e-9) && decrement <= AT_END * iterate.weight * rows;
        if objective <= stop.objective || at_end || iterations == MOST_ITERATIONS {
            iterate.settle_duals(&directions);
            let converged = objective <= stop.objective || at_end;
            return Some(iterate.finish(Some(directions.system), objective, gap, iterations, converged));
        }
        iterations += 1;
        if !iterate.step(&directions) {
            let converged = gap <= 1e3 * last * rows;
            return Some(iterate.finish(Some(directions.system), objective, gap, iterations, converged));
        }
    }
}

/// Newton's matrix of the objective at a point strictly inside, with the divergences that keep their weight and no other.
pub(super) fn curvature(program: &Program, x: Vec<f64>) -> Option<Matrix> {
    let mut iterate = Iterate::new(program, x)?;
    iterate.weight = 0.0;
    iterate.renew_duals();
    let mut matrix = iterate.quadratic.clone();
    iterate.blocks().for_each(|(block, slack)| slack.add_curvature(block, &mut matrix));
    Some(matrix)
}

/// A step of the unknowns, with the changes of blocks and multipliers.
struct Step {
    dx: Vec<f64>,
    changes: Vec<Symmetric>,
    dual_changes: Vec<Symmetric>,
    /// The largest fraction of the step that may be taken.
    limit: f64,
}

impl Directions {
    fn at(&self, weight: f64) -> Vec<f64> {
        self.fixed[1].iter().zip(&self.varying[1]).map(|(f, v)| f + weight * v).collect()
    }

    /// `-grad phi`.
    fn slope(&self, weight: f64) -> Vec<f64> {
        self.fixed[0].iter().zip(&self.varying[0]).map(|(f, v)| f + weight * v).collect()
    }

    /// Slope times direction: the squared Newton decrement.
    fn decrement(&self, weight: f64) -> f64 {
        dot(&self.slope(weight), &self.at(weight))
    }
}

impl<'a> Iterate<'a> {
    fn new(program: &'a Program, x: Vec<f64>) -> Option<Self> {
        let quadratic = program.matrix.transposed_times(&program.matrix);
        let quadratic = quadratic.plus(&quadratic, 1.0);
        let values = program.blocks.iter().map(|block| (block, block.value(&x)));
        let slacks: Vec<Slack> = values.map(|(_, s)| Slack::new(s)).collect::<Option<_>>()?;
        let mut iterate = Self { program, quadratic, x, slacks, weight: 0.0 };
        let rows = program.constraint_rows().max(1) as f64;
        iterate.weight = (iterate.objective() / rows).max(f64::MIN_POSITIVE);
        iterate.renew_duals();
        Some(iterate)
    }

    fn blocks(&self) -> impl Iterator<Item = (&Block, &Slack)> {
        self.program.blocks.iter().zip(&self.slacks)
    }

    fn renew_duals(&mut self) {
        for (block, slack) in self.program.blocks.iter().zip(&mut self.slacks) {
            slack.dual = slack.inverse.times(block.barrier.weight_at(self.weight));
        }
    }

    /// The multipliers of the full Newton step, which balance the slope of the smooth part at its end.
    fn settle_duals(&mut self, directions: &Directions) {
        let step = self.towards(directions.at(self.weight), None);
        let settled = self.slacks.iter().zip(&step.dual_changes).map(|(slack, dz)| slack.dual.plus(dz, 1.0));
        let settled: Vec<Symmetric> = settled.collect();
        if settled.iter().all(|dual| dual.cholesky().is_some()) {
            self.slacks.iter_mut().zip(settled).for_each(|(slack, dual)| slack.dual = dual);
        }
    }

    /// The objective with the kept divergences.
    fn objective(&self) -> f64 {
        let kept = self.blocks().filter_map(|(block, slack)| {
            block.barrier.weight.map(|weight| weight * block.barrier.divergence(&slack.s, &slack.factor))
        });
        self.program.smooth_part(&self.x) + kept.sum::<f64>()
    }

    /// The barrier function at `x`; none outside.
    fn barrier_function(&self, x: &[f64]) -> Option<f64> {
        let mut sum = self.program.smooth_part(x);
        for block in &self.program.blocks {
            let s = block.value(x);
            sum += block.barrier.weight_at(self.weight) * block.barrier.divergence(&s, &s.cholesky()?);
        }
        Some(sum)
    }

    /// Newton's matrix, and the slopes `-grad phi = fixed + nu varying` with their directions.
    fn directions(&self) -> Option<Directions> {
        let mut matrix = self.quadratic.clone();
        let mut fixed = self.program.descent_of_smooth_part(&self.x);
        let mut varying = vec![0.0; fixed.len()];
        for (block, slack) in self.blocks() {
            slack.add_curvature(block, &mut matrix);
            let pull = slack.inverse.plus(&block.barrier.slope, -1.0);
            match block.barrier.weight {
                Some(weight) => block.add_adjoint(&pull, weight, &mut fixed),
                None => block.add_adjoint(&pull, 1.0, &mut varying),
            }
        }
        let system = ScaledSystem::new(&matrix)?;
        let (a, b) = (system.solve(&fixed)?, system.solve(&varying)?);
        Some(Directions { system, fixed: [fixed, a], varying: [varying, b] })
    }

    /// Takes the longest part of the step that stays inside and descends; false if there is none.
    ///
    /// The second-order correction of Mehrotra (1992) is tried first.
    fn step(&mut self, directions: &Directions) -> bool {
        let slope = directions.slope(self.weight);
        let plain = self.towards(directions.at(self.weight), None);
        let enough = STILL_DOWN * dot(&slope, &plain.dx);
        let better = |step: &Step| step.limit > plain.limit && dot(&slope, &step.dx) > enough;
        let corrected = self.corrected(directions, &plain).filter(better);
        let taken = corrected.as_ref().is_some_and(|step| self.take(step, &slope));
        taken || self.take(&plain, &slope)
    }

    /// A step with the resulting changes of blocks and multipliers.
    fn towards(&self, dx: Vec<f64>, second_order: Option<&[Symmetric]>) -> Step {
        let changes: Vec<Symmetric> = self.program.blocks.iter().map(|block| block.change(&dx)).collect();
        let nearest = self.slacks.iter().zip(&changes).map(|(slack, ds)| slack.factor.smallest_ratio(ds));
        let limit = step_inside(nearest.fold(0.0, f64::min));
        let weights = self.program.blocks.iter().map(|block| block.barrier.weight_at(self.weight));
        let blocks = self.slacks.iter().zip(&changes).zip(weights).enumerate();
        let of_dual = |(k, ((slack, ds), weight)): (usize, ((&Slack, &Symmetric), f64))| {
            let change = slack.change_of_dual(weight, ds);
            second_order.map_or(change.clone(), |terms| change.plus(&terms[k], -1.0))
        };
        Step { dual_changes: blocks.map(of_dual).collect(), dx, changes, limit }
    }

    /// The step with the products of changes, `sym(dZ dS S^-1)`, that the plain step neglects.
    fn corrected(&self, directions: &Directions, plain: &Step) -> Option<Step> {
        let product =
            |((slack, ds), dz): ((&Slack, &Symmetric), &Symmetric)| Symmetric::between(dz, ds, &slack.inverse);
        let terms: Vec<Symmetric> =
            self.slacks.iter().zip(&plain.changes).zip(&plain.dual_changes).map(product).collect();
        let mut slope = directions.slope(self.weight);
        self.program.blocks.iter().zip(&terms).for_each(|(block, term)| block.add_adjoint(term, -1.0, &mut slope));
        let dx = directions.system.solve(&slope)?;
        Some(self.towards(dx, Some(&terms)))
    }

    /// Takes a step if it descends.
    fn take(&mut self, step: &Step, slope: &[f64]) -> bool {
        let descent = dot(slope, &step.dx);
        let Some(length) = self.backtrack(&step.dx, descent, step.limit) else { return false };
        let x: Vec<f64> = self.x.iter().zip(&step.dx).map(|(x, d)| x + length * d).collect();
        let values = self.program.blocks.iter().map(|block| Slack::new(block.value(&x)));
        let Some(mut slacks) = values.collect::<Option<Vec<_>>>() else { return false };
        for ((old, new), dz) in self.slacks.iter().zip(&mut slacks).zip(&step.dual_changes) {
            new.dual = old.next_dual(dz);
        }
        (self.x, self.slacks) = (x, slacks);
        if length < SHORT {
            self.renew_duals();
        }
        true
    }

    fn backtrack(&self, dx: &[f64], decrement: f64, limit: f64) -> Option<f64> {
        let here = self.barrier_function(&self.x)?;
        let mut length = limit;
        while length > NO_STEP {
            let x: Vec<f64> = self.x.iter().zip(dx).map(|(x, d)| x + length * d).collect();
            let bound = here - SUFFICIENT * length * decrement + ROUNDING * here.abs();
            if self.barrier_function(&x).is_some_and(|there| there <= bound) {
                return Some(length);
            }
            length *= 0.5;
        }
        None
    }

    fn finish(
        self,
        system: Option<ScaledSystem>,
        objective: f64,
        gap: f64,
        iterations: usize,
        converged: bool,
    ) -> Minimum {
        let duals = self.slacks.into_iter().map(|slack| slack.dual).collect();
        Minimum { x: self.x, objective, gap, duals, iterations, converged, system }
    }
}

/// The length of a step that keeps a distance from the boundary, from the smallest eigenvalue of the relative change.
fn step_inside(smallest_ratio: f64) -> f64 {
    if smallest_ratio < 0.0 { (TO_BOUNDARY / -smallest_ratio).min(1.0) } else { 1.0 }
}

impl Slack {
    fn new(s: Symmetric) -> Option<Self> {
        let factor = s.cholesky()?;
        let inverse = factor.inverse();
        Some(Self { dual: Symmetric::zeros(s.size()), s, factor, inverse })
    }

    /// Adds `tr(E_v Z E_w S^-1)` for every two unknowns of the block.
    fn add_curvature(&self, block: &Block, matrix: &mut Matrix) {
        for (place, w) in block.terms.iter().enumerate() {
            let m = Symmetric::around(&self.dual, &w.entries, &self.inverse);
            for v in &block.terms[..=place] {
                let value = v.inner(&m);
                *matrix.at_mut(v.unknown, w.unknown) += value;
                if v.unknown != w.unknown {
                    *matrix.at_mut(w.unknown, v.unknown) += value;
                }
            }
        }
    }

    /// The change of the multiplier with a step that changes the block by `ds`: `w S^-1 - Z - sym(Z dS S^-1)`.
    fn change_of_dual(&self, weight: f64, ds: &Symmetric) -> Symmetric {
        let target = self.inverse.times(weight).plus(&Symmetric::between(&self.dual, ds, &self.inverse), -1.0);
        target.plus(&self.dual, -1.0)
    }

    /// The multiplier after its change, shortened so that it stays definite.
    fn next_dual(&self, change: &Symmetric) -> Symmetric {
        let Some(factor) = self.dual.cholesky() else { return self.dual.clone() };
        self.dual.plus(change, step_inside(factor.smallest_ratio(change)))
    }
}

/// A positive semidefinite system scaled to a unit diagonal, factorised.
///
/// The smallest multiple of the identity that lets the factorisation succeed is added: it shortens the step in directions that
/// nothing determines.
#[derive(Debug, Clone)]
pub(super) struct ScaledSystem {
    factor: CholeskyFactor,
    scale: Vec<f64>,
}

impl ScaledSystem {
    pub(super) fn new(matrix: &Matrix) -> Option<Self> {
        let n = matrix.rows();
        let size = |i: usize| matrix.at(i, i).sqrt();
        let scale: Vec<f64> = (0..n).map(|i| if size(i) > 0.0 { 1.0 / size(i) } else { 1.0 }).collect();
        let mut added = 1e-14;
        while added < 1.0 {
            let entry = |i: usize, j: usize| scale[i] * scale[j] * matrix.at(i, j) + if i == j { added } else { 0.0 };
            if let Some(factor) = Matrix::from_fn(n, n, entry).cholesky() {
                return Some(Self { factor, scale });
            }
            added *= 100.0;
        }
        None
    }

    /// None if the right side is not finite.
    pub(super) fn solve(&self, right: &[f64]) -> Option<Vec<f64>> {
        let scaled = |x: &[f64]| x.iter().zip(&self.scale).map(|(x, s)| x * s).collect::<Vec<f64>>();
        let right = scaled(right);
        norm(&right).is_finite().then(|| scaled(&self.factor.solve(&right)))
    }
}
