//! Torques that the model explains no better than their mean: noise, or torques of something else.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::thinned_recording::ThinnedRecording,
    numbers::autocorrelation,
};

/// Rms residual of a joint per degree of freedom, percent of its torque's standard deviation. The clean recordings have at most 48
/// (recorded KUKA), twins with noise, heavy friction or Stribeck friction 9.
const LIMIT_PERCENT: f64 = 95.0;
/// Correlation of neighbouring rows below which a torque is noise: white noise after the parallel filter has 0.23.
const NOISE_CORRELATION: f64 = 0.4;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) {
    let Ok(fit) = recording.fit() else { return };
    for j in 0..recording.coordinates() {
        let torque = recording.rows_of(&fit.y, j);
        let is_noise = autocorrelation(torque) < NOISE_CORRELATION;
        let code = if is_noise { Code::TorqueNoise } else { Code::WorseThanMean };
        let value = 100.0 * fit.joint_error_per_freedom(j);
        let evidence =
            Evidence { code, coordinate: Some(j), value, unit: "% of the torque's deviation", limit: LIMIT_PERCENT };
        let (number, parameters) = (exam.subject.joint_number(j), exam.subject.parameter_names_of(j));
        exam.judge(evidence, Severity::Problem, || {
            let (message, remedy) = if is_noise {
                (
                    format!(
                        "joint {number}: the torque is noise: neighbouring rows are uncorrelated, and the model leaves {value:.0} % \
                         of its standard deviation"
                    ),
                    "check the torque's column, its scale and its digits: it does not depend on the motion",
                )
            } else {
                (
                    format!(
                        "joint {number}: the model predicts the torque no better than its mean does (it leaves {value:.0} % of its \
                         standard deviation)"
                    ),
                    "check that this column is this joint's torque, that it belongs to this motion, and the robot's geometry",
                )
            };
            FindingText::new(message, remedy).about(parameters)
        });
    }
}
