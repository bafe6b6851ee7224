//! Steps whose size is an estimate from the recordings.

use super::candidate::Candidate;
use crate::preparation::EstimatedSize;
use thetahat_estimation::checks::Code;
use thetahat_model::robot::Robot;
use thetahat_report::results::RemedyStep;

/// The size that a step has from the recordings; absent if it is a unit, a sign or a side.
pub(super) fn estimated_size(candidate: &Candidate, robot: &Robot) -> Option<EstimatedSize> {
    let number = |coordinate: usize| robot.joint_of(coordinate) + 1;
    match &candidate.step.step {
        RemedyStep::Scale { position, torque } => {
            // Other findings are of factors that are known.
            let is_estimate = candidate.cause.is_some() || candidate.finding == Some(Code::GearRatio);
            let scaled = |factors: &[f64]| factors.iter().position(|factor| *factor != 1.0).map(number);
            match (scaled(position), scaled(torque)) {
                (Some(joint), Some(_)) => Some(EstimatedSize::GearRatio(joint)),
                (Some(joint), None) => Some(EstimatedSize::PositionScale(joint)),
                (None, Some(joint)) => Some(EstimatedSize::DriveGain(joint)),
                (None, None) => None,
            }
            .filter(|_| is_estimate)
        }
        RemedyStep::Delay { joints, .. } => match joints[..] {
            [] => Some(EstimatedSize::Lag(None)),
            [joint] => Some(EstimatedSize::Lag(Some(number(joint - 1)))),
            [..] => None,
        },
        RemedyStep::Gravity { gravity } => gravity.iter().any(|g| *g != 0.0).then_some(EstimatedSize::GravityDirection),
        RemedyStep::LowPass { .. } => Some(EstimatedSize::TorqueFilter),
        RemedyStep::OrderJoints { .. }
        | RemedyStep::Side { .. }
        | RemedyStep::Hold
        | RemedyStep::Cutoff { .. }
        | RemedyStep::EqualSteps { .. }
        | RemedyStep::LeaveOutRests
        | RemedyStep::LeaveOutTimes { .. }
        | RemedyStep::Essential { .. }
        | RemedyStep::CorrectReference { .. }
        | RemedyStep::LockJoint { .. }
        | RemedyStep::AddTerm { .. }
        | RemedyStep::Estimated { .. } => None,
    }
}
