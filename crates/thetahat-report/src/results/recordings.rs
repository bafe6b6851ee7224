use serde::{Deserialize, Serialize};

use thetahat_data::recording::Resampling;
use thetahat_estimation::checks::{Finding, Severity};

/// What was used of a recording.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RecordingResult {
    /// Its name, or its number.
    pub name: String,
    /// Weight of its rows.
    pub weight: f64,
    /// Samples in its window.
    pub samples_used: usize,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Start and end of the window, s.
    pub window_s: [f64; 2],
    /// How far its time steps deviate, where it was resampled to equal ones.
    pub resampling: Option<Resampling>,
    /// Where torques end that were low-passed before they were recorded, Hz; none where they are raw.
    #[serde(default)]
    pub torque_ends_hz: Option<f64>,
    /// Time for which its torques hold, s, over which they were centred; zero where they were measured at their instants.
    #[serde(default)]
    pub torque_hold_s: f64,
    /// Samples near rest that make no rows; none where all make rows.
    #[serde(default)]
    pub near_rest: Option<NearRestResult>,
    /// The reference that its simulations follow.
    pub reference: Option<ReferenceResult>,
}

/// Samples that make no rows because the sign of a velocity is not known there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NearRestResult {
    /// Velocity of each coordinate below which it is near rest, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Time on either side that is left out as well, s.
    pub widened_s: f64,
    /// Part of each coordinate's samples that is left out, percent; zero for one that hardly moves, which keeps all.
    pub left_out_percent: Vec<f64>,
}

/// What IDIM-LS gives where samples near rest make rows too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnmaskedComparison {
    /// Its relative error, percent.
    pub relative_error_percent: f64,
    /// The parameter that differs most, and its difference in standard deviations of the nominal estimate, with correlated
    /// errors.
    pub parameter: String,
    /// The difference.
    pub deviations: f64,
}

/// Where the simulations' reference comes from, and how well it describes the record.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ReferenceResult {
    /// `recorded`, `planned`, `reconstructed`, `periodic` or `filtered`.
    pub origin: String,
    /// Moves, where it is made of moves.
    pub moves: Option<usize>,
    /// The period found, where it is periodic.
    #[serde(default)]
    pub periodic: Option<PeriodicResult>,
    /// Cut-off of the filter with which the motion was smoothed, Hz, where it is the motion itself, or in its transients.
    #[serde(default)]
    pub smoothing_cutoff_hz: Option<f64>,
    /// Rms deviation of the record from it in the window, per joint, rad or m.
    pub rms_deviation: Vec<f64>,
}

/// A Fourier series that was fitted to a recorded motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PeriodicResult {
    /// Base frequency, Hz.
    pub base_frequency_hz: f64,
    /// Harmonics, the base frequency among them.
    pub harmonics: usize,
    /// Degree of the polynomial; zero where the motion does not drift.
    pub degree: usize,
    /// Periods from which it was fitted.
    pub periods: f64,
    /// Start and end of the stretch in which the motion repeats, s.
    pub stretch_s: [f64; 2],
}

/// Bandwidths asked for, and measured by sending an impulse through the same code.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Bandwidth {
    /// Cut-off of the position filter asked for, Hz: each of its two passes is 3 dB down there.
    pub position_cutoff_hz: f64,
    /// Where the positions that come out are 3 dB down, Hz.
    pub position_measured_hz: Option<f64>,
    /// Where the accelerations that come out are 3 dB down, beside the two differentiations, Hz.
    pub acceleration_measured_hz: Option<f64>,
    /// Cut-off of the parallel filter, Hz: 0.8 of the decimated Nyquist frequency.
    pub decimation_cutoff_hz: f64,
    /// Where the rows that come out are 3 dB down, Hz.
    pub decimation_measured_hz: Option<f64>,
}

/// What was found in one recording.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RecordingFindings {
    /// The name of the recording, or its number.
    pub recording: String,
    /// Whether the recording is held back.
    pub held_back: bool,
    /// The findings, the gravest first.
    pub findings: Vec<Finding>,
}

impl RecordingFindings {
    /// Whether an estimate from it is not to be trusted.
    #[must_use]
    pub fn has_problem(&self) -> bool {
        self.findings.iter().any(|f| f.severity == Severity::Problem)
    }
}
