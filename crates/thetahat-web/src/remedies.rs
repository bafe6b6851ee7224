//! What the reader of the page can do about an error of the library: by the page's own controls, which the library does not know.

#![allow(
    clippy::wildcard_enum_match_arm,
    reason = "most errors have no remedy that only this program knows; they stay as they are"
)]

use std::error::Error;

use thetahat::{
    experiment::{ExperimentError, ProposalError},
    export::ExportError,
};

/// An error with its remedy, as the page shows it.
pub(crate) fn with_remedy(error: &(dyn Error + 'static)) -> String {
    match remedy(error) {
        Some(remedy) => format!("{error}; {remedy}"),
        None => error.to_string(),
    }
}

fn remedy(error: &(dyn Error + 'static)) -> Option<&'static str> {
    (error.downcast_ref().and_then(of_proposal))
        .or_else(|| error.downcast_ref().and_then(of_experiment))
        .or_else(|| error.downcast_ref().and_then(of_export))
}

/// The columns, units and locked joints are chosen under Corrections.
fn of_proposal(error: &ProposalError) -> Option<&'static str> {
    Some(match error {
        ProposalError::UnclearColumns { .. } | ProposalError::ColumnCount { .. } => {
            "choose a column for each joint under Corrections, or lock the joints that the log lacks"
        }
        ProposalError::SameColumn { .. } => "choose another column for one of them under Corrections",
        ProposalError::UnclearFile { .. } => {
            "choose its columns under Corrections, or rename them so that they say what they are"
        }
        ProposalError::UnclearUnit { .. } => "choose the unit or other columns under Corrections",
        ProposalError::Joints { .. } | ProposalError::NoSuchJoint { .. } | ProposalError::LockedAndNamed { .. } => {
            "correct the locked joints under Corrections"
        }
        ProposalError::NoTime { .. } => "state the samples per second under Corrections",
        ProposalError::RateContradictsTimes { .. } => "clear the samples per second under Corrections",
        _ => return None,
    })
}

fn of_experiment(error: &ExperimentError) -> Option<&'static str> {
    match error {
        ExperimentError::OutsideFolder { .. } => Some("add the file to the page"),
        _ => None,
    }
}

fn of_export(error: &ExportError) -> Option<&'static str> {
    match error {
        ExportError::Experiment(error) => of_experiment(error),
        _ => None,
    }
}
