use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Advice, CaseDiagnosis, Influence, RecordingFindings, ResidualResult};
use crate::{
    identification::{Method, Status},
    recording::Resampling,
    statistics::FTest,
};

/// What an experiment gives: the content of `results.json`, and the curves of the report.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Results {
    /// Version of this program.
    pub thetahat: String,
    /// Name of the robot.
    pub robot: String,
    /// Title of the experiment.
    pub title: String,
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
    /// The elimination, where essential parameters were sought.
    pub elimination: Option<EliminationResult>,
    /// Which numbers of each case to take, and why.
    #[serde(default)]
    pub advice: Vec<Advice>,
    /// What tells the methods of each case apart.
    #[serde(default)]
    pub diagnostics: Vec<CaseDiagnosis>,
    /// Every case and method.
    pub runs: Vec<RunResult>,
    /// The text of the experiment file.
    pub experiment_description: String,
    /// The text of the robot description.
    pub robot_description: String,
    /// Curves for the report.
    #[serde(skip)]
    pub plots: Plots,
}

/// What was used of a recording.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RecordingResult {
    /// Its name, or its number.
    pub name: String,
    /// Weight of its rows.
    pub weight: f64,
    /// Samples in its window.
    pub samples_used: usize,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Start and end of the window, s.
    pub window_s: [f64; 2],
    /// How far its time steps deviate, where it was resampled to equal ones.
    pub resampling: Option<Resampling>,
    /// The reference that its simulations follow.
    pub reference: Option<ReferenceResult>,
}

/// Bandwidths asked for, and measured by sending an impulse through the same code.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Bandwidth {
    /// Cut-off of the position filter asked for, Hz: each of its two passes is 3 dB down there.
    pub position_cutoff_hz: f64,
    /// Where the positions that come out are 3 dB down, Hz.
    pub position_measured_hz: Option<f64>,
    /// Where the accelerations that come out are 3 dB down, beside the two differentiations, Hz.
    pub acceleration_measured_hz: Option<f64>,
    /// Cut-off of the parallel filter, Hz: 0.8 of the decimated Nyquist frequency.
    pub decimation_cutoff_hz: f64,
    /// Where the rows that come out are 3 dB down, Hz.
    pub decimation_measured_hz: Option<f64>,
}

/// Where the simulations' reference comes from, and how well it describes the record.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ReferenceResult {
    /// `recorded`, `reconstructed` or `planned`.
    pub origin: String,
    /// Moves, where it is made of moves.
    pub moves: Option<usize>,
    /// Rms deviation of the record from it in the window, per joint, rad or m.
    pub rms_deviation: Vec<f64>,
}

/// What an elimination did.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EliminationResult {
    /// Parameters kept.
    pub kept: Vec<String>,
    /// Parameters taken out, in order.
    pub eliminated: Vec<String>,
    /// The test of those kept against all.
    pub f_test: Option<FTest>,
}

/// One case and method.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RunResult {
    /// The case.
    pub case: String,
    /// The method.
    pub method: Method,
    /// How it ended.
    pub status: Status,
    /// Why, where it is not converged.
    pub reason: Option<String>,
    /// Iterations.
    pub iterations: usize,
    /// Closed-loop simulations of the iteration.
    pub simulations: usize,
    /// `100 |y - y_hat| / |y|`, unweighted; none where there is no estimate.
    pub relative_error_percent: Option<f64>,
    /// The same for each joint; none where its torque is zero.
    pub joint_relative_error_percent: Vec<Option<f64>>,
    /// The same on data that the estimate has not seen: the second recording, or each move left out in turn.
    pub cross_validation_relative_error_percent: Option<f64>,
    /// Its 95 % interval, from how much the parts that were left out differ.
    #[serde(default)]
    pub cross_validation_interval_95_percent: Option<[f64; 2]>,
    /// The part of the record without which the estimates change most.
    #[serde(default)]
    pub influence: Option<Influence>,
    /// The tests of the residual.
    #[serde(default)]
    pub residual: Option<ResidualResult>,
    /// Condition number of the observation matrix of the second recording.
    pub validation_condition_number: Option<f64>,
    /// Condition number of the matrix that is solved.
    pub condition_number: Option<f64>,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Relative errors of the closed-loop simulation with these estimates: position, velocity, acceleration, torque.
    pub simulation_relative_error_percent: Option<BTreeMap<String, f64>>,
    /// The same on the second recording.
    pub validation_simulation_relative_error_percent: Option<BTreeMap<String, f64>>,
    /// F-test of these parameters against all base parameters, where fewer are estimated, on X.
    pub f_test: Option<FTest>,
    /// Convergence.
    pub convergence: Vec<IterationResult>,
    /// The estimates.
    pub parameters: Vec<ParameterResult>,
    /// Curves for the report.
    #[serde(skip)]
    pub plots: RunPlots,
}

