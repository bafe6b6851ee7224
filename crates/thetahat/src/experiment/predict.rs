//! The torques that identified parameters predict for another motion.

use std::path::{Path, PathBuf};

use super::{Experiment, ExperimentError, RecordingDescription, chain::FilteredRecord};
use crate::{
    dynamics::{Model, Sign},
    identification::{Assembly, Method, relative_error_percent},
    regressor::Regressor,
    results::{Prediction, Results, RunResult},
    robot::Robot,
    series::Series,
    signal::Decimator,
};

/// What to predict with which run.
#[derive(Debug, Clone)]
pub struct PredictionRequest {
    /// The `results.json` of an identification.
    pub results: PathBuf,
    /// The recording's file; its channels are described as in the experiment.
    pub recording: PathBuf,
    /// The file of the torques, where it is another one.
    pub torque: Option<PathBuf>,
    /// The case.
    pub case: String,
    /// The method; none takes the first converged run of the case.
    pub method: Option<Method>,
}

/// Predicts the torques of a motion with the parameters of an earlier identification.
///
/// # Errors
/// [`ExperimentError`] for files that cannot be used.
pub fn predict(request: &PredictionRequest) -> Result<Prediction, ExperimentError> {
    let results = Results::read(&request.results)?;
    let experiment = Experiment::from_texts(
        &request.results,
        results.experiment_description.clone(),
        results.robot_description.clone(),
    )?;
    let (case, method, theta_by_name) = chosen_run(request, &results)?;
    let description = described(&experiment, request)?;
    let has_torque = request.torque.is_some() || same_file(&experiment);
    let record = if has_torque {
        experiment.read_record(&description, 1, Path::new(""))?
    } else {
        experiment.read_motion(&description, Path::new(""))?
    };
    let filtered = experiment.filter_moving_part(record)?;
    let friction = experiment.cases().into_iter().find(|c| c.name == case).and_then(|c| c.friction);
    let robot = Robot { friction: friction.unwrap_or(experiment.robot.friction), ..experiment.robot.clone() };
    let predictor = Predictor::new(&experiment, Model::new(&robot), &theta_by_name, &request.results)?;
    predictor.predict(&filtered, has_torque, (case, method))
}

type NamedParameters = Vec<(String, f64)>;

fn chosen_run(
    request: &PredictionRequest,
    results: &Results,
) -> Result<(String, Method, NamedParameters), ExperimentError> {
    let fits = |r: &&RunResult| {
        r.case == request.case && request.method.is_none_or(|m| m == r.method) && !r.parameters.is_empty()
    };
    let Some(run) = results.runs.iter().find(fits) else {
        let with = |r: &&RunResult| !r.parameters.is_empty();
        let name = |r: &RunResult| format!("{} {}", r.case, r.method.name());
        let found: Vec<String> = results.runs.iter().filter(with).map(name).collect();
        let found = if found.is_empty() { "none".to_owned() } else { found.join(", ") };
        let method = request.method.map_or("any method", Method::name);
        return Err(ExperimentError::ResultsFile {
            path: request.results.clone(),
            problem: format!("holds no estimate of {} by {method}; those it holds: {found}", request.case),
        });
    };
    let theta = run.parameters.iter().map(|p| (p.name.clone(), p.estimate)).collect();
    Ok((run.case.clone(), run.method, theta))
}

/// The experiment's description of its recording, with the files of the request.
fn described(experiment: &Experiment, request: &PredictionRequest) -> Result<RecordingDescription, ExperimentError> {
    let Some(of_experiment) = experiment.file.recording.first() else {
        return Err(experiment.missing("[recording]", "it describes the channels of the file to predict for"));
    };
    let mut description = of_experiment.clone();
    description.position.file.clone_from(&request.recording);
    description.torque.file = request.torque.clone().unwrap_or_else(|| request.recording.clone());
    (description.position.anywhere, description.torque.anywhere) = (true, true);
    if let Some(time) = &mut description.time {
        time.file.clone_from(&request.recording);
        time.anywhere = true;
    }
    description.velocity = None;
    description.reference = None;
    description.added_signal = None;
    Ok(description)
}

