use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{
    curves::Plots,
    diagnosis::{Advice, CaseDiagnosis},
    joints::JointResult,
    model::ModelResult,
    parameters::{EliminationResult, NotSeparated},
    payload::{DriveGainResult, PayloadResult},
    recordings::{Bandwidth, RecordingFindings, RecordingResult, UnmaskedComparison},
    remedy::Remedy,
    run::RunResult,
    terms::{ProfiledTerm, TermComparison},
    user_run::UserRun,
    verdict::{NotExamined, Verdict, VerdictReason},
};
use thetahat_estimation::identification::Method;
use thetahat_model::robot::{LockedJoint, RobotFile};

/// Version of the form of `results.json`. It rises when an older program would misread the file. Schema 2 renamed keys: see the
/// aliases of the fields; files with schema 0 and 1 are still read.
pub const SCHEMA: u32 = 2;

pub use thetahat_estimation::simulation::NOMINAL;

/// The results of an experiment: the content of `results.json`, and the curves of the report.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Results {
    /// Version of the form of the file: [`SCHEMA`], or the version of the file that was read; 0 if the file has no such key.
    #[serde(default)]
    pub schema: u32,
    /// Version of this program.
    pub thetahat: String,
    /// Name of the robot.
    pub robot: String,
    /// Title of the experiment.
    pub title: String,
    /// Whether the results can be used; `null` in files from before this key.
    #[serde(default)]
    pub verdict: Option<Verdict>,
    /// Why the verdict is not good, the most serious reason first.
    #[serde(default)]
    pub verdict_reasons: Vec<VerdictReason>,
    /// Changes of the experiment file that remove causes of findings: `thetahat identify --apply` makes them. Empty where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remedies: Vec<Remedy>,
    /// Reasons that could not be examined, as the results come from a reduction.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_examined: Vec<NotExamined>,
    /// The joints, one for each coordinate, in the order of all numbers that are given per joint. Empty if it was
    /// read from a file of schema 0.
    #[serde(default)]
    pub robot_joints: Vec<JointResult>,
    /// The joints of the robot's description that were locked, with their values in rad or m.
    #[serde(default)]
    pub robot_locked: Vec<LockedJoint>,
    /// Samples in the windows of the recordings used for identification.
    pub samples_used: usize,
    /// Rows of y.
    pub decimated_rows: usize,
    /// The recordings used for identification.
    pub recordings: Vec<RecordingResult>,
    /// The recordings held back for validation.
    pub validation_recordings: Vec<RecordingResult>,
    /// Bandwidths requested and measured.
    pub bandwidth: Bandwidth,
    /// Seed of the noise of the simulated recording.
    pub seed: Option<u64>,
    /// The findings of the checks in the recordings.
    #[serde(default)]
    pub findings: Vec<RecordingFindings>,
    /// Standard parameters set to zero. This key and those below that may be absent are empty if the file was written before them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub excluded_parameters: Vec<String>,
    /// Standard parameters fixed at given values, SI.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub fixed_parameters: BTreeMap<String, f64>,
    /// The elimination, if essential parameters were requested.
    pub elimination: Option<EliminationResult>,
    /// Base parameters that the motion does not separate from others: the runs leave them out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_separated: Vec<NotSeparated>,
    /// How samples near rest would change the estimates, if they were left out.
    #[serde(default, alias = "with_rest")]
    pub unmasked_comparison: Option<UnmaskedComparison>,
    /// Constants of torque terms that were found by a search.
    #[serde(default)]
    pub profiled_terms: Vec<ProfiledTerm>,
    /// Comparison of laws of torque terms, if requested.
    #[serde(default)]
    pub term_comparison: Option<TermComparison>,
    /// Which method to use in each case, and why.
    #[serde(default)]
    pub advice: Vec<Advice>,
    /// Tests that compare the methods of each case.
    #[serde(default)]
    pub diagnostics: Vec<CaseDiagnosis>,
    /// Every case and method.
    pub runs: Vec<RunResult>,
    /// The model that predictions and exports use; `null` where there is none.
    #[serde(default)]
    pub model: Option<ModelResult>,
    /// Why there is no model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_model: Option<String>,
    /// The estimates of the user's own estimators. The verdict, the advice and exports do not use them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub user_runs: Vec<UserRun>,
    /// The payloads that were estimated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub payloads: Vec<PayloadResult>,
    /// The gains of the drives estimated with a known payload, per joint; empty without a recording with a known payload.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drive_gains: Vec<DriveGainResult>,
    /// The text of the experiment file.
    pub experiment_description: String,
    /// The text of the robot description.
    pub robot_description: String,
    /// The files of the robot description, with their hashes. Empty in files from before this key.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robot_files: Vec<RobotFile>,
    /// Curves for the report.
    #[serde(skip)]
    pub plots: Plots,
}

impl Results {
    /// The run of a case and method.
    #[must_use]
    pub fn run(&self, case: &str, method: Method) -> Option<&RunResult> {
        self.runs.iter().find(|r| r.case == case && r.method == method)
    }

    /// The cases, in order.
    #[must_use]
    pub fn cases(&self) -> Vec<&str> {
        let mut cases: Vec<&str> = self.runs.iter().map(|r| r.case.as_str()).collect();
        cases.dedup();
        cases
    }
}
