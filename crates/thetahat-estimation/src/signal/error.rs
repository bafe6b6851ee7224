//! What can be wrong with a filter's specification or its input.

use thiserror::Error;

/// Why a signal could not be processed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SignalError {
    /// The order of a filter is zero.
    #[error("a filter of order 0 does not filter; give an order of at least 1")]
    ZeroOrder,
    /// The smoother has no random walk of this order.
    #[error("the smoother's random walk has order 3, 4 or 5, found {found}; 4 has the gain of the usual filter")]
    SmootherOrder {
        /// The order found.
        found: usize,
    },
    /// The sample rate is not a positive number.
    #[error("the sample rate must be a positive number, found {sample_rate_hz} Hz; give the rate of the recording")]
    InvalidSampleRate {
        /// The rate found, in hertz.
        sample_rate_hz: f64,
    },
    /// The cut-off is not a positive number.
    #[error("the cut-off must be a positive number, found {cutoff_hz} Hz; give a frequency above 0 Hz")]
    NonPositiveCutoff {
        /// The cut-off found, in hertz.
        cutoff_hz: f64,
    },
    /// The cut-off is not below half the sample rate.
    #[error(
        "the cut-off of {cutoff_hz} Hz is not below the Nyquist frequency of {nyquist_hz} Hz; \
         lower the cut-off or check the sample rate"
    )]
    CutoffAboveNyquist {
        /// The cut-off found, in hertz.
        cutoff_hz: f64,
        /// Half the sample rate, in hertz: the cut-off must be below it.
        nyquist_hz: f64,
    },
    /// The pass-band ripple is not a positive number.
    #[error("the pass-band ripple must be a positive number, found {ripple_db} dB; 0.05 dB is usual")]
    InvalidRipple {
        /// The ripple found, in decibels.
        ripple_db: f64,
    },
    /// The decimation factor is zero.
    #[error("the decimation factor must be at least 1, found {factor}; 1 keeps every sample")]
    InvalidFactor {
        /// The factor found.
        factor: usize,
    },
    /// The recording has fewer samples than the operation needs.
    #[error(
        "the recording has {found} samples and {needed} are needed; use a longer recording or a filter of lower order"
    )]
    RecordTooShort {
        /// The least number of samples.
        needed: usize,
        /// The number of samples of the recording.
        found: usize,
    },
    /// The length of a series differs from the announced one.
    #[error(
        "a series of {expected} samples was expected and {found} were found; build the decimator for the length \
         of the recording, and probe a filter before it drops samples"
    )]
    LengthMismatch {
        /// The number of samples expected.
        expected: usize,
        /// The number of samples found.
        found: usize,
    },
    /// The response to the probing impulse has not died out at the ends of the recording.
    #[error(
        "at the ends of the recording the impulse response is still {end_fraction:e} of its peak; \
         probe with more than {samples} samples"
    )]
    ResponseTruncated {
        /// The largest value at either end over the peak.
        end_fraction: f64,
        /// The number of samples of the probe.
        samples: usize,
    },
    /// The processing probed has no gain at DC to compare with.
    #[error(
        "the gain at DC is {dc_gain}, so there is no -3 dB frequency relative to it; \
         state how many times the processing differentiates"
    )]
    NoDcGain {
        /// The gain at 0 Hz over the gain of the ideal derivative.
        dc_gain: f64,
    },
    /// The fraction of the peak velocity is not between 0 and 1.
    #[error("the threshold must lie above 0 and below 1, found {threshold_fraction}; 0.01 is one percent of the peak")]
    InvalidThreshold {
        /// The fraction found.
        threshold_fraction: f64,
    },
    /// No channel moves.
    #[error(
        "nothing moves: the peak velocity is {peak_velocity} and only more than {still_velocity} counts as motion; \
         check the units and the channels of the recording, or lower the still velocity"
    )]
    NoMotion {
        /// The largest absolute velocity of all channels.
        peak_velocity: f64,
        /// The velocity up to which a channel counts as still.
        still_velocity: f64,
    },
}
