//! Results from recordings with a payload.

use serde::{Deserialize, Serialize};

/// A payload that was estimated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PayloadResult {
    /// Its name.
    pub name: String,
    /// The joint whose link carries it.
    pub joint: String,
    /// The recordings with this payload.
    pub recordings: Vec<String>,
    /// `100 |y - y_hat| / |y|` of the robot with the payload, over the rows of its recordings.
    pub relative_error_percent: f64,
    /// Its ten parameters in its frame, about the frame's origin.
    pub parameters: Vec<PayloadParameter>,
    /// The centre of mass in its frame, m; `null` if mass or first moments are not identified.
    pub centre_m: Option<[f64; 3]>,
    /// Whether the parameters are physically consistent; `null` if some of them are not identified.
    pub is_physical: Option<bool>,
    /// The consistent parameters closest to them in the metric of their covariance.
    pub physical: Option<Vec<f64>>,
}

/// A parameter of a payload.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PayloadParameter {
    /// Name: `xx` to `zz`, `mx` to `mz`, `m`.
    pub name: String,
    /// Unit in SI.
    pub unit: String,
    /// The estimate; `null` if the motion does not identify it.
    pub estimate: Option<f64>,
    /// Its standard deviation with correlated errors.
    pub standard_deviation: Option<f64>,
    /// Its 95 % interval.
    pub interval_95: Option<[f64; 2]>,
}

/// The gain of a joint's drive from recordings with and without a known payload.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriveGainResult {
    /// The joint.
    pub joint: String,
    /// True torque over the torque recorded with the stated gain; `null` if it is not identifiable.
    pub factor: Option<f64>,
    /// Its standard deviation with correlated errors.
    pub standard_deviation: Option<f64>,
    /// Its 95 % interval.
    pub interval_95: Option<[f64; 2]>,
    /// Root mean square of the torque that the payload causes at this joint, N m or N.
    pub payload_rms: f64,
    /// Why there is no factor.
    pub reason: Option<String>,
}

impl DriveGainResult {
    /// Whether the payload contradicts the recorded torque.
    #[must_use]
    pub fn contradicts(&self) -> bool {
        self.differs_by(OF_FRICTION)
    }

    /// Whether the factor is so far from one that recordings with and without the payload contradict each other by it.
    #[must_use]
    pub fn can_make_recordings_disagree(&self) -> bool {
        self.differs_by(SMALLEST)
    }

    fn differs_by(&self, least: f64) -> bool {
        let outside = self.interval_95.is_some_and(|[low, high]| low > 1.0 || high < 1.0);
        outside && self.factor.is_some_and(|factor| (factor - 1.0).abs() > least)
    }
}

/// Largest deviation of a gain from one that load-dependent friction can cause.
const OF_FRICTION: f64 = 0.1;
/// Smallest deviation of a gain from one that is worth a sentence.
const SMALLEST: f64 = 0.02;
