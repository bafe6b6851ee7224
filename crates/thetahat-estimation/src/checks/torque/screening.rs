//! A few rows of a recording, on which corrections of it are tried.

use crate::{
    checks::{
        fit::{
            affine::Affine,
            orthogonal_fit::squared_residual,
            thinned_recording::{ThinnedRecording, at, motion_at},
        },
        numbers::span,
    },
    signal::Motion,
};
use std::ops::RangeInclusive;
use thetahat_ground::series::Series;

/// Rows of all joints per parameter.
const ROWS_PER_PARAMETER: usize = 8;

/// Plausible spans of a joint's motion, rad: corrections that lead to others are not considered.
pub(super) const SPANS_RAD: RangeInclusive<f64> = 0.1..=25.0;
/// The same for prismatic joints, m.
pub(super) const SPANS_M: RangeInclusive<f64> = 1e-3..=20.0;

/// A few rows of the recording, unfiltered.
pub(super) struct Screening {
    /// Span of each coordinate, rad or m.
    pub(super) spans: Vec<f64>,
    motion: Motion,
    torque: Series,
}

impl Screening {
    /// Operations of one fit.
    pub(super) fn work(recording: &ThinnedRecording<'_>) -> f64 {
        (ROWS_PER_PARAMETER * recording.parameters().pow(3)) as f64
    }

    pub(super) fn new(recording: &ThinnedRecording<'_>) -> Self {
        let rows = ROWS_PER_PARAMETER * recording.parameters() / recording.coordinates() + 1;
        let step = (recording.rows() / rows).max(1);
        let samples: Vec<usize> = recording.kept.iter().step_by(step).copied().collect();
        let motion = motion_at(&recording.motion, &samples);
        let spans = (0..recording.coordinates()).map(|j| span(&recording.motion.q.channel(j))).collect();
        Self { spans, motion, torque: at(&recording.torque, &samples) }
    }

    /// Squared residual, relative to the corrected torques; `None` if it is not finite.
    pub(super) fn squares(&self, recording: &ThinnedRecording<'_>, correction: &Affine) -> Option<f64> {
        let (motion, torque) = (correction.motion(&self.motion), correction.torque(&self.torque));
        let squares = squared_residual(&recording.unfiltered_regression(&motion, &torque));
        squares.is_finite().then_some(squares)
    }

    /// The squared residual of torques that the motion does not explain at all, relative to them.
    pub(super) fn squares_of_none(&self) -> f64 {
        self.torque.values().len() as f64
    }
}
