//! What a caller of the package can do about an error of the library: by arguments, which the library does not know.

#![allow(
    clippy::wildcard_enum_match_arm,
    reason = "most errors have no remedy that only this program knows; they stay as they are"
)]

use thetahat::{
    experiment::{ExperimentError, ProposalError},
    export::ExportError,
};
use thetahat_ground::output::OutputError;
use thetahat_report::results::NoEstimate;

pub fn of_output(error: &OutputError) -> Option<String> {
    let remedy = match error {
        OutputError::IsInput { .. } | OutputError::NotAFile { .. } => "give another file",
        OutputError::NotAFolder { .. } => "give another folder",
        OutputError::IsLink { .. } => "give a file or the link's target",
        OutputError::NotOurs { .. } | OutputError::OfAnotherRobot { .. } | OutputError::MayHoldChanges { .. } => {
            "give another place, or replace it with force=True"
        }
        _ => return None,
    };
    Some(remedy.to_owned())
}

/// The folder of a campaign, in which files of others are never replaced.
pub fn of_campaign_folder(error: &OutputError) -> Option<String> {
    let remedy = match error {
        OutputError::NotOurs { .. } | OutputError::OfAnotherRobot { .. } | OutputError::MayHoldChanges { .. } => {
            "take another `out`"
        }
        OutputError::IsInput { .. }
        | OutputError::IsLink { .. }
        | OutputError::NotAFile { .. }
        | OutputError::NotAFolder { .. } => "give another folder with `out`",
        _ => return None,
    };
    Some(remedy.to_owned())
}

/// The arguments of `Recording.read`.
pub fn of_proposal(error: &ProposalError) -> Option<String> {
    Some(match error {
        ProposalError::UnclearColumns { signal, .. } => {
            format!("name them with `{signal}`; where the log has fewer joints than the robot, name them with `joints`")
        }
        ProposalError::UnclearFile { .. } => "name its columns with `position`, `torque` or `time`".to_owned(),
        ProposalError::UnclearUnit { signal, is_of_a_joint: true, .. } => format!(
            "name the columns in the order of the joints with `{signal}`, or state the unit with `{signal}_unit`"
        ),
        ProposalError::UnclearUnit { signal, is_of_a_joint: false, .. } => {
            let hint = if *signal == "torque" { " (\"1\" for numbers that a gain turns into torques)" } else { "" };
            format!("state the unit with `{signal}_unit`{hint}, or name other columns with `{signal}`")
        }
        ProposalError::ColumnCount { signal, .. } => format!(
            "give as many with `{signal}`; where the log lacks joints, name those that it has with `joints`, and lock the others"
        ),
        ProposalError::SameColumn { .. } => "name the columns of both with `position` and `torque`".to_owned(),
        ProposalError::Joints { .. } => "correct `joints`".to_owned(),
        ProposalError::NoSuchJoint { .. } => "correct `locked`".to_owned(),
        ProposalError::LockedAndNamed { .. } => "leave it out of `locked` or of `joints`".to_owned(),
        ProposalError::NoTime { .. } => "name the column with `time`, or state `sample_rate_hz`".to_owned(),
        ProposalError::RateContradictsTimes { .. } => "leave `sample_rate_hz` out".to_owned(),
        _ => return None,
    })
}

pub fn of_experiment(error: &ExperimentError) -> Option<String> {
    match error {
        ExperimentError::NotTrusted { .. } => Some("or take them all the same with untrusted=True".to_owned()),
        ExperimentError::OutsideFolder { key, .. } if key == "robot" => {
            Some("name a robot anywhere else with `robot`".to_owned())
        }
        ExperimentError::NoEstimate { source: NoEstimate::NotAdvised { .. }, .. } => {
            Some("name it with `method`".to_owned())
        }
        _ => None,
    }
}

pub fn of_export(error: &ExportError) -> Option<String> {
    match error {
        ExportError::Experiment(error) => of_experiment(error),
        _ => None,
    }
}
