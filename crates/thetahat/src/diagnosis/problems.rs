//! Problems of the recordings that decide what of an estimate can be taken.

use thetahat_estimation::checks::{Code, Finding, Severity};
use thetahat_report::results::{JointResidual, NOMINAL, RecordingFindings, Results, RunResult};

/// What a problem makes worthless.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Concern {
    /// Every number.
    All,
    /// The numbers of its joint.
    Joint,
    /// What the estimators notice by themselves, or what concerns no estimate.
    None,
}

/// The problems of the recordings that are identified from.
#[derive(Debug, Clone, Default)]
pub(super) struct Problems {
    /// Those that make every number worthless: code and recording.
    all: Vec<String>,
    /// Joints whose numbers are worthless, from one, with the codes.
    joints: Vec<(usize, Vec<Code>)>,
}

impl Problems {
    /// The problems of all recordings, and of what the runs of a case make of them. Problems of more than half of the joints are
    /// problems of all.
    pub(super) fn of(findings: &[RecordingFindings], runs: &[&RunResult]) -> Self {
        let joint_count = runs.iter().map(|r| r.joint_relative_error_percent.len()).max().unwrap_or(0);
        let used = findings.iter().filter(|r| !r.held_back);
        let all = used.flat_map(|r| r.findings.iter().map(move |f| (r.recording.as_str(), f)));
        let mut problems = Self::default();
        for (recording, finding) in all.filter(|(_, f)| f.severity == Severity::Problem) {
            problems.add(recording, finding);
        }
        if explain_nothing(runs) {
            problems.all.push("no torque is explained better than by a constant".to_owned());
        }
        if 2 * problems.joints.len() > joint_count {
            problems.joints.iter().for_each(|(joint, codes)| {
                problems.all.push(format!("{} of joint {joint}", names(codes)));
            });
        }
        problems
    }

    fn add(&mut self, recording: &str, finding: &Finding) {
        match (concern(finding.code), finding.joint) {
            (Concern::None, _) => {}
            (Concern::All, _) | (Concern::Joint, None) => {
                let problem = format!("{} in {}", finding.code, place(recording));
                if !self.all.contains(&problem) {
                    self.all.push(problem);
                }
            }
            (Concern::Joint, Some(joint)) => match self.joints.iter_mut().find(|(j, _)| *j == joint) {
                Some((_, codes)) if codes.contains(&finding.code) => {}
                Some((_, codes)) => codes.push(finding.code),
                None => self.joints.push((joint, vec![finding.code])),
            },
        }
    }

    #[cfg(test)]
    pub(super) fn all_of(problem: &str) -> Self {
        Self { all: vec![problem.to_owned()], joints: Vec::new() }
    }

    /// Whether no estimate is to be taken.
    pub(super) fn refuse_all(&self) -> bool {
        !self.all.is_empty()
    }

    /// Why none is.
    pub(super) fn refusal(&self) -> String {
        let (problem, it) =
            if self.all.len() == 1 { ("a problem that makes", "it") } else { ("problems that make", "them") };
        let all = self.all.join(", ");
        format!("Take none of these estimates: the recordings have {problem} them false ({all}). Solve {it} first.")
    }

    /// The joints whose numbers are not to be taken; empty where there are none.
    pub(super) fn on_joints(&self) -> String {
        if self.joints.is_empty() {
            return String::new();
        }
        let joints: Vec<String> =
            self.joints.iter().map(|(j, codes)| format!("joint {j} ({})", names(codes))).collect();
        format!("Do not take the parameters of {}.", joints.join(", "))
    }
}

/// A recording in words, as findings name it.
pub(super) fn place(recording: &str) -> String {
    let is_said = recording.starts_with("all ") || recording.starts_with("robot ");
    if is_said { recording.to_owned() } else { format!("recording {recording}") }
}

/// Whether the findings of results make every number worthless.
pub(super) fn refuse_all(results: &Results) -> bool {
    let nominal: Vec<&RunResult> = results.runs.iter().filter(|r| r.case == NOMINAL).collect();
    Problems::of(&results.findings, &nominal).refuse_all()
}

/// Whether chance is enough to explain what the runs explain of any joint.
fn explain_nothing(runs: &[&RunResult]) -> bool {
    let by_chance = |joint: &JointResidual| joint.explained.is_some_and(|e| e.is_by_chance());
    let mut tested = runs.iter().flat_map(|r| &r.residual).flat_map(|r| &r.joints).peekable();
    tested.peek().is_some() && tested.all(by_chance)
}

fn names(codes: &[Code]) -> String {
    codes.iter().map(|c| c.name()).collect::<Vec<_>>().join(", ")
}

fn concern(code: Code) -> Concern {
    match code {
        Code::PositionScale
        | Code::PositionSign
        | Code::PositionZero
        | Code::TorqueScale
        | Code::TorqueSign
        | Code::JointsSwapped
        | Code::GearRatio
        | Code::PositionJump
        | Code::APrioriScale
        | Code::WrongRobot
        | Code::GravityDirection
        | Code::SameRecording
        | Code::RateContradicted
        | Code::TimeScale
        | Code::ExternalForce
        | Code::TorqueSaturated
        | Code::TorqueCopied
        | Code::RecordingsContradict
        | Code::ControllerMismatch => Concern::All,
        Code::TorqueConstant
        | Code::TorqueIdle
        | Code::TorqueNoise
        | Code::JointStill
        | Code::JointDither
        | Code::NegativeFriction
        | Code::WorseThanMean => Concern::Joint,
        Code::Lag
        | Code::DroppedSamples
        | Code::RepeatedSamples
        | Code::ClockJitter
        | Code::TorqueQuantised
        | Code::TorqueSpikes
        | Code::PositionQuantised
        | Code::PositionSpikes
        | Code::VelocityMismatch
        | Code::StillPeriod
        | Code::CutoffLow
        | Code::CutoffHigh
        | Code::PoorFit
        | Code::NotExcited
        | Code::ReferenceMismatch
        | Code::GainDrift
        | Code::FrictionDrift
        | Code::NotPhysical
        | Code::RobotDescription
        | Code::EquationsUsed => Concern::None,
    }
}
