//! The verdict on the results of a run.

use std::{collections::BTreeMap, fmt};

use serde::{Deserialize, Serialize};

use super::cause::CauseKind;
use thetahat_estimation::{checks::Code, identification::Method};

/// Whether the results can be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The model can be used; without a model, the numbers of the recommended method.
    Good,
    /// They can be used after reading the reasons.
    Care,
    /// They must not be used.
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

/// The rule that makes a verdict worse than good. Reasons with the same verdict are sorted in this order: causes before effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ReasonCode {
    /// The checks found a problem in a recording that was used.
    CheckProblem,
    /// A known payload contradicts the torques.
    DriveGain,
    /// Separate fits explain the recordings, a common fit does not.
    RecordingsDisagree,
    /// A nominal run did not converge.
    NotConverged,
    /// Methods differ and no test shows which is wrong, or no method has a usable estimate.
    Undecided,
    /// The model explains no joint better than a constant torque.
    NothingExplained,
    /// A joint is explained no better than by zero or a constant.
    JointNotExplained,
    /// Torques are later or earlier than positions.
    Lag,
    /// The checks warn of a recording that was used.
    CheckWarning,
    /// The estimate predicts data not used much worse than the data of the fit.
    CrossValidation,
    /// A joint is explained, but much of its torque remains unexplained.
    JointPoorlyExplained,
    /// The estimates are physically inconsistent.
    NotPhysical,
    /// The only remaining method has a simulator that no test has checked.
    LastResort,
    /// The residual is not noise: effects are missing in the model.
    CorrelatedResidual,
    /// One move or recording dominates an estimate.
    Influence,
    /// There are few rows per parameter.
    FewRows,
    /// The residual shows what the model or the recordings are wrong in.
    Cause,
    /// The file of the results was changed after it was written.
    ChangedFile,
}

impl ReasonCode {
    /// All codes, in order.
    pub const ALL: [Self; 18] = [
        Self::CheckProblem,
        Self::DriveGain,
        Self::RecordingsDisagree,
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
        Self::Cause,
        Self::ChangedFile,
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
            Self::Cause => "cause",
            Self::ChangedFile => "changed-file",
        }
    }
}

impl fmt::Display for ReasonCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The subject of a reason: the fields that apply are set.
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
    /// The part of a recording, or the recording, that was left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// The finding of the checks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finding: Option<Code>,
    /// The cause that the model names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<CauseKind>,
}

/// Why the verdict is not good.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VerdictReason {
    /// The rule.
    pub code: ReasonCode,
    /// The verdict that this reason alone requires.
    pub verdict: Verdict,
    /// The evidence and its limits.
    pub numbers: BTreeMap<String, f64>,
    /// Its subject.
    #[serde(flatten)]
    pub subject: ReasonSubject,
    /// The reason in words, with the remedy.
    pub text: String,
    /// The remedy alone; empty in files from before this key.
    #[serde(default)]
    pub remedy: String,
    /// Codes of the remedies of the results that a program can apply.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remedies: Vec<String>,
}

/// A reason that could not be examined, because the data that decide it were missing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NotExamined {
    /// The rule.
    pub code: ReasonCode,
    /// The missing data, in a sentence.
    pub why: String,
}
