//! The pieces of a recording, and what their positions show.

use std::ops::Range;

use super::{error::ReductionError, source::Source};
use crate::{
    experiment::Experiment,
    preparation::{MOVING, PreparationError, STILL},
};
use thetahat_estimation::signal::{
    Decimator, Motion, SecondOrderSections, SignalError, moving_thresholds, peaks, squared_differences,
};
use thetahat_ground::series::Series;

/// What a transient of the position filter decays to between the end of what is read and what is used of it: far below
/// rounding, since two differentiations amplify it.
const REMAINDER: f64 = 1e-18;
/// Values that the sums over the blocks of a piece may hold: 17 for each channel and row.
const MOST_VALUES: usize = 8 << 20;
const VALUES_PER_CHANNEL: usize = 17;

/// What is known before a recording is read for its rows.
pub(super) struct Pieces<'a> {
    pub experiment: &'a Experiment,
    pub source: &'a Source<'a>,
    /// Samples that the position filter looks back and ahead.
    pub reach: usize,
    /// Samples of one piece, about.
    pub samples: usize,
}

/// What the positions of a piece show.
pub(super) struct Look {
    /// The largest velocity of each joint.
    pub peaks: Vec<f64>,
    /// The largest acceleration of each joint.
    pub accelerations: Vec<f64>,
    /// The sum of the squares of what the position filter takes off each joint's positions.
    pub taken_off: Vec<f64>,
}

impl<'a> Pieces<'a> {
    pub(super) fn new(
        experiment: &'a Experiment,
        source: &'a Source<'a>,
        samples: usize,
    ) -> Result<Self, ReductionError> {
        let refuse = |e: PreparationError| ReductionError::from(experiment.refuse(e));
        experiment.setup().require_periods(source.samples, source.sample_rate_hz).map_err(refuse)?;
        let options = &experiment.settings.signal;
        let filter =
            SecondOrderSections::butterworth_lowpass(options.filter_order, options.cutoff_hz, source.sample_rate_hz);
        let filter = filter.map_err(|e| refuse(e.into()))?;
        let reach = filter.settling_samples(REMAINDER);
        Ok(Self { experiment, source, reach, samples: samples.max(reach).max(1) })
    }

    /// The rows of each piece of a decimated window.
    pub(super) fn parts(&self, decimator: &Decimator, decimation: usize, channels: usize) -> Vec<Range<usize>> {
        let fitting = MOST_VALUES / (VALUES_PER_CHANNEL * channels.max(1));
        decimator.pieces((self.samples / decimation).min(fitting).max(1))
    }

    /// What is read for a range of samples, so that two derivatives of its filtered positions agree with the whole
    /// recording.
    pub(super) fn extended(&self, range: &Range<usize>) -> Range<usize> {
        let ahead = self.reach + 2 * self.experiment.settings.signal.derivative.reach();
        range.start.saturating_sub(ahead)..(range.end + ahead).min(self.source.samples)
    }

    pub(super) fn band_pass(&self, position: &Series) -> Result<Motion, ReductionError> {
        let filtered = self.experiment.setup().band_pass(position, self.source.sample_rate_hz);
        filtered.map_err(|e| refuse(self.experiment, e))
    }

    /// Filtered velocities in a range of samples.
    fn velocity(&self, range: &Range<usize>) -> Result<Series, ReductionError> {
        self.filtered(range, |motion| motion.dq)
    }

    /// Filtered accelerations in a range of samples.
    pub(super) fn acceleration(&self, range: &Range<usize>) -> Result<Series, ReductionError> {
        self.filtered(range, |motion| motion.ddq)
    }

    fn filtered(&self, range: &Range<usize>, of: fn(Motion) -> Series) -> Result<Series, ReductionError> {
        let extended = self.extended(range);
        let series = of(self.band_pass(&self.source.position(extended.clone())?)?);
        Ok(series.window(range.start - extended.start..range.end - extended.start))
    }

    /// The pieces of the whole recording.
    pub(super) fn all(&self) -> Vec<Range<usize>> {
        let starts = (0..self.source.samples).step_by(self.samples);
        starts.map(|start| start..(start + self.samples).min(self.source.samples)).collect()
    }

    /// What the positions in a range of samples show.
    pub(super) fn look(&self, range: &Range<usize>) -> Result<Look, ReductionError> {
        let extended = self.extended(range);
        let position = self.source.position(extended.clone())?;
        let Motion { q, dq, ddq } = self.band_pass(&position)?;
        let own = range.start - extended.start..range.end - extended.start;
        let taken_off = squared_differences(&position, &q, &own);
        let [peaks, accelerations] = [dq, ddq].map(|series| peaks(&series.window(own.clone())));
        Ok(Look { peaks, accelerations, taken_off })
    }

    /// The samples between the first and the last that moves, from the peaks of all pieces.
    pub(super) fn moving(&self, peaks: &[&[f64]]) -> Result<Range<usize>, ReductionError> {
        let joints = peaks.first().map_or(0, |peaks| peaks.len());
        let largest: Vec<f64> = (0..joints).map(|j| peaks.iter().map(|p| p[j]).fold(0.0, f64::max)).collect();
        let thresholds = moving_thresholds(&largest, MOVING, STILL).map_err(|e| refuse(self.experiment, e))?;
        let moves = |sample: &[f64]| sample.iter().zip(&thresholds).any(|(v, limit)| v.abs() >= *limit);
        let (all, still) = (self.all(), || SignalError::NoMotion { peak_velocity: 0.0, still_velocity: STILL });
        let first = peaks.iter().position(|p| moves(p)).ok_or_else(|| refuse(self.experiment, still()))?;
        let last = peaks.iter().rposition(|p| moves(p)).ok_or_else(|| refuse(self.experiment, still()))?;
        let (begins, ends) = (self.velocity(&all[first])?, self.velocity(&all[last])?);
        let start = (0..begins.len()).find(|&k| moves(begins.sample(k))).unwrap_or(0);
        let end = (0..ends.len()).rfind(|&k| moves(ends.sample(k))).unwrap_or(0);
        Ok(all[first].start + start..all[last].start + end + 1)
    }
}

pub(super) fn refuse(experiment: &Experiment, source: SignalError) -> ReductionError {
    experiment.refuse(source).into()
}
