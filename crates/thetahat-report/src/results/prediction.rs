use super::{
    estimate::EstimateSource,
    verdict::{Verdict, VerdictReason},
};
use thetahat_ground::series::Series;

/// Predicted torques over a whole recording, and their comparison with the measured torques.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// What the parameters come from.
    pub source: EstimateSource,
    /// The case.
    pub case: String,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Predicted joint torques, N m or N.
    pub torque: Series,
    /// Measured joint torques, if there are any.
    pub measured: Option<Series>,
    /// Relative error in the decimated rows of the window, of all joints, without the samples near rest.
    pub relative_error_percent: Option<f64>,
    /// The same of each joint; none if its torque is zero.
    pub joint_relative_error_percent: Vec<Option<f64>>,
    /// Relative error in the decimated rows of all samples of the window, of all joints.
    pub all_samples_error_percent: Option<f64>,
    /// The same of each joint.
    pub joint_all_samples_error_percent: Vec<Option<f64>>,
    /// Part of each joint's samples in the window that are near rest, from 0 to 1.
    pub near_rest: Vec<f64>,
    /// Deviation of each joint's torque, percent of its rms, that belief and recordings leave to the parameters of the model on
    /// this motion; empty for the estimates of a run.
    pub left_open_percent: Vec<f64>,
    /// How many times the motion exceeds the largest speed and acceleration of the recordings, joint by joint: one or less where it
    /// does not. Empty where these are not known.
    pub beyond: Vec<[f64; 2]>,
    /// Rms of the prediction of each joint in the moving part.
    pub rms: Vec<f64>,
    /// Moving part, s.
    pub window_s: [f64; 2],
    /// Names of the joints.
    pub joints: Vec<String>,
    /// The verdict on the results with the parameters.
    pub verdict: Verdict,
    /// Why the verdict is not good.
    pub verdict_reasons: Vec<VerdictReason>,
}