/// One iteration.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct IterationResult {
    /// Relative error, percent.
    pub relative_error_percent: f64,
    /// Largest change of an estimate, in its standard deviations.
    pub parameter_change: Option<f64>,
    /// Relative change of the error.
    pub error_change: Option<f64>,
    /// The estimates.
    pub estimates: Vec<f64>,
}

/// One estimate.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ParameterResult {
    /// Name.
    pub name: String,
    /// Estimate.
    pub estimate: f64,
    /// Classical standard deviation.
    pub standard_deviation: Option<f64>,
    /// The same in percent of the estimate.
    pub relative_standard_deviation_percent: Option<f64>,
    /// True value, for a twin.
    pub true_value: Option<f64>,
    /// Unit.
    pub unit: String,
    /// Regrouping formula.
    pub expression: String,
    /// Whether the tables show it.
    pub shown: bool,
    /// Standard deviation with errors that are correlated in time and differ between joints.
    #[serde(default)]
    pub standard_deviation_robust: Option<f64>,
    /// Low and high end of the interval of 95 % with these errors.
    #[serde(default)]
    pub interval_95: Option<[f64; 2]>,
}

/// Curves that all runs share; joint by joint as in y.
#[derive(Debug, Clone, Default)]
pub struct Plots {
    /// Time of each decimated row of a joint, s.
    pub time_s: Vec<f64>,
    /// y, one vector per joint, N m or N.
    pub measured: Vec<Vec<f64>>,
    /// Filtered positions at the same times, one vector per joint, rad or m.
    pub position: Vec<Vec<f64>>,
}

/// Curves of one run.
#[derive(Debug, Clone, Default)]
pub struct RunPlots {
    /// `y_hat`, one vector per joint.
    pub predicted: Vec<Vec<f64>>,
    /// Simulated positions, one vector per joint; empty without a simulation.
    pub simulated_position: Vec<Vec<f64>>,
}

impl Results {
    /// Whether every nominal run converged, and no check of a recording that was identified from found a problem.
    #[must_use]
    pub fn is_trustworthy(&self) -> bool {
        if self.findings.iter().any(|r| !r.held_back && r.has_problem()) {
            return false;
        }
        let nominal = |r: &&RunResult| r.case == super::description::NOMINAL;
        self.runs.iter().filter(nominal).all(|r| r.status == Status::Converged)
    }

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

impl RunResult {
    /// Median over the parameters of the standard deviation with correlated errors over the classical one: how far the
    /// classical ones are too small.
    #[must_use]
    pub fn widening(&self) -> Option<f64> {
        let ratio = |p: &ParameterResult| Some(p.standard_deviation_robust? / p.standard_deviation?);
        let mut ratios: Vec<f64> = self.parameters.iter().filter_map(ratio).filter(|r| r.is_finite()).collect();
        ratios.sort_by(f64::total_cmp);
        ratios.get(ratios.len() / 2).copied()
    }

    /// The estimate of a parameter.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&ParameterResult> {
        self.parameters.iter().find(|p| p.name == name)
    }
}
