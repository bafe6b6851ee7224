//! The file of each format of drives, and what is read of it.

use super::{bam, drive::Written, isaac, pace};
use crate::export::{error::ExportError, format::ActuatorFormat, represented::RepresentedRobot};
use thetahat_model::robot::{JointQuantity, Parameter, Quantity, Robot};

/// The file, and what else there is to say of it.
pub(in crate::export) fn text(written: &Written<'_>) -> Result<(String, Vec<String>), ExportError> {
    written.require_drives_of_joints()?;
    match written.format {
        ActuatorFormat::Pace => pace::text(written),
        ActuatorFormat::Isaac => isaac::text(written),
        ActuatorFormat::Bam => bam::text(written),
    }
}

/// The robot of `represented` with the drives of a file.
pub(in crate::export) fn read(
    format: ActuatorFormat,
    text: &str,
    represented: &RepresentedRobot,
) -> Result<Robot, ExportError> {
    let drives = match format {
        ActuatorFormat::Pace => pace::read(text)?,
        ActuatorFormat::Isaac => isaac::read(text)?,
        ActuatorFormat::Bam => bam::read(text, represented)?,
    };
    let mut robot = represented.robot.clone();
    let drive_of =
        |p: &Parameter| drives.iter().find(|drive| drive.joint == represented.robot.joints[p.number - 1].name);
    let value = |(parameter, own): (&Parameter, &f64)| {
        let Quantity::Joint(quantity) = parameter.quantity else { return Ok((parameter.name(), *own)) };
        let drive = drive_of(parameter).ok_or_else(|| ExportError::ReadBack { missing: parameter.name() })?;
        let read = match quantity {
            JointQuantity::Ia => drive.armature,
            JointQuantity::Fv => drive.damping,
            JointQuantity::Fc => drive.friction,
            JointQuantity::Fvp | JointQuantity::Fcp | JointQuantity::Fvn | JointQuantity::Fcn | JointQuantity::Off => {
                *own
            }
        };
        Ok((parameter.name(), read))
    };
    let values: Result<_, ExportError> = represented.table.iter().zip(&represented.parameters).map(value).collect();
    robot.a_priori = values?;
    Ok(robot)
}
