//! Positions of passive joints from those of the robot's coordinates.

use crate::dynamics::{
    model::{ClosedTree, DynamicsError},
    workspace::LoopScratch,
};
use thetahat_ground::linear_algebra::norm;

/// Largest step of the coordinates on the way to a position, rad or m, and the least one before the way is given up.
const LONGEST_STEP: f64 = 0.4;
const SHORTEST_STEP: f64 = 1e-4;
/// Longest way that is followed, rad or m: 160 turns.
const LONGEST_WAY: f64 = 1e3;
/// Largest correction of a predicted position that is taken for the same branch, rad or m.
const SAME_BRANCH: f64 = 0.3;
/// Newton steps of a position on the way and at its end.
const MOST_NEWTON_STEPS: usize = 12;
/// Largest Newton step at which a position on the way is near enough, rad or m.
const NEAR: f64 = 1e-3;
/// Largest Newton step after which one more step leaves rounding: Newton steps fall as their squares.
const LAST: f64 = 1e-7;
/// Newton steps that close the loops first, and the longest of them.
const FIRST_STEPS: usize = 200;
const LONGEST_FIRST_STEP: f64 = 0.2;
/// Largest gap that the rounding of a description explains, m.
const GAP: f64 = 1e-4;
/// Part of a column of `J_a` that `J_p` does not explain, above which the conditions hold a driven joint as well.
const HELD: f64 = 1e-3;

impl ClosedTree {
    /// Closes the loops near the positions that the description states.
    pub(super) fn close_first(&self, scratch: &mut LoopScratch) -> Result<(), DynamicsError> {
        if self.equations < self.passive.len() {
            return Err(DynamicsError::LoopConditions { equations: self.equations, passive: self.passive.len() });
        }
        scratch.q.copy_from_slice(&self.reference);
        for _ in 0..FIRST_STEPS {
            let length = self.newton_step(scratch, LONGEST_FIRST_STEP)?;
            if length < LAST {
                break;
            }
        }
        self.newton_step(scratch, LONGEST_FIRST_STEP)?;
        self.linearise(scratch);
        let (of_loop, gap) = self.largest_gap(scratch);
        if gap.is_nan() || gap > GAP {
            return Err(DynamicsError::LoopOpen { number: of_loop + 1, gap });
        }
        self.refuse_held(scratch)?;
        self.update_slopes(scratch)
    }

    /// Refuses conditions that hold a driven joint.
    fn refuse_held(&self, scratch: &mut LoopScratch) -> Result<(), DynamicsError> {
        let n = self.tree.coordinate_count();
        self.factor(scratch).map_err(|c| self.singular(c))?;
        let longest = norm(&scratch.jacobian);
        for &c in &self.independent {
            (0..self.equations).for_each(|row| scratch.rest[row] = scratch.jacobian[row * n + c]);
            self.solve(scratch);
            if norm(&scratch.rest) > HELD * longest {
                return Err(DynamicsError::LoopHolds { joint: self.joint_number(c) });
            }
        }
        Ok(())
    }

    fn singular(&self, coordinate: usize) -> DynamicsError {
        DynamicsError::LoopSingular { joint: self.joint_number(coordinate) }
    }

    /// One Newton step of the passive joints, no longer than `longest`; returns its length.
    fn newton_step(&self, scratch: &mut LoopScratch, longest: f64) -> Result<f64, DynamicsError> {
        self.linearise(scratch);
        self.factor(scratch).map_err(|c| self.singular(c))?;
        scratch.rest.copy_from_slice(&scratch.gaps);
        self.solve(scratch);
        let length = scratch.solved.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let factor = if length > longest { longest / length } else { 1.0 };
        self.passive.iter().zip(&scratch.solved).for_each(|(&c, x)| scratch.q[c] -= factor * x);
        Ok(length)
    }

    /// Writes the positions of all joints at the coordinates `q`, and `G` there, to the scratch.
    ///
    /// # Errors
    /// The joint at which the loops cannot be followed from where the description closes them.
    pub(super) fn place(&self, q: &[f64], scratch: &mut LoopScratch) -> Result<(), DynamicsError> {
        self.problem().map_or(Ok(()), |problem| Err(problem.clone()))?;
        scratch.q.copy_from_slice(&self.reference);
        let way = |i: usize| q[i] - self.reference[self.independent[i]];
        let length = (0..q.len()).map(|i| way(i).abs()).fold(0.0, f64::max);
        if length.is_nan() || length > LONGEST_WAY {
            return Err(self.singular(self.passive[0]));
        }
        let (mut done, mut step) = (0.0, (LONGEST_STEP / length).min(1.0));
        scratch.slopes.copy_from_slice(&self.slopes_near);
        while done < 1.0 {
            let next = if done + step > 1.0 - 1e-9 { 1.0 } else { done + step };
            scratch.before.copy_from_slice(&scratch.q);
            match self.advance(q, [done, next], scratch) {
                Ok(()) => {
                    done = next;
                    step = (1.5 * step).min(LONGEST_STEP / length);
                }
                Err(error) => {
                    scratch.q.copy_from_slice(&scratch.before);
                    self.linearise(scratch);
                    self.update_slopes(scratch)?;
                    step /= 2.0;
                    if step * length < SHORTEST_STEP {
                        return Err(error);
                    }
                }
            }
        }
        Ok(())
    }

    /// Follows the loops from one part of the way to the next, and updates `G`.
    fn advance(&self, q: &[f64], [done, next]: [f64; 2], scratch: &mut LoopScratch) -> Result<(), DynamicsError> {
        let own = q.len();
        let way = |i: usize| q[i] - self.reference[self.independent[i]];
        for &c in &self.passive {
            let predicted: f64 = (0..own).map(|i| scratch.slopes[c * own + i] * way(i)).sum();
            scratch.q[c] += (next - done) * predicted;
        }
        for (i, &c) in self.independent.iter().enumerate() {
            scratch.q[c] = if next < 1.0 { self.reference[c] + next * way(i) } else { q[i] };
        }
        let (mut corrected, enough) = (0.0, if next < 1.0 { NEAR } else { LAST });
        for _ in 0..MOST_NEWTON_STEPS {
            let length = self.newton_step(scratch, SAME_BRANCH)?;
            corrected += length;
            if corrected.is_nan() || corrected > SAME_BRANCH {
                return Err(self.singular(self.passive[0]));
            }
            if length < enough {
                self.newton_step(scratch, SAME_BRANCH)?;
                self.linearise(scratch);
                return self.update_slopes(scratch);
            }
        }
        Err(self.singular(self.passive[0]))
    }

    /// `G` from the Jacobian of the scratch.
    fn update_slopes(&self, scratch: &mut LoopScratch) -> Result<(), DynamicsError> {
        let (n, own) = (self.tree.coordinate_count(), self.independent.len());
        self.factor(scratch).map_err(|c| self.singular(c))?;
        for (i, &column) in self.independent.iter().enumerate() {
            (0..self.equations).for_each(|row| scratch.rest[row] = scratch.jacobian[row * n + column]);
            self.solve(scratch);
            for (&c, x) in self.passive.iter().zip(&scratch.solved) {
                scratch.slopes[c * own + i] = -x;
            }
            scratch.slopes[column * own + i] = 1.0;
        }
        Ok(())
    }
}
