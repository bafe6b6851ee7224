//! One piece of a recording on its way to rows, and the window in which there are any.

use std::ops::Range;

use super::{
    error::ReductionError,
    fingerprint::Fingerprint,
    instruments::{Simulated, SimulatedPiece},
    source::Source,
};
use crate::{
    dynamics::{Model, Sign, State, Workspace},
    experiment::Experiment,
    preparation::{MOVING, PreparationError, STILL},
    regressor::Regressor,
    series::Series,
    signal::{DecimatedPiece, Decimator, Motion, SecondOrderSections, SignalError, moving_thresholds},
};

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

/// What one piece gives.
pub(super) struct Piece {
    pub decimated: DecimatedPiece,
    pub fingerprint: Fingerprint,
    /// Largest velocity.
    pub peak: f64,
    pub has_torque: bool,
    /// Simulated positions at the first sample, and at the one behind the last.
    pub seam: Option<(Vec<f64>, Option<Vec<f64>>)>,
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
    /// record.
    fn extended(&self, range: &Range<usize>) -> Range<usize> {
        let ahead = self.reach + 2 * self.experiment.settings.signal.derivative.reach();
        range.start.saturating_sub(ahead)..(range.end + ahead).min(self.source.samples)
    }

    fn band_pass(&self, position: &Series) -> Result<Motion, ReductionError> {
        let filtered = self.experiment.setup().band_pass(position, self.source.sample_rate_hz);
        filtered.map_err(|e| refuse(self.experiment, e))
    }

    /// Filtered velocities in a range of samples.
    fn velocity(&self, range: &Range<usize>) -> Result<Series, ReductionError> {
        let extended = self.extended(range);
        let Motion { dq, .. } = self.band_pass(&self.source.position(extended.clone())?)?;
        Ok(dq.window(range.start - extended.start..range.end - extended.start))
    }

    /// The pieces of the whole record.
    pub(super) fn all(&self) -> Vec<Range<usize>> {
        let starts = (0..self.source.samples).step_by(self.samples);
        starts.map(|start| start..(start + self.samples).min(self.source.samples)).collect()
    }

    /// The largest velocity of each joint in a range of samples.
    pub(super) fn peaks(&self, range: &Range<usize>) -> Result<Vec<f64>, ReductionError> {
        let velocity = self.velocity(range)?;
        let mut peaks = vec![0.0_f64; velocity.channels()];
        for sample in velocity.values().chunks(velocity.channels()) {
            peaks.iter_mut().zip(sample).for_each(|(peak, v)| *peak = peak.max(v.abs()));
        }
        Ok(peaks)
    }

    /// The samples between the first and the last that moves, from the peaks of all pieces.
    pub(super) fn moving(&self, peaks: &[Vec<f64>]) -> Result<Range<usize>, ReductionError> {
        let joints = peaks.first().map_or(0, Vec::len);
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

/// What makes rows of the pieces of a window.
pub(super) struct Rows<'a> {
    pub pieces: &'a Pieces<'a>,
    pub window: Range<usize>,
    pub decimator: &'a Decimator,
    pub model: &'a Model,
    pub regressor: &'a Regressor,
    /// The simulation of the instruments.
    pub simulated: Option<&'a Simulated<'a>>,
}

impl Rows<'_> {
    pub(super) fn channels(&self) -> usize {
        let matrices = if self.simulated.is_some() { 2 } else { 1 };
        matrices * self.regressor.entries().len() + self.model.coordinate_count()
    }

    /// The piece with these rows: the entries of phi from the simulated motion, where there is one, then the entries
    /// from the measured motion, then the torques.
    pub(super) fn piece(&self, rows: Range<usize>) -> Result<Piece, ReductionError> {
        let own = self.decimator.samples_of(&rows);
        let range = own.start + self.window.start..own.end + self.window.start;
        let extended = self.pieces.extended(&range);
        let (position, torque) = self.pieces.source.motion(extended.clone())?;
        let Motion { q, dq, ddq } = self.pieces.band_pass(&position)?;
        let place = |k: usize| k + self.window.start - extended.start;
        let entries = self.regressor.entries().len();
        let simulated = self.simulated.map(|s| s.motion(&range).map(|motion| (s.sign(), motion))).transpose()?;
        let before = if simulated.is_some() { entries } else { 0 };
        let mut workspace = Workspace::new(self.model);
        let decimated = self.decimator.decimate_piece(rows, self.channels(), |k, values| {
            let i = place(k);
            let (z, values) = values.split_at_mut(before);
            if let Some((sign, SimulatedPiece { motion: Motion { q, dq, ddq }, .. })) = &simulated {
                let k = k - own.start;
                let state = State::new(q.sample(k), dq.sample(k));
                self.regressor.evaluate(self.model, state, ddq.sample(k), *sign, &mut workspace, z);
            }
            let (phi, tau) = values.split_at_mut(entries);
            let state = State::new(q.sample(i), dq.sample(i));
            self.regressor.evaluate(self.model, state, ddq.sample(i), Sign::Exact, &mut workspace, phi);
            tau.copy_from_slice(torque.sample(i));
        });
        let joints = q.channels();
        let of_range = place(own.start) * joints..place(own.end) * joints;
        let mut fingerprint = Fingerprint::EMPTY;
        for (q, tau) in
            position.values()[of_range.clone()].chunks(joints).zip(torque.values()[of_range.clone()].chunks(joints))
        {
            fingerprint.add(q);
            fingerprint.add(tau);
        }
        Ok(Piece {
            decimated: decimated.map_err(|e| refuse(self.pieces.experiment, e))?,
            fingerprint,
            peak: dq.values()[of_range.clone()].iter().fold(0.0, |peak, v| peak.max(v.abs())),
            has_torque: torque.values()[of_range].iter().any(|v| *v != 0.0),
            seam: simulated.map(|(_, piece)| (piece.motion.q.sample(0).to_vec(), piece.next)),
        })
    }
}
