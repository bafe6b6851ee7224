use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{
    curves::Plots,
    diagnosis::{Advice, CaseDiagnosis},
    joints::JointResult,
    parameters::EliminationResult,
    payload::{DriveGainResult, PayloadResult},
    recordings::{Bandwidth, RecordingFindings, RecordingResult, UnmaskedComparison},
    run::RunResult,
    terms::{ProfiledTerm, TermComparison},
    user_run::UserRun,
    verdict::{NotExamined, Verdict, VerdictReason},
};
use thetahat_estimation::identification::Method;
use thetahat_model::robot::{LockedJoint, RobotFile};

/// Version of the form of `results.json`: it grows where a program of before would misread the file.
pub const SCHEMA: u32 = 1;

pub use thetahat_estimation::simulation::NOMINAL;

/// What an experiment gives: the content of `results.json`, and the curves of the report.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Results {
    /// Version of the form of the file: [`SCHEMA`], or 0 where it was read from a file of before that key.
    #[serde(default)]
    pub schema: u32,
    /// Version of this program.
    pub thetahat: String,
    /// Name of the robot.
    pub robot: String,
    /// Title of the experiment.
    pub title: String,
    /// What the results are good for; none where they were read from a file of before that key.
    #[serde(default)]
    pub verdict: Option<Verdict>,
    /// Why they are not good, the gravest first.
    #[serde(default)]
    pub verdict_reasons: Vec<VerdictReason>,
    /// Reasons that could not be examined, as the results come from a reduction.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_examined: Vec<NotExamined>,
    /// The joints, one for each coordinate: the order of all numbers that are given joint by joint. Empty where it was
    /// read from a file of schema 0.
    #[serde(default)]
    pub robot_joints: Vec<JointResult>,
    /// The joints of the robot's description that were locked, rad or m.
    #[serde(default)]
    pub robot_locked: Vec<LockedJoint>,
    /// Samples in the windows of the recordings that were identified from.
    pub samples_used: usize,
    /// Rows of y.
    pub decimated_rows: usize,
    /// The recordings that were identified from.
    pub recordings: Vec<RecordingResult>,
    /// Those held back.
    pub validation_recordings: Vec<RecordingResult>,
    /// Bandwidths asked for and measured.
    pub bandwidth: Bandwidth,
    /// Seed of the simulated record's noise.
    pub seed: Option<u64>,
    /// What the checks found in the recordings.
    #[serde(default)]
    pub findings: Vec<RecordingFindings>,
    /// Standard parameters taken as zero. Here and below, nothing where it was read from a file of before that key.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub excluded_parameters: Vec<String>,
    /// Standard parameters at given values, SI.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub fixed_parameters: BTreeMap<String, f64>,
    /// The elimination, where essential parameters were sought.
    pub elimination: Option<EliminationResult>,
    /// What samples near rest would change, where they were left out.
    #[serde(default)]
    pub unmasked_comparison: Option<UnmaskedComparison>,
    /// Constants of torque terms that were searched for.
    #[serde(default)]
    pub profiled_terms: Vec<ProfiledTerm>,
    /// Laws of torque terms compared, where that was asked for.
    #[serde(default)]
    pub term_comparison: Option<TermComparison>,
    /// Which numbers of each case to take, and why.
    #[serde(default)]
    pub advice: Vec<Advice>,
    /// What tells the methods of each case apart.
    #[serde(default)]
    pub diagnostics: Vec<CaseDiagnosis>,
    /// Every case and method.
    pub runs: Vec<RunResult>,
    /// What estimators of the user's own found: the verdict, the advice and exports know nothing of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub user_runs: Vec<UserRun>,
    /// The payloads that were estimated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub payloads: Vec<PayloadResult>,
    /// The gains of the drives by a known payload, joint by joint; empty where no recording carries one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drive_gains: Vec<DriveGainResult>,
    /// The text of the experiment file.
    pub experiment_description: String,
    /// The text of the robot description.
    pub robot_description: String,
    /// The files that it was read from, with their hashes. Empty where it was read from a file of before that key.
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
