//! PACE's vector of parameters: armatures, viscous frictions, frictions and encoder biases of all joints, and one delay in steps.

use serde::{Deserialize, Serialize};

use super::drive::{Drive, Written, parsed};
use crate::export::error::ExportError;

/// Numbers of each joint in the vector.
const OF_A_JOINT: usize = 4;

#[derive(Serialize, Deserialize)]
struct Pace {
    thetahat: String,
    content: String,
    robot: String,
    about: Vec<String>,
    least_version: String,
    delay_mode: String,
    joint_order: Vec<String>,
    step_s: f64,
    delay_s: f64,
    /// Gains of the controller in the order of the joints, if they are known.
    stiffness: Option<Vec<f64>>,
    damping: Option<Vec<f64>>,
    params: Vec<f64>,
}

pub(super) fn text(written: &Written<'_>) -> Result<(String, Vec<String>), ExportError> {
    let (drives, steps) = (written.drives(), written.steps_of_delay());
    let notes = vec![
        "params: armature, damping (viscous friction), friction and bias of the joints in joint_order, then the delay of the \
         commands in steps; a joint is at the position of its encoder plus its bias"
            .to_owned(),
        steps.note(),
    ];
    let column = |of: fn(&Drive) -> f64| drives.iter().map(of).collect::<Vec<f64>>();
    let of_joints = [column(|d| d.armature), column(|d| d.damping), column(|d| d.friction), written.zeros().to_vec()];
    let pace = Pace {
        thetahat: env!("CARGO_PKG_VERSION").to_owned(),
        content: "actuators".to_owned(),
        robot: written.represented.robot.name.clone(),
        about: written.said(&notes),
        least_version: "0.2".to_owned(),
        delay_mode: "command".to_owned(),
        joint_order: drives.iter().map(|drive| drive.joint.clone()).collect(),
        step_s: steps.step_s,
        delay_s: steps.delay_s,
        stiffness: written.pd.map(|pd| pd.gains.iter().map(|gains| gains.position).collect()),
        damping: written.pd.map(|pd| pd.gains.iter().map(|gains| gains.velocity).collect()),
        params: of_joints.concat().into_iter().chain([steps.count]).collect(),
    };
    Ok((serde_json::to_string_pretty(&pace)? + "\n", notes))
}

pub(super) fn read(text: &str) -> Result<Vec<Drive>, ExportError> {
    let Pace { joint_order, params, .. } = parsed(text)?;
    let joints = joint_order.len();
    if params.len() != OF_A_JOINT * joints + 1 {
        return Err(ExportError::ReadBack { missing: format!("{} params", OF_A_JOINT * joints + 1) });
    }
    let drive = |(j, joint): (usize, String)| Drive {
        joint,
        armature: params[j],
        damping: params[joints + j],
        friction: params[2 * joints + j],
    };
    Ok(joint_order.into_iter().enumerate().map(drive).collect())
}
