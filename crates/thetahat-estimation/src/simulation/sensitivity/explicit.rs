//! The variational equations in the steps of the explicit method.

use super::{
    columns::{ColumnBlocks, combine},
    loop_slopes::LoopSlopes,
    stages::{StageDynamics, StageSlopes},
};
use crate::simulation::{
    dormand_prince::{A, C},
    step_control::AcceptedStep,
    system::Loop,
};

/// Stages of a step of [`crate::simulation::DormandPrince`]; the last is the first of the next step.
pub(super) const STAGES: usize = 7;

impl StageSlopes {
    /// Propagates the sensitivities from the `start` of an explicit step to its `end`. The first slope is computed in the `first` step of
    /// an interval, and reused from the previous step in the others.
    pub(super) fn follow_explicitly(
        &mut self,
        (system, slopes): (&mut Loop<'_>, &mut LoopSlopes),
        step: &AcceptedStep<'_>,
        stages: &[StageDynamics],
        first: bool,
        start: &ColumnBlocks,
        end: &mut ColumnBlocks,
    ) {
        self.slopes.swap(0, STAGES - 1);
        let unknown = usize::from(!first)..STAGES;
        let time = |stage: usize| if stage == 0 { step.start_s } else { step.start_s + C[stage] * step.step };
        for stage in unknown.clone() {
            self.place(step, &mut system.plant, stage, time(stage), A[stage], &stages[stage]);
        }
        slopes.evaluate_stages(system, &self.motion, unknown.clone());
        for stage in unknown {
            let (before, here) = self.slopes.split_at_mut(stage);
            combine(Some(start), before, A[stage].iter().map(|a| step.step * a), end);
            let terms = slopes.accelerations(system, time(stage), &self.motion, stage);
            terms.slopes(end, &stages[stage].mass, &mut here[0]);
        }
    }
}
