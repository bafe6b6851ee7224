//! What a gain is to hold, where the unit of a log alone gives no torque and no position.

use thetahat_data::recording::{Dimension, Side, Unit};

/// For torques in the unit of a drive, or in steps of so many units: what is to be filled in.
pub(super) fn gain_of_torque(unit: Unit, counts: Option<&str>, side: Side, scale: Option<f64>) -> Option<String> {
    let per = match unit.dimension() {
        Dimension::Torque | Dimension::Force => return None,
        Dimension::Current => "per A",
        Dimension::Voltage => "per V",
        Dimension::Dimensionless if unit == Unit::Percent => "at 100 %",
        Dimension::Dimensionless => "per count",
        Dimension::Angle
        | Dimension::Length
        | Dimension::AngularVelocity
        | Dimension::LinearVelocity
        | Dimension::AngularAcceleration
        | Dimension::LinearAcceleration
        | Dimension::Time => return None,
    };
    let what = match side {
        Side::Joint => format!("the torque at the joint {per} (N m, or N of a joint that slides)"),
        Side::Motor => format!("the torque of the motor {per} (N m)"),
    };
    let is = match (unit.dimension(), side) {
        (Dimension::Current, Side::Joint) => ", which is torque constant times gear ratio",
        (Dimension::Current, Side::Motor) => ", which is its torque constant",
        (Dimension::Dimensionless, Side::Joint) if unit == Unit::Percent => {
            ", which is the motor's nominal torque times gear ratio"
        }
        _ => "",
    };
    let or = match side {
        Side::Joint => "",
        Side::Motor => "; or leave gain out, and give the robot's transmission drive_gain",
    };
    let written = counts.unwrap_or_else(|| unit.symbol());
    let steps = scale.map(|scale| format!("steps of {scale} ")).unwrap_or_default();
    let times = scale.map(|scale| format!("{scale} times ")).unwrap_or_default();
    Some(format!(
        "The torque is written in {steps}{written}, which is no torque. Fill in gain = [...], a number for each column: \
         {times}{what}{is}{or}."
    ))
}

/// For positions in counts.
pub(super) fn gain_of_position(counts: &str) -> String {
    format!(
        "The position is written in {counts}, which is no angle and no length. Fill in gain = [...], a number for each column: \
         rad (m of a joint that slides) per count."
    )
}
