//! A prediction as a table for the terminal and as a CSV file.

use std::path::Path;

use super::{error::ReportError, series::write_series, verdict, wrap::TextWidth};
use crate::results::Prediction;
use thetahat_ground::visible::visible;

/// Rms of each joint's prediction, its relative error if torques were measured, and the verdict on its parameters.
#[must_use]
pub fn prediction_text(prediction: &Prediction, width: TextWidth) -> String {
    let [start, end] = prediction.window_s;
    let mut text = format!(
        "prediction of {} ({}), window {start:.3} s to {end:.3} s\n\n{:<24}{:>16}{:>20}\n",
        prediction.method.name(),
        visible(&prediction.case),
        "joint",
        "rms, N m or N",
        "relative error %"
    );
    for (j, (joint, rms)) in prediction.joints.iter().zip(&prediction.rms).enumerate() {
        let error = percent(prediction.joint_relative_error_percent.get(j).copied().flatten());
        let joint: String = visible(joint).chars().take(23).collect();
        text += &format!("{joint:<24}{rms:>16.4}{error:>20}\n");
    }
    text += &format!("{:<24}{:>16}{:>20}\n", "all", "", percent(prediction.relative_error_percent));
    text + "\n" + &verdict::inherited(prediction.verdict, &prediction.verdict_reasons, width)
}

fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "not measured".to_owned(), |v| format!("{v:.4}"))
}

/// Writes time, predicted and, if available, measured joint torques, sample by sample; atomically.
///
/// # Errors
/// [`ReportError`] where the file cannot be written.
pub fn write_prediction(prediction: &Prediction, path: &Path) -> Result<(), ReportError> {
    let mut columns = vec![("predicted", &prediction.torque)];
    columns.extend(prediction.measured.as_ref().map(|m| ("measured", m)));
    write_series(prediction.sample_rate_hz, &columns, path)
}
