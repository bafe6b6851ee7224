//! Changes of the settings that remove the cause of a finding.

use serde::{Deserialize, Serialize};

use super::cause::CauseKind;
use thetahat_estimation::checks::{Code, RemedyStep};

/// A change of the experiment that removes the cause of a finding, for a program to apply.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Remedy {
    /// Its name: the code of the finding, with the joints where each has its own remedy.
    pub code: String,
    /// What it does, in a few words.
    pub label: String,
    /// What was found.
    pub found: String,
    /// The code of the finding.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finding: Option<Code>,
    /// Codes of further findings that it removes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<Code>,
    /// The cause that the model names, where it is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<CauseKind>,
    /// The keys of the experiment file that change.
    pub changes: Vec<SettingChange>,
    /// What is done, recording by recording.
    pub steps: Vec<RecordingStep>,
}

/// A key of the experiment file with another value.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SettingChange {
    /// The key with its tables, such as `recording.torque.gain`; of several recordings `recording[2].torque.gain`.
    pub key: String,
    /// The value before, as the file writes it; none if the key was not there.
    pub before: Option<String>,
    /// The value after; none if the key is removed.
    pub after: Option<String>,
}

/// A step, and where it holds.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordingStep {
    /// The recording, by its name or number; none for settings of all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<String>,
    /// Whether that recording is held back for validation.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub held_back: bool,
    /// Whether the recorded reference has the fault of the positions.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub with_reference: bool,
    /// Whether the recorded velocities have it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub with_velocity: bool,
    /// The change.
    pub step: RemedyStep,
}
