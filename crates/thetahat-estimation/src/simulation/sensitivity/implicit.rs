//! The variational equations in the steps of the linearly implicit method.

use pulp::{Simd, WithSimd};

use super::{
    columns::{ColumnBlocks, Wide, ZEROS, add_product, combine, solve_columns},
    loop_slopes::LoopSlopes,
    stages::{StageDynamics, StageSlopes},
};
use crate::simulation::{
    rosenbrock_w::{ALPHA, B, COUPLING, GAMMA, Linearisation, STAGES},
    step_control::AcceptedStep,
    system::Loop,
};

impl StageSlopes {
    /// Propagates the sensitivities from the `start` of a step of [`crate::simulation::RosenbrockW`] to its `end`. Every column is solved
    /// with the matrix of the state's own stages, given with the linearisation it was made of: the method keeps its order with any
    /// approximation of the Jacobian.
    pub(super) fn follow_implicitly(
        &mut self,
        (system, slopes): (&mut Loop<'_>, &mut LoopSlopes),
        step: &AcceptedStep<'_>,
        stages: &[StageDynamics],
        (linearisation, matrix): (&Linearisation, &[f64]),
        start: &ColumnBlocks,
        end: &mut ColumnBlocks,
    ) {
        let scaled = step.step * GAMMA;
        let time = |stage: usize| step.start_s + ALPHA[stage].iter().sum::<f64>() * step.step;
        for stage in 0..STAGES {
            self.place(step, &mut system.plant, stage, time(stage), &ALPHA[stage], &stages[stage]);
        }
        slopes.evaluate_stages(system, &self.motion, 0..STAGES);
        for stage in 0..STAGES {
            let (earlier, here) = self.slopes.split_at_mut(stage);
            combine(Some(start), earlier, ALPHA[stage].map(|a| step.step * a), end);
            let terms = slopes.accelerations(system, time(stage), &self.motion, stage);
            terms.slopes(end, &stages[stage].mass, &mut here[0]);
            combine(None, earlier, COUPLING[stage].map(|c| c / GAMMA), &mut self.before);
            let (before, slope) = (&self.before, &mut here[0]);
            pulp::Arch::new().dispatch(SolveStage { linearisation, matrix, scaled, before, slope });
        }
        combine(Some(start), &self.slopes, B.map(|b| step.step * b), end);
    }
}

/// Turns the right-hand sides of a stage into its slopes, as [`crate::simulation::RosenbrockW`] does for the state, without
/// derivatives in time.
struct SolveStage<'a> {
    linearisation: &'a Linearisation,
    matrix: &'a [f64],
    /// `h gamma`.
    scaled: f64,
    before: &'a ColumnBlocks,
    slope: &'a mut ColumnBlocks,
}

impl WithSimd for SolveStage<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let mut right = vec![ZEROS; self.linearisation.rate.len()];
        for block in 0..self.before.blocks() {
            let before = self.before.block(block);
            let slope = self.slope.block_mut(block);
            slope.iter_mut().zip(before).for_each(|(f, g)| add_product(f, 1.0, g));
            self.linearisation.write_right_side(self.scaled, slope, &mut right);
            solve_columns(self.matrix, &mut right);
            let n = right.len();
            for (i, right) in right.iter().enumerate() {
                add_product(&mut slope[i], self.scaled, right);
                slope[n + i] = *right;
            }
            slope.iter_mut().zip(before).for_each(|(k, g)| add_product(k, -1.0, g));
        }
    }
}

impl Linearisation {
    /// `M f_v - h gamma K f_q` of a block of right-hand sides, positions before velocities.
    #[inline(always)]
    fn write_right_side(&self, scaled: f64, of_state: &[Wide], right: &mut [Wide]) {
        let n = right.len();
        let (of_positions, of_velocities) = of_state.split_at(n);
        for (i, right) in right.iter_mut().enumerate() {
            *right = ZEROS;
            for j in 0..n {
                add_product(right, self.mass[i * n + j], &of_velocities[j]);
                add_product(right, -scaled * self.stiffness[i * n + j], &of_positions[j]);
            }
        }
    }
}
