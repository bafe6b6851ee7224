//! The stages of a step, as the sensitivities see them.

use super::columns::{ColumnBlocks, combine};
use crate::simulation::step_control::AcceptedStep;

/// What a simulation knows of a stage.
pub(super) struct StageRecord {
    /// The factors of the mass matrix.
    pub(super) mass: Vec<f64>,
    /// The accelerations.
    pub(super) accelerations: Vec<f64>,
}

impl StageRecord {
    /// One for each of `stages`, of `n` coordinates.
    pub(super) fn of_stages(stages: usize, n: usize) -> Vec<Self> {
        (0..stages).map(|_| Self { mass: vec![0.0; n * n], accelerations: vec![0.0; n] }).collect()
    }
}

/// The slopes of the sensitivities in the stages of a step.
pub(super) struct StageSlopes {
    pub(super) slopes: Vec<ColumnBlocks>,
    /// Scratch: the state of a stage.
    pub(super) x: Vec<f64>,
    /// Scratch: the slopes before, as they count in a stage.
    pub(super) before: ColumnBlocks,
}

impl StageSlopes {
    pub(super) fn new(stages: usize, zeros: &ColumnBlocks) -> Self {
        Self { slopes: vec![zeros.clone(); stages], x: vec![0.0; zeros.rows()], before: zeros.clone() }
    }

    /// Leaves the state of a stage in `x`, with these weights of the slopes before.
    pub(super) fn place(&mut self, step: &AcceptedStep<'_>, weights: &[f64]) {
        self.x.copy_from_slice(step.from);
        for (slope, weight) in step.slopes.iter().zip(weights) {
            self.x.iter_mut().zip(slope).for_each(|(x, k)| *x += step.step * weight * k);
        }
    }

    /// The sensitivities within the step, with these weights of its slopes.
    pub(super) fn within(&self, weights: &[f64], start: &ColumnBlocks, out: &mut ColumnBlocks) {
        combine(Some(start), &self.slopes, weights.iter().copied(), out);
    }
}
