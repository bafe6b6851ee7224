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

impl SimulatedMotion {
    /// A motion at rest at zero of so many joints, to which those of parts are written.
    #[doc(hidden)]
    #[must_use]
    pub fn zeros(samples: usize, joints: usize) -> Self {
        let [q, dq, ddq, tau] = [(); 4].map(|()| Series::zeros(samples, joints));
        Self { q, dq, ddq, tau, counts: WorkCounts::default() }
    }

    /// Writes the motion of a part of the robot with these coordinates.
    #[doc(hidden)]
    pub fn write(&mut self, coordinates: &[usize], part: &Self) {
        let series = [(&mut self.q, &part.q), (&mut self.dq, &part.dq), (&mut self.ddq, &part.ddq)];
        series.into_iter().chain([(&mut self.tau, &part.tau)]).for_each(|(to, from)| to.write(coordinates, from));
        let WorkCounts { evaluations, steps, rejected } = part.counts;
        self.counts.evaluations += evaluations;
        self.counts.steps += steps;
        self.counts.rejected += rejected;
    }
}
