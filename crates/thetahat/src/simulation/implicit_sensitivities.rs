//! The variational equations in the steps of the linearly implicit method.

use pulp::{Simd, WithSimd};

use super::{
    columns::{ColumnBlocks, add_product},
    combination::combine,
    held_slopes::HeldSlopes,
    loop_slopes::{LoopSlopes, solve_block},
    rosenbrock_w::{ALPHA, B, COUPLING, GAMMA, Linearisation, STAGES},
    stage_record::StageRecord,
    step_control::AcceptedStep,
    system::Loop,
};

/// The slopes of the sensitivities in the stages of a step of [`super::RosenbrockW`]. Every column is solved with the matrix
/// of the state's stages: the method is of its order with any approximation of the Jacobian.
pub(super) struct ImplicitSensitivities {
    slopes: [ColumnBlocks; STAGES],
    zeros: ColumnBlocks,
    /// The slopes before, as they count in a stage.
    before: ColumnBlocks,
    /// The state of a stage.
    x: Vec<f64>,
}

impl ImplicitSensitivities {
    pub(super) fn new(rows: usize, columns: usize) -> Self {
        let zeros = ColumnBlocks::zeros(rows, columns);
        let slopes = [(); STAGES].map(|()| zeros.clone());
        Self { slopes, before: zeros.clone(), zeros, x: vec![0.0; rows] }
    }

    /// Takes the sensitivities from the start of a step to its end. `stages` are the factors of the mass matrix and the
    /// accelerations in the stages; the linearisation and its factored matrix are those of the step.
    pub(super) fn follow(
        &mut self,
        (system, linear, held): (&mut Loop<'_>, &mut LoopSlopes, Option<&HeldSlopes>),
        step: &AcceptedStep<'_>,
        stages: &[StageRecord],
        (linearisation, matrix): (&Linearisation, &[f64]),
        start: &ColumnBlocks,
        end: &mut ColumnBlocks,
    ) {
        let scaled = step.step * GAMMA;
        for stage in 0..STAGES {
            self.x.copy_from_slice(step.from);
            for (slope, weight) in step.slopes.iter().zip(ALPHA[stage]) {
                self.x.iter_mut().zip(slope).for_each(|(x, k)| *x += step.step * weight * k);
            }
            let time = step.start_s + ALPHA[stage].iter().sum::<f64>() * step.step;
            let StageRecord { mass, accelerations } = &stages[stage];
            linear.linearise_accelerations(system, held, time, &self.x, accelerations);
            let (earlier, here) = self.slopes.split_at_mut(stage);
            combine(start, earlier.iter().zip(ALPHA[stage].map(|a| step.step * a)), end);
            linear.slopes(end, mass, &mut here[0]);
            combine(&self.zeros, earlier.iter().zip(COUPLING[stage].map(|c| c / GAMMA)), &mut self.before);
            let (before, slope) = (&self.before, &mut here[0]);
            pulp::Arch::new().dispatch(SolveStage { linearisation, matrix, scaled, before, slope });
        }
        combine(start, self.slopes.iter().zip(B.map(|b| step.step * b)), end);
    }

    /// The sensitivities within the step, with these weights of its slopes.
    pub(super) fn within(&self, weights: &[f64], start: &ColumnBlocks, out: &mut ColumnBlocks) {
        combine(start, self.slopes.iter().zip(weights.iter().copied()), out);
    }
}

/// Turns right-hand sides into the slopes of a stage, as [`super::RosenbrockW`] does for the state.
struct SolveStage<'a> {
    linearisation: &'a Linearisation,
    matrix: &'a [f64],
    scaled: f64,
    before: &'a ColumnBlocks,
    slope: &'a mut ColumnBlocks,
}

impl WithSimd for SolveStage<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.linearisation.rate.len();
        let mut right = vec![[0.0; 8]; n];
        for block in 0..self.before.blocks() {
            let before = self.before.block(block);
            let slope = self.slope.block_mut(block);
            slope.iter_mut().zip(before).for_each(|(f, g)| add_product(f, 1.0, g));
            let (of_positions, of_velocities) = slope.split_at_mut(n);
            for (i, right) in right.iter_mut().enumerate() {
                *right = [0.0; 8];
                for j in 0..n {
                    add_product(right, self.linearisation.mass[i * n + j], &of_velocities[j]);
                    add_product(right, -self.scaled * self.linearisation.stiffness[i * n + j], &of_positions[j]);
                }
            }
            solve_block(self.matrix, &mut right);
            for i in 0..n {
                add_product(&mut of_positions[i], self.scaled, &right[i]);
                add_product(&mut of_positions[i], -1.0, &before[i]);
                of_velocities[i] = right[i];
                add_product(&mut of_velocities[i], -1.0, &before[n + i]);
            }
        }
    }
}
