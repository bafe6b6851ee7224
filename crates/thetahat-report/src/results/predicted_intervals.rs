//! The intervals that a design predicted, compared with those of the recording.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::{content::Results, estimate::NoEstimate, run::RunResult};
use thetahat_estimation::identification::Method;
use thetahat_ground::files;

/// The `predicted.csv` of a design.
#[derive(Debug, Clone)]
pub struct PredictedIntervals {
    rows: Vec<PredictedInterval>,
}

/// One of its rows.
#[derive(Debug, Clone, Deserialize)]
struct PredictedInterval {
    predicted: String,
    unit: String,
    half_width_95: f64,
    method: String,
    /// Filtered rows of the whole recording.
    rows: usize,
    joint: Option<String>,
    residual_rms: Option<f64>,
    torque_rms: Option<f64>,
}

/// Why predicted intervals cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PredictionError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The file is no `predicted.csv` of this version.
    #[error("{}: is not the predicted.csv of a design: {source}; give the one that `thetahat design --out` wrote", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Line and column.
        source: csv::Error,
    },
    /// The results have no estimate to compare.
    #[error("{}: {source}", path.display())]
    NoEstimate {
        /// The results.
        path: PathBuf,
        /// Why.
        source: NoEstimate,
    },
    /// The results and the prediction have no parameter in common.
    #[error("{} and {} have no parameter with an interval in common: are they of the same robot?", predicted.display(), results.display())]
    NothingInCommon {
        /// The predicted intervals.
        predicted: PathBuf,
        /// The results.
        results: PathBuf,
    },
}

/// The intervals of a recording next to the predicted ones.
#[derive(Debug, Clone)]
pub struct IntervalsAgainstPrediction {
    /// The method of the prediction.
    pub predicted_method: String,
    /// The method of the results.
    pub method: Method,
    /// Predicted and found number of filtered rows.
    pub rows: [usize; 2],
    /// Each parameter with both intervals.
    pub parameters: Vec<ComparedInterval>,
    /// Joint, and how many times larger than predicted the residual of its rows is.
    pub residuals: Vec<(String, f64)>,
    /// Joint, and how many times larger than predicted its torques are.
    pub torques: Vec<(String, f64)>,
    /// The largest correlation of neighbouring rows of a residual, and its joint.
    pub most_correlated: Option<(String, f64)>,
}

/// Half of the 95 % interval of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedInterval {
    /// Name of the parameter.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The predicted half width.
    pub predicted: f64,
    /// That of the recording.
    pub found: f64,
}

impl ComparedInterval {
    /// How many times wider the interval of the recording is.
    #[must_use]
    pub fn times_wider(&self) -> f64 {
        self.found / self.predicted
    }
}

impl PredictedIntervals {
    /// The intervals in a `predicted.csv`.
    ///
    /// # Errors
    /// [`PredictionError`] for a file that cannot be read or is of another form.
    pub fn read(path: &Path) -> Result<Self, PredictionError> {
        let text = files::read_to_string(path)
            .map_err(|source| PredictionError::Unreadable { path: path.to_owned(), source })?;
        let rows = csv::Reader::from_reader(text.as_bytes()).deserialize().collect::<Result<_, _>>();
        Ok(Self { rows: rows.map_err(|source| PredictionError::Malformed { path: path.to_owned(), source })? })
    }

    /// The intervals of results next to these: of the method asked for, or else of the predicted one, or else of the recommended one.
    ///
    /// # Errors
    /// [`NoEstimate`] where the results have no such estimate.
    pub fn against(
        &self,
        results: &Results,
        case: &str,
        method: Option<Method>,
    ) -> Result<IntervalsAgainstPrediction, NoEstimate> {
        let predicted_method = self.rows.first().map_or_else(String::new, |row| row.method.clone());
        let is_predicted =
            |run: &&RunResult| run.case == case && run.method.name() == predicted_method && !run.parameters.is_empty();
        let same = results.runs.iter().find(is_predicted).filter(|_| method.is_none());
        let run = match same {
            Some(run) => run,
            None => results.estimate(case, method)?,
        };
        let interval = |row: &PredictedInterval| {
            let [low, high] = run.parameter(&row.predicted)?.interval_95?;
            let (name, unit) = (row.predicted.clone(), row.unit.clone());
            Some(ComparedInterval { name, unit, predicted: row.half_width_95, found: 0.5 * (high - low) })
        };
        let found = joints(results, run);
        Ok(IntervalsAgainstPrediction {
            rows: [self.rows.first().map_or(0, |row| row.rows), results.decimated_rows],
            parameters: self.rows.iter().filter_map(interval).filter(|compared| compared.predicted > 0.0).collect(),
            residuals: self.ratios(&found, |joint| Some(joint.residual_rms), |row| row.residual_rms),
            torques: self.ratios(&found, |joint| joint.torque_rms, |row| row.torque_rms),
            most_correlated: found
                .iter()
                .map(|joint| (joint.name.clone(), joint.correlation))
                .max_by(|a, b| a.1.total_cmp(&b.1)),
            method: run.method,
            predicted_method,
        })
    }

    /// How many times larger a figure of each joint is than predicted.
    fn ratios(
        &self,
        found: &[FoundJoint],
        of_found: impl Fn(&FoundJoint) -> Option<f64>,
        of_predicted: impl Fn(&PredictedInterval) -> Option<f64>,
    ) -> Vec<(String, f64)> {
        let ratio = |joint: &FoundJoint| {
            let row = self.rows.iter().find(|row| row.joint.as_ref() == Some(&joint.name))?;
            Some((joint.name.clone(), of_found(joint)? / of_predicted(row).filter(|predicted| *predicted > 0.0)?))
        };
        found.iter().filter_map(ratio).collect()
    }
}

/// What the rows of a joint turned out to be.
struct FoundJoint {
    name: String,
    residual_rms: f64,
    torque_rms: Option<f64>,
    correlation: f64,
}

fn joints(results: &Results, run: &RunResult) -> Vec<FoundJoint> {
    let of = |joint: &super::JointResidual| {
        let name = results.robot_joints.get(joint.joint.checked_sub(1)?)?.name.clone();
        let percent = run.joint_relative_error_percent.get(joint.joint - 1).copied().flatten();
        let torque_rms = percent.filter(|percent| *percent > 0.0).map(|percent| 100.0 * joint.rms / percent);
        Some(FoundJoint { name, residual_rms: joint.rms, torque_rms, correlation: joint.autocorrelation })
    };
    run.residual.iter().flat_map(|residual| &residual.joints).filter_map(of).collect()
}