/// Whether the experiment has positions and torques in one file.
fn same_file(experiment: &Experiment) -> bool {
    experiment.file.recording.first().is_some_and(|r| r.position.file == r.torque.file)
}

struct Predictor<'a> {
    experiment: &'a Experiment,
    model: Model,
    columns: Vec<usize>,
    theta: Vec<f64>,
}

impl<'a> Predictor<'a> {
    fn new(
        experiment: &'a Experiment,
        model: Model,
        theta: &[(String, f64)],
        results: &Path,
    ) -> Result<Self, ExperimentError> {
        let base = crate::base_parameters::BaseParameters::of(&model, &experiment.file.parameters.exclude)
            .map_err(|source| ExperimentError::Parameters { path: results.to_owned(), source })?;
        let column = |name: &String| base.parameters().iter().find(|p| p.name == *name).map(|p| p.kept);
        let columns: Option<Vec<usize>> = theta.iter().map(|(name, _)| column(name)).collect();
        let columns = columns.ok_or_else(|| ExperimentError::ResultsFile {
            path: results.to_owned(),
            problem: "names parameters that its robot does not have; identify again with this version".to_owned(),
        })?;
        Ok(Self { experiment, model, columns, theta: theta.iter().map(|(_, v)| *v).collect() })
    }

    fn predict(
        &self,
        filtered: &FilteredRecord,
        has_torque: bool,
        (case, method): (String, Method),
    ) -> Result<Prediction, ExperimentError> {
        let rate = filtered.record.sample_rate_hz;
        let refuse = |source| ExperimentError::Signal { path: self.experiment.path.clone(), source };
        let (q, dq, ddq) = self.experiment.band_pass(&filtered.record.position, rate).map_err(refuse)?;
        let torque = self.torques(&q, &dq, &ddq);
        let decimator =
            Decimator::new(self.experiment.file.signal.decimation, filtered.window.len()).map_err(refuse)?;
        let assembly = Assembly::new(&self.model, &self.columns, decimator);
        let prediction = filtered.observation_matrix(&assembly).map_err(refuse)?.times(&self.theta);
        let rows = assembly.rows_per_joint();
        let y = has_torque
            .then(|| assembly.measurement_vector(&filtered.record.torque.window(filtered.window.clone())))
            .transpose()
            .map_err(refuse)?;
        let joint_errors = |y: &Vec<f64>| {
            let error = |(y, p)| Some(relative_error_percent(y, p)).filter(|e| e.is_finite());
            y.chunks(rows).zip(prediction.chunks(rows)).map(error).collect()
        };
        let rms = |p: &[f64]| (p.iter().map(|v| v * v).sum::<f64>() / p.len() as f64).sqrt();
        Ok(Prediction {
            method,
            case,
            sample_rate_hz: rate,
            torque,
            relative_error_percent: y.as_ref().map(|y| relative_error_percent(y, &prediction)),
            joint_relative_error_percent: y.as_ref().map(joint_errors).unwrap_or_default(),
            measured: has_torque.then(|| filtered.record.torque.clone()),
            rms: prediction.chunks(rows).map(rms).collect(),
            window_s: [filtered.start_s(), filtered.window.end as f64 / rate],
            joints: self.experiment.robot.coordinates().map(|j| j.name.clone()).collect(),
        })
    }

    /// `phi(q, dq, ddq) theta` at every sample.
    fn torques(&self, q: &Series, dq: &Series, ddq: &Series) -> Series {
        let regressor = Regressor::new(&self.model, &self.columns);
        let phi = regressor.evaluate_series(&self.model, q, dq, ddq, Sign::Exact);
        let mut torque = Series::zeros(q.len(), q.channels());
        for k in 0..q.len() {
            let tau = torque.sample_mut(k);
            for (entry, value) in regressor.entries().iter().zip(phi.sample(k)) {
                tau[entry.joint] += value * self.theta[entry.column];
            }
        }
        torque
    }
}
