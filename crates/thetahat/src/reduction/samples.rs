//! The samples of short recordings, which an identification reads: their part of the file.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::preparation::Recording;
use thetahat_data::recording::Resampling;
use thetahat_estimation::trajectory::Moves;
use thetahat_ground::series::Series;

/// Numbers of the samples of all recordings up to which they are kept.
pub(super) const MOST_NUMBERS_KEPT: usize = 1 << 22;

/// The numbers of a recording's series.
pub(super) fn numbers(recording: &Recording) -> usize {
    SIGNALS.iter().filter_map(|signal| signal.of(recording)).map(<[f64]>::len).sum()
}

/// A series of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Signal {
    Position,
    Torque,
    Velocity,
    Reference,
    #[serde(rename = "added_signal")]
    Added,
    TimeStamps,
}

/// In the order of the file.
const SIGNALS: [Signal; 6] =
    [Signal::Position, Signal::Torque, Signal::Velocity, Signal::Reference, Signal::Added, Signal::TimeStamps];

impl Signal {
    fn of(self, recording: &Recording) -> Option<&[f64]> {
        let series = match self {
            Self::Position => Some(&recording.position),
            Self::Torque => recording.torque.as_ref(),
            Self::Velocity => recording.velocity.as_ref(),
            Self::Reference => recording.reference.as_ref(),
            Self::Added => recording.added_signal.as_ref(),
            Self::TimeStamps => return recording.time_stamps_s.as_deref(),
        };
        series.map(Series::values)
    }

    fn set(self, recording: &mut Recording, values: Vec<f64>, joints: usize) {
        match self {
            Self::Position => recording.position = Series::shaped(joints, values),
            Self::Torque => recording.torque = Some(Series::shaped(joints, values)),
            Self::Velocity => recording.velocity = Some(Series::shaped(joints, values)),
            Self::Reference => recording.reference = Some(Series::shaped(joints, values)),
            Self::Added => recording.added_signal = Some(Series::shaped(joints, values)),
            Self::TimeStamps => recording.time_stamps_s = Some(values),
        }
    }

    /// Whether so many numbers are whole samples.
    fn has_whole_samples(self, numbers: usize, joints: usize) -> bool {
        match self {
            Self::Position | Self::Torque | Self::Velocity | Self::Reference | Self::Added => {
                numbers.is_multiple_of(joints)
            }
            Self::TimeStamps => true,
        }
    }
}

/// What the header of the file says of a recording's samples; name, weight and hold of the torques stand with its rows.
#[derive(Serialize, Deserialize)]
pub(super) struct SamplesHeader {
    /// With their numbers: time stamps are those of the samples before they were brought to equal steps.
    signals: Vec<(Signal, usize)>,
    gaps: Vec<Range<usize>>,
    sample_rate_hz: f64,
    window_s: [Option<f64>; 2],
    resampling: Option<Resampling>,
    contradicting_times: Option<(String, f64)>,
    notes: Vec<String>,
    geared: bool,
    planned: Option<Moves>,
    truth: Option<Vec<f64>>,
}

impl SamplesHeader {
    pub(super) fn of(recording: &Recording) -> Self {
        Self {
            signals: SIGNALS.into_iter().filter_map(|signal| Some((signal, signal.of(recording)?.len()))).collect(),
            gaps: recording.gaps.clone(),
            sample_rate_hz: recording.sample_rate_hz,
            window_s: recording.window_s,
            resampling: recording.resampling,
            contradicting_times: recording.contradicting_times.clone(),
            notes: recording.notes.clone(),
            geared: recording.geared,
            planned: recording.planned.clone(),
            truth: recording.truth.clone(),
        }
    }

    /// How many values stand in the file; none if there are no positions, or numbers that are no whole samples.
    pub(super) fn values(&self, joints: usize) -> Option<usize> {
        let has_positions = self.signals.first().is_some_and(|(signal, _)| *signal == Signal::Position);
        let mut all = self.signals.iter();
        if !has_positions || !all.all(|(signal, numbers)| signal.has_whole_samples(*numbers, joints)) {
            return None;
        }
        self.signals.iter().try_fold(0_usize, |sum, (_, numbers)| sum.checked_add(*numbers))
    }

    pub(super) fn read(self, joints: usize, next: &mut impl FnMut() -> f64) -> Recording {
        let mut recording = Recording {
            gaps: self.gaps,
            window_s: self.window_s,
            resampling: self.resampling,
            contradicting_times: self.contradicting_times,
            notes: self.notes,
            geared: self.geared,
            planned: self.planned,
            truth: self.truth,
            ..Recording::without_torque(self.sample_rate_hz, Series::zeros(0, joints))
        };
        for (signal, numbers) in self.signals {
            let values = (0..numbers).map(|_| next()).collect();
            signal.set(&mut recording, values, joints);
        }
        recording
    }
}

/// Writes the values of a recording in the order in which they are read.
pub(super) fn write(recording: &Recording, write: &mut impl FnMut(f64)) {
    let values = SIGNALS.iter().filter_map(|signal| signal.of(recording)).flatten();
    values.for_each(|value| write(*value));
}
