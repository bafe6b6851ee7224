//! The one verdict on all that a run yields.

use std::{collections::BTreeMap, fmt};

use serde::{Deserialize, Serialize};

use thetahat_estimation::{checks::Code, identification::Method};

/// What the results are good for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The numbers of the method that the advice takes can be used.
    Good,
    /// They can be used by somebody who has read the reasons.
    Care,
    /// They are not to be used.
    DoNotUse,
}

impl Verdict {
    /// Its name in `results.json`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Care => "care",
            Self::DoNotUse => "do-not-use",
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The rule by which a verdict is not good. Reasons that demand the same are sorted in this order: causes before what they cause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ReasonCode {
    /// The checks found a problem in a recording that was used.
    CheckProblem,
    /// Recordings are explained apart, and not together.
    RecordingsDisagree,
    /// A known payload contradicts the torques.
    DriveGain,
    /// A nominal run did not converge.
    NotConverged,
    /// Methods differ, and nothing tells which is wrong; or none has an estimate to take.
    Undecided,
    /// The model explains no joint better than a constant.
    NothingExplained,
    /// A joint is explained no better than by zero or a constant.
    JointNotExplained,
    /// Torques are later or earlier than positions.
    Lag,
    /// The checks warn of a recording that was used.
    CheckWarning,
    /// The estimate predicts what it has not seen much worse than what it was made from.
    CrossValidation,
    /// A joint is explained, but much of its torque is left.
    JointPoorlyExplained,
    /// No robot has the estimates.
    NotPhysical,
    /// Only a method is left whose simulator nothing tests.
    LastResort,
    /// The residual is no noise: the model lacks something.
    CorrelatedResidual,
    /// One move or recording decides an estimate.
    Influence,
    /// There are few rows for the parameters.
    FewRows,
}

impl ReasonCode {
    /// All codes, in order.
    pub const ALL: [Self; 16] = [
        Self::CheckProblem,
        Self::RecordingsDisagree,
        Self::DriveGain,
        Self::NotConverged,
        Self::Undecided,
        Self::NothingExplained,
        Self::JointNotExplained,
        Self::Lag,
        Self::CheckWarning,
        Self::CrossValidation,
        Self::JointPoorlyExplained,
        Self::NotPhysical,
        Self::LastResort,
        Self::CorrelatedResidual,
        Self::Influence,
        Self::FewRows,
    ];

    /// Its stable name, lower case with hyphens.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::CheckProblem => "check-problem",
            Self::RecordingsDisagree => "recordings-disagree",
            Self::DriveGain => "drive-gain",
            Self::NotConverged => "not-converged",
            Self::Undecided => "undecided",
            Self::NothingExplained => "nothing-explained",
            Self::JointNotExplained => "joint-not-explained",
            Self::JointPoorlyExplained => "joint-poorly-explained",
            Self::CrossValidation => "cross-validation",
            Self::NotPhysical => "not-physical",
            Self::LastResort => "last-resort",
            Self::CorrelatedResidual => "correlated-residual",
            Self::Influence => "influence",
            Self::Lag => "lag",
            Self::CheckWarning => "check-warning",
            Self::FewRows => "few-rows",
        }
    }
}

impl fmt::Display for ReasonCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a reason is about, as far as it is about one of them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ReasonSubject {
    /// The method.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub method: Option<Method>,
    /// The joint's name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// The parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameter: Option<String>,
    /// The recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<String>,
    /// The part of a record, or recording, that was left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// The finding of the checks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finding: Option<Code>,
}

/// Why the verdict is not good.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VerdictReason {
    /// The rule.
    pub code: ReasonCode,
    /// What this reason alone demands.
    pub verdict: Verdict,
    /// The evidence, and what it was compared with.
    pub numbers: BTreeMap<String, f64>,
    /// What it is about.
    #[serde(flatten)]
    pub concerned: ReasonSubject,
    /// The same in words, with what to do.
    pub text: String,
    /// What to do, alone; empty where it was read from a file of before that key.
    #[serde(default)]
    pub remedy: String,
}

/// A reason that the verdict does not know, because what decides of it was not there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NotExamined {
    /// The rule.
    pub code: ReasonCode,
    /// What was missing, in a sentence.
    pub why: String,
}
