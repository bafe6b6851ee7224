//! The band-passed motion of a recording, and the window in which it is used.

use std::ops::Range;

use super::{error::PreparationError, recording::Recording, settings::SignalOptions, setup::Setup};
use crate::{
    dynamics::Sign,
    identification::Assembly,
    linear_algebra::Matrix,
    series::Series,
    signal::{Motion, SignalError, moving_samples},
};

/// Part of its peak velocity above which a joint counts as moving.
pub(crate) const MOVING: f64 = 0.01;
/// Peak velocity in rad/s or m/s below which a joint counts as still.
pub(crate) const STILL: f64 = 1e-3;
/// Periods of the position filter's cut-off that are cut at both ends of a record: the reach of its transient, where a
/// record starts or ends in motion.
const EDGE_PERIODS: f64 = 5.0;
/// Fewest periods of the position filter's cut-off in a record: with fewer, the ends are all that is left of it.
const FEWEST_PERIODS: f64 = 10.0;

/// A recording with its band-passed motion in the window.
#[derive(Debug, Clone)]
pub(crate) struct FilteredRecording {
    pub(crate) recording: Recording,
    /// The motion in the window.
    pub(crate) motion: Motion,
    /// Samples of the recording.
    pub(crate) window: Range<usize>,
    /// The channels that torque terms take, over the whole recording, filtered as the positions are.
    pub(crate) channels: Option<Series>,
}

impl Setup<'_> {
    /// Filters and differentiates the whole recording, then cuts it to its window: its own, or else that of the settings.
    pub(crate) fn filter(&self, recording: Recording) -> Result<FilteredRecording, PreparationError> {
        let options = self.settings.signal.in_window(recording.window_s);
        self.filter_and_cut(recording, &options)
    }

    /// Filters and differentiates the whole recording, then cuts it to its moving part.
    pub(crate) fn filter_moving_part(&self, recording: Recording) -> Result<FilteredRecording, PreparationError> {
        let options = SignalOptions { window_start_s: None, window_end_s: None, ..self.settings.signal };
        self.filter_and_cut(recording, &options)
    }

    fn filter_and_cut(
        &self,
        recording: Recording,
        options: &SignalOptions,
    ) -> Result<FilteredRecording, PreparationError> {
        let rate = recording.sample_rate_hz;
        self.require_periods(recording.position.len(), rate)?;
        let Motion { q, dq, ddq } = self.band_pass(&recording.position, rate)?;
        // A record without motion is refused with a stated window as well.
        let moving = moving_samples(&dq, MOVING, STILL)?;
        let window = window_of(moving, dq.len(), rate, options)?;
        let cut = |series: &Series| series.window(window.clone());
        let motion = Motion { q: cut(&q), dq: cut(&dq), ddq: cut(&ddq) };
        let channels = recording.channels_named(&self.robot.channels(), self.robot.coordinate_count())?;
        let channels = channels.map(|c| self.band_pass(&c, rate)).transpose()?.map(|filtered| filtered.q);
        Ok(FilteredRecording { motion, recording, window, channels })
    }

    /// A record must be long beside the period of the position filter.
    pub(crate) fn require_periods(&self, samples: usize, sample_rate_hz: f64) -> Result<(), PreparationError> {
        let cutoff_hz = self.settings.signal.cutoff_hz;
        let slowest = FEWEST_PERIODS * sample_rate_hz / samples as f64;
        let expected = format!("at least {slowest:.3}, {FEWEST_PERIODS} periods in the record");
        PreparationError::require(cutoff_hz >= slowest, "[signal] cutoff_hz", &expected, cutoff_hz)
    }
}

/// The window of a record of so many samples that moves in a range of them: the stated one, or the moving part without the
/// edges of the filter.
pub(crate) fn window_of(
    moving: Range<usize>,
    samples: usize,
    sample_rate_hz: f64,
    options: &SignalOptions,
) -> Result<Range<usize>, PreparationError> {
    let sample = |t: f64| (t * sample_rate_hz).round() as usize;
    let edge = (EDGE_PERIODS * sample_rate_hz / options.cutoff_hz).ceil() as usize;
    let start = options.window_start_s.map_or(moving.start.max(edge), sample);
    let end = match (options.window_start_s, options.window_end_s) {
        (_, Some(end)) => sample(end),
        (Some(_), None) => samples,
        (None, None) => moving.end.min(samples.saturating_sub(edge)),
    };
    if end > samples {
        let found = format!("{} s", options.window_end_s.unwrap_or_default());
        let record = format!("at most the record's {:.4} s", samples as f64 / sample_rate_hz);
        return Err(PreparationError::value("[signal] window_end_s", &record, found));
    }
    if start >= end {
        let found = format!("{start} to {end}");
        return Err(PreparationError::value("[signal] the window, in samples,", "a start before its end", found));
    }
    Ok(start..end)
}

impl FilteredRecording {
    /// X of the measured motion.
    pub(crate) fn observation_matrix(&self, assembly: &Assembly<'_>) -> Result<Matrix, SignalError> {
        let Motion { q, dq, ddq } = &self.motion;
        let assembly = assembly.clone().with_channels(self.channels_in_window());
        assembly.observation_matrix(q, dq, ddq, Sign::Exact)
    }

    /// The channels that torque terms take, in the window.
    pub(crate) fn channels_in_window(&self) -> Option<Series> {
        self.channels.as_ref().map(|channels| channels.window(self.window.clone()))
    }

    /// The torques in the window; zeros where they were not recorded.
    pub(crate) fn torque(&self) -> Series {
        let zeros = || Series::zeros(self.window.len(), self.recording.position.channels());
        self.recording.torque.as_ref().map_or_else(zeros, |torque| torque.window(self.window.clone()))
    }

    /// The recorded positions in the window, as they are.
    pub(crate) fn position(&self) -> Series {
        self.recording.position.window(self.window.clone())
    }

    /// Time of the first sample of the window, s.
    pub(crate) fn start_s(&self) -> f64 {
        self.window.start as f64 / self.recording.sample_rate_hz
    }

    /// Start and end of the window, s.
    pub(crate) fn window_s(&self) -> [f64; 2] {
        [self.start_s(), self.window.end as f64 / self.recording.sample_rate_hz]
    }
}
