//! What the command's user can do about an error of the library: by flags, which the library does not know.

#![allow(
    clippy::wildcard_enum_match_arm,
    reason = "most errors have no remedy that only this program knows; they stay as they are"
)]

use std::error::Error;

use thetahat::{
    campaign::CampaignError,
    design::DesignError,
    experiment::{ExperimentError, ProposalError},
    export::{ExportError, MjcfError},
    reduction::ReductionError,
    symbolic::SymbolicError,
};
use thetahat_ground::output::OutputError;
use thetahat_report::results::NoEstimate;

/// An error with its remedy, as the command prints it.
pub fn with_remedy(error: &(dyn Error + 'static)) -> String {
    match remedy(error) {
        Some(remedy) => format!("{error}; {remedy}"),
        None => error.to_string(),
    }
}

/// The remedy of an error, where flags are one.
fn remedy(error: &(dyn Error + 'static)) -> Option<String> {
    (error.downcast_ref().and_then(of_output))
        .or_else(|| error.downcast_ref().and_then(of_proposal))
        .or_else(|| error.downcast_ref().and_then(of_experiment))
        .or_else(|| error.downcast_ref().and_then(of_campaign))
        .or_else(|| error.downcast_ref().and_then(of_design))
        .or_else(|| error.downcast_ref().and_then(of_reduction))
        .or_else(|| error.downcast_ref().and_then(of_export))
        .or_else(|| error.downcast_ref().and_then(of_mjcf))
        .or_else(|| error.downcast_ref().and_then(of_symbolic))
        .or_else(|| error.downcast_ref().and_then(of_estimate))
}

fn of_output(error: &OutputError) -> Option<String> {
    let remedy = match error {
        OutputError::IsInput { .. } => "give another file or folder with --out",
        OutputError::NotAFile { .. } => "give the name of a file with --out",
        OutputError::NotAFolder { .. } => "give another folder with --out",
        OutputError::IsLink { .. } => "give a file or the link's target with --out",
        OutputError::NotOurs { .. } | OutputError::OfAnotherRobot { .. } | OutputError::MayHoldChanges { .. } => {
            "give another place with --out, or replace it with --force"
        }
        _ => return None,
    };
    Some(remedy.to_owned())
}

/// Columns and joints are named by the flags of `init`.
fn of_proposal(error: &ProposalError) -> Option<String> {
    const NAMES: &str = "NAME,NAME,...";
    Some(match error {
        ProposalError::UnclearColumns { signal, .. } => format!(
            "name them with --{signal} {NAMES}; where the log has fewer joints than the robot, name them with --joints {NAMES}: the others are locked"
        ),
        ProposalError::UnclearFile { file, .. } => {
            let file = file.display();
            format!("say it with --position {file}, --torque {file} or --time {file}")
        }
        ProposalError::UnclearUnit { signal, is_of_a_joint: true, .. } => format!(
            "name the columns in the order of the joints with --{signal} {NAMES}, or state the unit with --{signal}-unit UNIT"
        ),
        ProposalError::UnclearUnit { signal, is_of_a_joint: false, .. } => {
            let hint = if *signal == "torque" { " (1 for numbers that a gain turns into torques)" } else { "" };
            format!("state the unit with --{signal}-unit UNIT{hint}, or name other columns with --{signal} {NAMES}")
        }
        ProposalError::ColumnCount { signal, .. } => format!(
            "give as many with --{signal}; where the log lacks joints, name those that it has with --joints {NAMES}: the others \
             are locked"
        ),
        ProposalError::SameColumn { .. } => "name the columns of both with --position and --torque".to_owned(),
        ProposalError::Joints { .. } => "correct --joints".to_owned(),
        ProposalError::NoSuchJoint { .. } => "correct --lock".to_owned(),
        ProposalError::LockedAndNamed { .. } => "leave it out of --lock or of --joints".to_owned(),
        ProposalError::NotOfDriver { .. } => {
            "leave --from out, name another driver (--from list shows them), or describe this one in a file of your own"
                .to_owned()
        }
        ProposalError::NoTime { .. } => "name the column with --time NAME, or state the rate with --rate HZ".to_owned(),
        ProposalError::RateContradictsTimes { .. } => "leave --rate out".to_owned(),
        _ => return None,
    })
}

fn of_experiment(error: &ExperimentError) -> Option<String> {
    let remedy = match error {
        ExperimentError::UnknownRobotFile { .. } => "give --robot instead of --data",
        ExperimentError::NotTrusted { .. } => "or take them all the same with --untrusted",
        ExperimentError::RobotChanged { .. } => "for the description of then, leave out --robot and --data",
        ExperimentError::OutsideFolder { key, .. } if key == "robot" => "name a robot anywhere else with --robot",
        ExperimentError::NoEstimate { source, .. } => return of_estimate(source),
        _ => return None,
    };
    Some(remedy.to_owned())
}

fn of_campaign(error: &CampaignError) -> Option<String> {
    match error {
        CampaignError::Experiment(error) => of_experiment(error),
        CampaignError::NoParquet { .. } => Some("leave --out out".to_owned()),
        CampaignError::OtherCampaign { .. } | CampaignError::NoCampaign { .. } => {
            Some("give the folder with --out".to_owned())
        }
        _ => None,
    }
}

fn of_design(error: &DesignError) -> Option<String> {
    match error {
        DesignError::Experiment(error) => of_experiment(error),
        DesignError::Reduction(error) => of_reduction(error),
        _ => None,
    }
}

fn of_reduction(error: &ReductionError) -> Option<String> {
    match error {
        ReductionError::Experiment(error) => of_experiment(error),
        ReductionError::Apart { source, .. } => of_reduction(source),
        ReductionError::Unwritable { .. } => Some("name it with --out".to_owned()),
        _ => None,
    }
}

fn of_export(error: &ExportError) -> Option<String> {
    match error {
        ExportError::Experiment(error) => of_experiment(error),
        ExportError::Mjcf(error) => of_mjcf(error),
        ExportError::FollowsSeveral { .. } => Some("give --to json".to_owned()),
        ExportError::Loops { .. } => Some("give --to mjcf, --to json, or --into MODEL".to_owned()),
        ExportError::NoReader { .. } => Some("leave out --check".to_owned()),
        _ => None,
    }
}

fn of_mjcf(error: &MjcfError) -> Option<String> {
    match error {
        MjcfError::NotMjcf { .. } | MjcfError::Include { .. } => Some("name it with --into".to_owned()),
        _ => None,
    }
}

fn of_symbolic(error: &SymbolicError) -> Option<String> {
    let remedy = match error {
        SymbolicError::Channel { .. } => {
            "these are --model mass-matrix, gravity, coriolis, forward-kinematics and jacobian"
        }
        SymbolicError::Acceleration { .. } => "these are --model idm and regressor",
        SymbolicError::NoValues { .. } => "give --parameters symbolic, a results.json, or values under [parameters]",
        SymbolicError::NoIdentifier { .. } => "give one with --name, such as arm",
        _ => return None,
    };
    Some(remedy.to_owned())
}

fn of_estimate(error: &NoEstimate) -> Option<String> {
    match error {
        NoEstimate::NotAdvised { .. } => Some("name it with --method".to_owned()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    #[test]
    fn a_remedy_is_of_the_variant() {
        let error = OutputError::NotOurs { path: PathBuf::from("a.csv") };
        let text = "a.csv: exists and is not a file of this kind that thetahat wrote; give another place with --out, or replace it \
                    with --force";
        assert_eq!(with_remedy(&error), text);
    }

    #[test]
    fn an_error_without_a_remedy_of_flags_stays() {
        let error = OutputError::NoFolder { path: PathBuf::from("a") };
        assert_eq!(with_remedy(&error), error.to_string());
    }

    #[test]
    fn the_error_of_an_experiment_within_another_has_its_remedy() {
        let error =
            ExperimentError::NotTrusted { path: PathBuf::from("results.json"), reasons: vec!["a reason".into()] };
        let text = with_remedy(&ExportError::from(error));
        assert!(text.ends_with("; or take them all the same with --untrusted"), "{text}");
    }
}
