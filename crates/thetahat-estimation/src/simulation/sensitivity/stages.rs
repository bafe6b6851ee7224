//! The stages of a step, as the sensitivities need them.

use super::columns::{ColumnBlocks, combine};
use crate::simulation::{plant::Plant, step_control::AcceptedStep};
use thetahat_ground::series::Series;

/// Mass matrix and accelerations of a stage.
pub(super) struct StageDynamics {
    /// The factors of the mass matrix.
    pub(super) mass: Vec<f64>,
    /// The accelerations.
    pub(super) accelerations: Vec<f64>,
}

impl StageDynamics {
    /// One for each of `stages`, of `n` coordinates.
    pub(super) fn of_stages(stages: usize, n: usize) -> Vec<Self> {
        (0..stages).map(|_| Self { mass: vec![0.0; n * n], accelerations: vec![0.0; n] }).collect()
    }
}

/// States and accelerations of the stages of a step, one sample each.
pub(super) struct StageMotion {
    q: Series,
    dq: Series,
    ddq: Series,
    /// The recorded channels that torque terms use.
    channels: Option<Series>,
}

/// Samples that are computed together.
const SIDE_BY_SIDE: usize = 4;

impl StageMotion {
    /// Zeros for `stages` of `n` coordinates, and for the padding to whole groups of samples.
    fn zeros(stages: usize, n: usize, channels: usize) -> Self {
        let zeros = |width| Series::zeros(stages.next_multiple_of(SIDE_BY_SIDE), width);
        Self { q: zeros(n), dq: zeros(n), ddq: zeros(n), channels: (channels > 0).then(|| zeros(channels)) }
    }

    /// Positions, velocities and accelerations.
    pub(super) fn series(&self) -> [&Series; 3] {
        [&self.q, &self.dq, &self.ddq]
    }

    /// The recorded channels that torque terms use.
    pub(super) fn channels(&self) -> Option<&Series> {
        self.channels.as_ref()
    }

    /// Writes the state of a stage, positions before velocities.
    pub(super) fn write_state(&self, stage: usize, x: &mut [f64]) {
        let (q, dq) = x.split_at_mut(self.q.channels());
        q.copy_from_slice(self.q.sample(stage));
        dq.copy_from_slice(self.dq.sample(stage));
    }
}

/// The slopes of the sensitivities in the stages of a step.
pub(super) struct StageSlopes {
    pub(super) slopes: Vec<ColumnBlocks>,
    pub(super) motion: StageMotion,
    /// Scratch: the previous slopes, as weighted in a stage.
    pub(super) before: ColumnBlocks,
}

impl StageSlopes {
    pub(super) fn new(stages: usize, zeros: &ColumnBlocks, channels: usize) -> Self {
        let motion = StageMotion::zeros(stages, zeros.rows() / 2, channels);
        Self { slopes: vec![zeros.clone(); stages], motion, before: zeros.clone() }
    }

    /// Writes a stage to the motion: its state has these weights of the previous slopes, and the recorded channels are those at its time.
    pub(super) fn place(
        &mut self,
        step: &AcceptedStep<'_>,
        plant: &mut Plant<'_>,
        stage: usize,
        time: f64,
        weights: &[f64],
        dynamics: &StageDynamics,
    ) {
        let StageMotion { q, dq, ddq, channels } = &mut self.motion;
        if let Some(channels) = channels {
            plant.observe_channels(time);
            channels.sample_mut(stage).copy_from_slice(&plant.channels);
        }
        let n = q.channels();
        q.sample_mut(stage).copy_from_slice(&step.from[..n]);
        dq.sample_mut(stage).copy_from_slice(&step.from[n..]);
        for (slope, weight) in step.slopes.iter().zip(weights) {
            let x = q.sample_mut(stage).iter_mut().chain(dq.sample_mut(stage));
            x.zip(slope).for_each(|(x, k)| *x += step.step * weight * k);
        }
        ddq.sample_mut(stage).copy_from_slice(&dynamics.accelerations);
    }

    /// The sensitivities within the step, with these weights of its slopes.
    pub(super) fn within(&self, weights: &[f64], start: &ColumnBlocks, out: &mut ColumnBlocks) {
        combine(Some(start), &self.slopes, weights.iter().copied(), out);
    }
}
