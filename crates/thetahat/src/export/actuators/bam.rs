//! BAM's parameters of one actuator with Coulomb and viscous friction, BAM's model `m1`. The actuator is `unitree_go1`: of those that
//! BAM knows, the one whose torque is `kp (goal - q) - damping dq`, clipped.

use serde::{Deserialize, Serialize};

use super::drive::{Drive, Written, parsed};
use crate::export::{error::ExportError, represented::RepresentedRobot, xml::number};

const ACTUATOR: &str = "unitree_go1";

#[derive(Serialize, Deserialize)]
struct Bam {
    thetahat: String,
    content: String,
    robot: String,
    about: Vec<String>,
    model: String,
    actuator: String,
    ratio: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_torque: Option<f64>,
    armature: f64,
    q_offset: f64,
    command_delay: f64,
    friction_base: f64,
    friction_viscous: f64,
}

pub(super) fn text(written: &Written<'_>) -> Result<(String, Vec<String>), ExportError> {
    let (pd, drives) = (written.pd()?, written.drives());
    let ([drive], [gains], [zero]) = (&drives[..], &pd.gains[..], written.zeros()) else {
        return Err(ExportError::SeveralActuators { joints: drives.len(), format: written.format.of_exports() });
    };
    let mut notes = vec![format!(
        "the gains are not in BAM's file; in its logs or its simulator they are kp {} N m/rad, to be multiplied by ratio, and \
         damping {} N m s/rad",
        number(gains.position / gains.ratio),
        number(gains.velocity)
    )];
    if gains.limit.is_none() {
        notes.push(format!("no limit of the torque is known: BAM takes that of {ACTUATOR}, 23.7 N m"));
    }
    let bam = Bam {
        thetahat: env!("CARGO_PKG_VERSION").to_owned(),
        content: "actuator".to_owned(),
        robot: written.represented.robot.name.clone(),
        about: written.said(&notes),
        model: "m1".to_owned(),
        actuator: ACTUATOR.to_owned(),
        ratio: gains.ratio,
        max_torque: gains.limit,
        armature: drive.armature,
        q_offset: *zero,
        command_delay: pd.delay_s.max(0.0),
        friction_base: drive.friction,
        friction_viscous: drive.damping,
    };
    Ok((serde_json::to_string_pretty(&bam)? + "\n", notes))
}

pub(super) fn read(text: &str, represented: &RepresentedRobot) -> Result<Vec<Drive>, ExportError> {
    let Bam { armature, friction_base, friction_viscous, .. } = parsed(text)?;
    let joints = represented.robot.coordinates().map(|joint| joint.name.clone());
    let drive = |joint| Drive { joint, armature, damping: friction_viscous, friction: friction_base };
    Ok(joints.map(drive).collect())
}
