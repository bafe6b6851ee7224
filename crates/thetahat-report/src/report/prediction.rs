//! A prediction as a table for the terminal and as a CSV file.

use std::path::Path;

use super::{
    error::ReportError,
    number::significant,
    series::write_series,
    verdict,
    wrap::{TextWidth, wrap},
};
use crate::results::Prediction;
use thetahat_ground::visible::visible;

/// Times the largest speed or acceleration of the recordings from which a motion is far outside of them.
const FAR_BEYOND: f64 = 3.0;

/// Rms of each joint's prediction, its relative error where the joint moves and on all samples if torques were measured, the
/// part of the samples near rest, and the verdict on its parameters.
#[must_use]
pub fn prediction_text(prediction: &Prediction, width: TextWidth) -> String {
    let [start, end] = prediction.window_s;
    let mut text = format!(
        "prediction of {} ({}), window {start:.3} s to {end:.3} s\n\n{:<20}{:>14}{:>16}{:>14}{:>13}\n",
        prediction.source.name(),
        visible(&prediction.case),
        "joint",
        "rms, N m or N",
        "error %, moving",
        "all samples",
        "near rest %"
    );
    for (j, (joint, rms)) in prediction.joints.iter().zip(&prediction.rms).enumerate() {
        let [moving, all] = [&prediction.joint_relative_error_percent, &prediction.joint_all_samples_error_percent]
            .map(|errors| percent(errors.get(j).copied().flatten()));
        let near_rest = 100.0 * prediction.near_rest.get(j).copied().unwrap_or(0.0);
        let joint: String = visible(joint).chars().take(19).collect();
        text += &format!("{joint:<20}{rms:>14.4}{moving:>16}{all:>14}{near_rest:>13.1}\n");
    }
    let [moving, all] = [prediction.relative_error_percent, prediction.all_samples_error_percent].map(percent);
    text += &format!("{:<20}{:>14}{moving:>16}{all:>14}\n", "all joints", "");
    if prediction.near_rest.iter().any(|part| *part > 0.0) {
        text += "moving: without the samples near rest, where the friction's sign is not known\n";
    }
    text += &left_open(prediction, width);
    text += &beyond(prediction, width);
    text + "\n" + &verdict::inherited(prediction.verdict, &prediction.verdict_reasons, width)
}

/// How far belief and recordings determine the torques of this motion.
fn left_open(prediction: &Prediction, width: TextWidth) -> String {
    if prediction.left_open_percent.is_empty() {
        return String::new();
    }
    let joints = prediction.joints.iter().zip(&prediction.left_open_percent);
    let each: Vec<String> =
        joints.map(|(joint, open)| format!("{} {} %", visible(joint), significant(*open, 2))).collect();
    let text = format!(
        "left open on this motion by the recordings and the a-priori robot, as a deviation of each torque: {}",
        each.join(", ")
    );
    wrap(&text, "", width)
}

/// The joints whose motion is far outside of the recordings: the model was never tested there.
fn beyond(prediction: &Prediction, width: TextWidth) -> String {
    let joints = prediction.joints.iter().zip(&prediction.beyond);
    let each: Vec<String> = joints.filter_map(|(joint, times)| beyond_at(joint, *times)).collect();
    if each.is_empty() {
        return String::new();
    }
    let text = format!(
        "WARNING: this motion is far outside of the recordings, where no error of the model is known: {}. Record motion like this one, \
         and identify with it",
        each.join("; ")
    );
    wrap(&text, "", width)
}

fn beyond_at(joint: &str, [speed, acceleration]: [f64; 2]) -> Option<String> {
    let exceeds = |times: f64, what: &str| {
        let far = if times.is_finite() { format!("{} times", significant(times, 2)) } else { "far above".to_owned() };
        (times > FAR_BEYOND).then(|| format!("{far} their largest {what}"))
    };
    let both: Vec<String> =
        [exceeds(speed, "speed"), exceeds(acceleration, "acceleration")].into_iter().flatten().collect();
    (!both.is_empty()).then(|| format!("{} {}", visible(joint), both.join(" and ")))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_far_beyond_is_named() {
        assert_eq!(beyond_at("base", [2.9, 1.0]), None);
        assert_eq!(beyond_at("base", [40.0, 2.0]).as_deref(), Some("base 40 times their largest speed"));
        let both = Some("base 40 times their largest speed and 10 times their largest acceleration");
        assert_eq!(beyond_at("base", [40.0, 10.0]).as_deref(), both);
    }
}
