//! A step that a remedy may consist of.

use thetahat_estimation::checks::Code;
use thetahat_report::results::{CauseKind, RecordingStep, RemedyStep};

/// A step with the code under which it is asked for.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub(super) code: String,
    /// The joint of the finding, by its coordinate from zero.
    pub(super) coordinate: Option<usize>,
    pub(super) found: String,
    pub(super) finding: Option<Code>,
    /// Findings of earlier links of its chain.
    pub(super) also: Vec<Code>,
    pub(super) cause: Option<CauseKind>,
    pub(super) step: RecordingStep,
    /// Steps before it, which it holds after.
    pub(super) before: Vec<RecordingStep>,
}

/// Whether a step changes the description of a recording.
pub(super) fn is_of_recording(step: &RemedyStep) -> bool {
    match step {
        RemedyStep::OrderJoints { .. }
        | RemedyStep::Scale { .. }
        | RemedyStep::Side { .. }
        | RemedyStep::Delay { .. }
        | RemedyStep::Hold
        | RemedyStep::LowPass { .. }
        | RemedyStep::EqualSteps { .. }
        | RemedyStep::LeaveOutTimes { .. }
        | RemedyStep::CorrectReference { .. } => true,
        RemedyStep::Cutoff { .. }
        | RemedyStep::LeaveOutRests
        | RemedyStep::Essential { .. }
        | RemedyStep::LockJoint { .. }
        | RemedyStep::AddTerm { .. }
        | RemedyStep::Gravity { .. }
        | RemedyStep::Estimated { .. } => false,
    }
}

/// Whether it changes positions.
pub(super) fn moves_position(step: &RemedyStep) -> bool {
    match step {
        RemedyStep::OrderJoints { signal, .. } | RemedyStep::Side { signal, .. } => signal.has_position(),
        RemedyStep::Scale { position, .. } => !position.is_empty(),
        RemedyStep::Delay { .. }
        | RemedyStep::Hold
        | RemedyStep::LowPass { .. }
        | RemedyStep::EqualSteps { .. }
        | RemedyStep::CorrectReference { .. }
        | RemedyStep::Cutoff { .. }
        | RemedyStep::LeaveOutRests
        | RemedyStep::LeaveOutTimes { .. }
        | RemedyStep::Essential { .. }
        | RemedyStep::LockJoint { .. }
        | RemedyStep::AddTerm { .. }
        | RemedyStep::Gravity { .. }
        | RemedyStep::Estimated { .. } => false,
    }
}
