//! Isaac Lab's actuator settings: the arguments of `IdealPDActuatorCfg`, or of `DelayedPDActuatorCfg` where commands are late.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::drive::{Drive, Written, parsed};
use crate::export::{error::ExportError, pd_loop::Gains};

/// Values by patterns of names.
type OfJoints = BTreeMap<String, f64>;

#[derive(Serialize, Deserialize)]
struct Isaac {
    thetahat: String,
    content: String,
    robot: String,
    about: Vec<String>,
    least_version: String,
    class: String,
    step_s: f64,
    delay_s: f64,
    settings: Settings,
}

/// The arguments of the class.
#[derive(Serialize, Deserialize)]
struct Settings {
    joint_names_expr: Vec<String>,
    stiffness: OfJoints,
    damping: OfJoints,
    armature: OfJoints,
    friction: OfJoints,
    dynamic_friction: OfJoints,
    viscous_friction: OfJoints,
    #[serde(skip_serializing_if = "Option::is_none")]
    effort_limit: Option<OfJoints>,
    #[serde(skip_serializing_if = "Option::is_none")]
    min_delay: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_delay: Option<u32>,
}

pub(super) fn text(written: &Written<'_>) -> Result<(String, Vec<String>), ExportError> {
    let (pd, drives, steps) = (written.pd()?, written.drives(), written.steps_of_delay());
    let patterns: Vec<String> = drives.iter().map(|drive| pattern(&drive.joint)).collect();
    let of_drives = |of: fn(&Drive) -> f64| patterns.iter().cloned().zip(drives.iter().map(of)).collect::<OfJoints>();
    let of_gains = |of: fn(&Gains) -> f64| patterns.iter().cloned().zip(pd.gains.iter().map(of)).collect::<OfJoints>();
    let limits: Option<Vec<f64>> = pd.gains.iter().map(|gains| gains.limit).collect();
    // Steps are counted in whole numbers far below the largest.
    let late = (steps.count > 0.0).then_some(steps.count as u32);
    let mut notes = vec![
        "stiffness and damping: the gains of the controller; damping of the joints is viscous_friction; both frictions, static \
         and dynamic, are the Coulomb friction"
            .to_owned(),
        steps.note(),
    ];
    if limits.is_none() {
        notes.push("no limit of the torques is known: Isaac Lab takes that of the USD".to_owned());
    }
    let isaac = Isaac {
        thetahat: env!("CARGO_PKG_VERSION").to_owned(),
        content: "actuators".to_owned(),
        robot: written.represented.robot.name.clone(),
        about: written.said(&notes),
        least_version: "2.3".to_owned(),
        class: if late.is_some() { "DelayedPDActuatorCfg" } else { "IdealPDActuatorCfg" }.to_owned(),
        step_s: steps.step_s,
        delay_s: steps.delay_s,
        settings: Settings {
            stiffness: of_gains(|gains| gains.position),
            damping: of_gains(|gains| gains.velocity),
            armature: of_drives(|drive| drive.armature),
            friction: of_drives(|drive| drive.friction),
            dynamic_friction: of_drives(|drive| drive.friction),
            viscous_friction: of_drives(|drive| drive.damping),
            effort_limit: limits.map(|limits| patterns.iter().cloned().zip(limits).collect()),
            min_delay: late,
            max_delay: late,
            joint_names_expr: patterns,
        },
    };
    Ok((serde_json::to_string_pretty(&isaac)? + "\n", notes))
}

pub(super) fn read(text: &str) -> Result<Vec<Drive>, ExportError> {
    let Isaac { settings, .. } = parsed(text)?;
    let drive = |pattern: &String| {
        let of = |values: &OfJoints, key: &str| {
            values.get(pattern).copied().ok_or_else(|| ExportError::ReadBack { missing: format!("{key} of {pattern}") })
        };
        Ok(Drive {
            joint: pattern.replace('\\', ""),
            armature: of(&settings.armature, "armature")?,
            damping: of(&settings.viscous_friction, "viscous_friction")?,
            friction: of(&settings.friction, "friction")?,
        })
    };
    settings.joint_names_expr.iter().map(drive).collect()
}

/// The regular expression that a name alone matches.
fn pattern(name: &str) -> String {
    let mut pattern = String::with_capacity(name.len());
    for letter in name.chars() {
        if !letter.is_alphanumeric() && letter != '_' {
            pattern.push('\\');
        }
        pattern.push(letter);
    }
    pattern
}
