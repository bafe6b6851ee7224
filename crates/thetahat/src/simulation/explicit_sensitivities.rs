//! The variational equations in the steps of the explicit method.

use super::{
    columns::ColumnBlocks,
    combination::combine,
    dormand_prince::{A, C},
    held_slopes::HeldSlopes,
    loop_slopes::LoopSlopes,
    stage_record::StageRecord,
    step_control::AcceptedStep,
    system::Loop,
};

const STAGES: usize = 7;

/// The slopes of the sensitivities in the stages of a step of [`super::DormandPrince`].
pub(super) struct ExplicitSensitivities {
    slopes: [ColumnBlocks; STAGES],
    /// The state of a stage.
    x: Vec<f64>,
}

impl ExplicitSensitivities {
    pub(super) fn new(rows: usize, columns: usize) -> Self {
        Self { slopes: [(); STAGES].map(|()| ColumnBlocks::zeros(rows, columns)), x: vec![0.0; rows] }
    }

    /// Takes the sensitivities from the start of a step to its end; `stages` hold the factors of the mass matrix. The last slope of a step is the first of the next, unless that is the `first` of an interval.
    pub(super) fn follow(
        &mut self,
        (system, linear, held): (&mut Loop<'_>, &mut LoopSlopes, Option<&HeldSlopes>),
        step: &AcceptedStep<'_>,
        stages: &[StageRecord],
        first: bool,
        start: &ColumnBlocks,
        end: &mut ColumnBlocks,
    ) {
        let n = self.x.len() / 2;
        self.slopes.swap(0, STAGES - 1);
        for stage in usize::from(!first)..STAGES {
            self.x.copy_from_slice(step.from);
            for (slope, a) in step.slopes.iter().zip(A[stage]) {
                self.x.iter_mut().zip(slope).for_each(|(x, k)| *x += step.step * a * k);
            }
            let time = if stage == 0 { step.start_s } else { step.start_s + C[stage] * step.step };
            linear.linearise_accelerations(system, held, time, &self.x, &step.slopes[stage][n..]);
            let (before, here) = self.slopes.split_at_mut(stage);
            let weights = A[stage].iter().map(|a| step.step * a);
            combine(start, before.iter().zip(weights), end);
            linear.slopes(end, &stages[stage].mass, &mut here[0]);
        }
    }

    /// The sensitivities within the step, with these weights of its slopes.
    pub(super) fn within(&self, weights: &[f64; STAGES], start: &ColumnBlocks, out: &mut ColumnBlocks) {
        combine(start, self.slopes.iter().zip(weights.iter().copied()), out);
    }
}
