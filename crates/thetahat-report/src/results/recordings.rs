use serde::{Deserialize, Serialize};

use thetahat_data::recording::Resampling;
use thetahat_estimation::checks::{Finding, Severity};

/// A recording and the part of it that was used.
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
    /// Deviation of its time steps, if it was resampled to equal steps.
    pub resampling: Option<Resampling>,
    /// What was changed when it was read, in sentences.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Bandwidth of torques that were low-pass filtered before they were recorded, Hz; `null` for raw torques.
    #[serde(default, alias = "torque_ends_hz")]
    pub torque_bandwidth_hz: Option<f64>,
    /// Hold time of its torques, s, on which they were centred; zero for torques measured at their time stamps.
    #[serde(default)]
    pub torque_hold_s: f64,
    /// Samples near rest that were left out; `null` if all samples were used.
    #[serde(default)]
    pub near_rest: Option<NearRestResult>,
    /// The reference of its simulations.
    pub reference: Option<ReferenceResult>,
}

/// Samples left out because the sign of a velocity is not known there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NearRestResult {
    /// Velocity below which a coordinate is near rest, per coordinate, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Time on either side that is also left out, s.
    pub widened_s: f64,
    /// Share of each coordinate's samples that is left out, percent; zero for a coordinate that hardly moves, which keeps all.
    pub left_out_percent: Vec<f64>,
}

/// IDIM-LS with the samples near rest included.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnmaskedComparison {
    /// Its relative error, percent.
    pub relative_error_percent: f64,
    /// The parameter with the largest difference in standard deviations of the nominal estimate, with correlated
    /// errors.
    pub parameter: String,
    /// The difference.
    pub deviations: f64,
}

/// The origin of the simulations' reference, and how well it fits the recording.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ReferenceResult {
    /// `recorded`, `planned`, `reconstructed`, `periodic` or `filtered`.
    pub origin: String,
    /// Number of moves, if it consists of moves.
    pub moves: Option<usize>,
    /// The period, if it is periodic.
    #[serde(default)]
    pub periodic: Option<PeriodicResult>,
    /// Cut-off of the smoothing filter, Hz, if the reference is the measured motion itself, or its transients.
    #[serde(default)]
    pub smoothing_cutoff_hz: Option<f64>,
    /// Rms deviation of the recording from the reference in the window, per joint, rad or m.
    pub rms_deviation: Vec<f64>,
}

/// A Fourier series that was fitted to a recorded motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PeriodicResult {
    /// Base frequency, Hz.
    pub base_frequency_hz: f64,
    /// Number of harmonics, including the base frequency.
    pub harmonics: usize,
    /// Degree of the polynomial; zero without drift.
    pub degree: usize,
    /// Number of periods used for the fit.
    pub periods: f64,
    /// Start and end of the interval in which the motion repeats, s.
    pub stretch_s: [f64; 2],
}

/// Bandwidths requested, and measured with an impulse through the same code.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Bandwidth {
    /// Requested cut-off of the position filter, Hz: the -3 dB frequency of each of its two passes.
    pub position_cutoff_hz: f64,
    /// -3 dB frequency of the filtered positions, Hz.
    pub position_measured_hz: Option<f64>,
    /// -3 dB frequency of the accelerations, apart from the two differentiations, Hz.
    pub acceleration_measured_hz: Option<f64>,
    /// Cut-off of the parallel filter, Hz: 0.8 of the decimated Nyquist frequency.
    pub decimation_cutoff_hz: f64,
    /// -3 dB frequency of the decimated rows, Hz.
    pub decimation_measured_hz: Option<f64>,
}

/// The findings in one recording.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RecordingFindings {
    /// The name of the recording, or its number.
    pub recording: String,
    /// Whether the recording is held back for validation.
    pub held_back: bool,
    /// The findings, the most serious first.
    pub findings: Vec<Finding>,
}

impl RecordingFindings {
    /// Whether a problem was found: estimates from this recording cannot be trusted.
    #[must_use]
    pub fn has_problem(&self) -> bool {
        self.findings.iter().any(|f| f.severity == Severity::Problem)
    }
}
