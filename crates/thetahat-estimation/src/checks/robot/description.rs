//! Physically impossible values in the robot's description.

use crate::checks::finding::{Code, Finding, Severity};
use thetahat_model::robot::{Doubt, DoubtGrade, Robot};

/// The findings of a robot's description, which is used unchanged.
#[must_use]
pub fn examine_robot(robot: &Robot) -> Vec<Finding> {
    let finding = |doubt: &Doubt| Finding {
        code: Code::RobotDescription,
        severity: match doubt.grade {
            DoubtGrade::Impossible => Severity::Warning,
            DoubtGrade::Note => Severity::Note,
        },
        joint: None,
        joint_name: None,
        value: doubt.value,
        unit: doubt.unit.to_owned(),
        limit: match doubt.grade {
            DoubtGrade::Impossible => Some(0.0),
            DoubtGrade::Note => None,
        },
        message: format!("{}: {}", doubt.place, doubt.what),
        remedy: doubt.remedy.to_owned(),
        parameters: Vec::new(),
        step: None,
    };
    robot.doubts.iter().map(finding).collect()
}
