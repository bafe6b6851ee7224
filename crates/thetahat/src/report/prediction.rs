//! A prediction as a table for the terminal and as a CSV file.

use std::{fs, path::Path};

use super::ReportError;
use crate::experiment::Prediction;

/// Rms of each joint's prediction and, where torques were measured, its relative error.
#[must_use]
pub fn prediction_text(prediction: &Prediction) -> String {
    let [start, end] = prediction.window_s;
    let mut text = format!(
        "prediction of {} ({}), moving part {start:.3} s to {end:.3} s\n\n{:<24}{:>16}{:>20}\n",
        prediction.method.name(),
        prediction.case,
        "joint",
        "rms torque",
        "relative error %"
    );
    for (j, (joint, rms)) in prediction.joints.iter().zip(&prediction.rms).enumerate() {
        let error = percent(prediction.joint_relative_error_percent.get(j).copied().flatten());
        let joint: String = joint.chars().take(23).collect();
        text += &format!("{joint:<24}{rms:>16.4}{error:>20}\n");
    }
    text + &format!("{:<24}{:>16}{:>20}\n", "all", "", percent(prediction.relative_error_percent))
}

fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "not measured".to_owned(), |v| format!("{v:.4}"))
}

/// Writes time, predicted and, where there are any, measured joint torques, sample by sample; whole or not at all.
///
/// # Errors
/// [`ReportError`] where the file cannot be written.
pub fn write_prediction(prediction: &Prediction, path: &Path) -> Result<(), ReportError> {
    let refuse = |source| ReportError::Csv { source };
    let joints = prediction.torque.channels();
    let mut header = vec!["time_s".to_owned()];
    header.extend((1..=joints).map(|j| format!("predicted_{j}")));
    if prediction.measured.is_some() {
        header.extend((1..=joints).map(|j| format!("measured_{j}")));
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&header).map_err(refuse)?;
    for k in 0..prediction.torque.len() {
        let mut row = vec![k as f64 / prediction.sample_rate_hz];
        row.extend(prediction.torque.sample(k));
        row.extend(prediction.measured.iter().flat_map(|m| m.sample(k)));
        writer.write_record(row.iter().map(f64::to_string)).map_err(refuse)?;
    }
    let content = writer.into_inner().map_err(|e| ReportError::Csv { source: e.into_error().into() })?;
    let temporary = path.with_extension(format!("{}.part", std::process::id()));
    let write = fs::write(&temporary, content).and_then(|()| fs::rename(&temporary, path));
    write.map_err(|source| {
        // Where there is no temporary file, nothing is to be taken away.
        let _ = fs::remove_file(&temporary);
        ReportError::Write { path: path.to_owned(), source }
    })
}
