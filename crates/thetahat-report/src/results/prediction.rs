use super::verdict::{Verdict, VerdictReason};
use thetahat_estimation::identification::Method;
use thetahat_ground::series::Series;

/// Predicted torques over the whole record, and how they compare with the measured ones.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// The method that gave the parameters.
    pub method: Method,
    /// The case.
    pub case: String,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Predicted joint torques, N m or N.
    pub torque: Series,
    /// Measured joint torques, where there are any.
    pub measured: Option<Series>,
    /// Relative error in the decimated rows of the moving part, of all joints.
    pub relative_error_percent: Option<f64>,
    /// The same of each joint; none where its torque is zero.
    pub joint_relative_error_percent: Vec<Option<f64>>,
    /// Rms of the prediction of each joint in the moving part.
    pub rms: Vec<f64>,
    /// Moving part, s.
    pub window_s: [f64; 2],
    /// Names of the joints.
    pub joints: Vec<String>,
    /// The verdict on the results that the parameters come from.
    pub verdict: Verdict,
    /// Why it is not good.
    pub verdict_reasons: Vec<VerdictReason>,
}
