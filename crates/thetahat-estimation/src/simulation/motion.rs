use super::solver::WorkCounts;
use thetahat_ground::series::Series;

/// Equally spaced times of output, the first at `start_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputGrid {
    /// The first time, s; the simulation itself starts at zero.
    pub start_s: f64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Number of samples.
    pub samples: usize,
}

impl OutputGrid {
    /// Time of sample `k`.
    pub(super) fn time(&self, k: usize) -> f64 {
        self.start_s + k as f64 / self.sample_rate_hz
    }
}

/// The result of a simulation at the times of its grid.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedMotion {
    /// Joint positions, rad or m.
    pub q: Series,
    /// Joint velocities.
    pub dq: Series,
    /// Joint accelerations, by the direct dynamic model and not by differences.
    pub ddq: Series,
    /// Joint torques.
    pub tau: Series,
    /// Work done.
    pub counts: WorkCounts,
}
