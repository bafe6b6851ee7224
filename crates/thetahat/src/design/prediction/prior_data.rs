//! Prior data of the user: reductions as prior information, results to compare with, and their residual as noise.

use std::path::{Path, PathBuf};

use crate::design::{
    error::DesignError,
    prediction::{
        noise::{TorqueNoise, torque_noise_of_rows},
        prior_model::{is_results, no_model},
    },
    search::{optimiser::Problem, watch::Watch},
    text::description::Design,
};
use crate::{
    experiment::{Experiment, ExperimentError},
    reduction::Reduction,
};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::base_parameters::BaseParameters;
use thetahat_report::results::{JointResidual, ParameterResult, Results, RunResult};

/// The folder of a file, in which an experiment's recordings are.
fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

/// The inverse of a covariance, whose parameters have units of their own.
pub(in crate::design) fn inverse(matrix: &Matrix) -> Option<Matrix> {
    let size = matrix.rows();
    let scale: Vec<f64> = (0..size).map(|i| 1.0 / matrix.at(i, i).sqrt()).collect();
    let scaled = Matrix::from_fn(size, size, |i, j| matrix.at(i, j) * scale[i] * scale[j]);
    let inverse = scaled.cholesky()?.solve_matrix(&Matrix::identity(size));
    Some(Matrix::from_fn(size, size, |i, j| inverse.at(i, j) * scale[i] * scale[j]))
}

/// Estimates to compare with.
pub(in crate::design) struct Compared {
    pub(in crate::design) title: String,
    pub(in crate::design) method: String,
    pub(in crate::design) parameters: Vec<ParameterResult>,
}

impl Design {
    /// The prior information on the base parameters, from earlier recordings.
    pub(in crate::design) fn prior(&self, base: &BaseParameters, noise: &[f64]) -> Result<Option<Matrix>, DesignError> {
        let mut known: Vec<Matrix> = Vec::new();
        let reductions = self.prior_reductions();
        if !reductions.is_empty() {
            let reduction = Reduction::read_all(&reductions)?;
            if !reduction.identity.is_of(&self.robot, base) {
                return Err(DesignError::OtherRobot { path: self.path.clone() });
            }
            known.push(reduction.information(noise)?);
        }
        for file in self.prior_files().iter().filter(|file| is_results(file)) {
            known.push(self.information_of_model(file, base)?);
        }
        Ok(known.into_iter().reduce(|sum, information| sum.plus(&information, 1.0)))
    }

    fn prior_reductions(&self) -> Vec<PathBuf> {
        self.prior_files().into_iter().filter(|file| !is_results(file)).collect()
    }

    /// The information on the base parameters that the model of results has: the inverse of their covariance.
    fn information_of_model(&self, file: &Path, base: &BaseParameters) -> Result<Matrix, DesignError> {
        let other = || DesignError::OtherRobot { path: self.path.clone() };
        let model = Results::read(file)?.model.ok_or_else(|| no_model(file))?;
        let place = |name: &str| model.parameters.iter().position(|p| p.name == name);
        let places: Vec<usize> =
            base.parameters().iter().map(|p| place(&p.name)).collect::<Option<_>>().ok_or_else(other)?;
        let size = model.parameters.len();
        let all = Matrix::from_lower_half(size, &model.covariance).ok_or_else(|| no_model(file))?;
        let covariance = Matrix::from_fn(places.len(), places.len(), |i, j| all.at(places[i], places[j]));
        inverse(&covariance).ok_or_else(|| no_model(file))
    }

    /// The criterion if the last earlier recording were repeated instead, for as long as the motion takes.
    pub(in crate::design) fn repeated(&self, problem: &Problem) -> Result<Option<f64>, DesignError> {
        let files = self.prior_reductions();
        let (Some(last), Some(prior)) = (files.last(), problem.information.prior()) else { return Ok(None) };
        let reduction = Reduction::read_all(std::slice::from_ref(last))?;
        let seconds: f64 = reduction.recordings.iter().map(|r| r.window_s[1] - r.window_s[0]).sum();
        let again = prior.plus(&reduction.information(&self.noise.deviations)?, self.file.duration_s / seconds);
        Ok(problem.criterion.value(&again))
    }

    /// The experiment to compare with, where it is one.
    fn compared_experiment(&self) -> Option<Result<Experiment, ExperimentError>> {
        let file = self.compared_file().filter(|file| file.extension().is_some_and(|e| e == "toml"))?;
        Some(Experiment::read(&file, folder_of(&file)))
    }

    /// The files of what is compared with.
    pub(in crate::design) fn compared_files(&self) -> Vec<PathBuf> {
        let file = self.compared_file();
        let read = self.compared_experiment().and_then(Result::ok);
        let of_experiment = read.iter().flat_map(|e| e.input_files(folder_of(&e.path)));
        file.into_iter().chain(of_experiment).collect()
    }

    /// The results to compare with, of the method that they recommend. An experiment file is identified first.
    pub(in crate::design) fn compared(
        &self,
        threads: usize,
        watch: &Watch<'_>,
    ) -> Result<Option<Compared>, DesignError> {
        let Some(file) = self.compared_file() else { return Ok(None) };
        let results = match self.compared_experiment().transpose()? {
            Some(experiment) => {
                watch.stage("identifying what the design is compared with");
                experiment.run_on_threads(folder_of(&experiment.path), threads, &mut |_| {})?
            }
            None => Results::read(&file)?,
        };
        let taken =
            |run: &&RunResult| results.advice.iter().any(|a| a.case == run.case && a.recommended == Some(run.method));
        let of = |run: &&RunResult| !run.parameters.is_empty();
        let run = results.runs.iter().filter(of).find(taken).or_else(|| results.runs.iter().find(of));
        let run = run.ok_or_else(|| DesignError::NothingToCompare { path: self.path.clone(), file: file.clone() })?;
        Ok(Some(Compared {
            title: results.title.clone(),
            method: run.method.name().to_owned(),
            parameters: run.parameters.clone(),
        }))
    }

    /// The noise of the torques.
    pub(in crate::design) fn torque_noise(&self) -> Result<TorqueNoise, DesignError> {
        let joints = self.robot.coordinate_count();
        match (&self.file.noise.torque, self.noise_file()) {
            (Some(torque), None) => Ok(TorqueNoise { deviations: torque.to_list(joints), spectrum: None }),
            (None, Some(file)) => {
                let results = Results::read(&file)?;
                let rows = self.residual_of(&results);
                let rows = rows.ok_or_else(|| DesignError::NoNoise { path: self.path.clone(), file: file.clone() })?;
                let cutoff_hz = results.bandwidth.decimation_cutoff_hz;
                Ok(torque_noise_of_rows(rows, cutoff_hz, self.file.sample_rate_hz))
            }
            (Some(_), Some(_)) | (None, None) => {
                let expected = "one of torque, the standard deviations, and results, an earlier results.json";
                Err(self.value("[noise]", expected, "both or none of them"))
            }
        }
    }

    /// The residual of each joint, where the results are of this robot's joints.
    fn residual_of<'a>(&self, results: &'a Results) -> Option<&'a [JointResidual]> {
        let names = self.robot.coordinates().map(|joint| &joint.name);
        let is_same = names.eq(results.robot_joints.iter().map(|joint| &joint.name));
        let taken = results.cases().into_iter().find_map(|case| results.recommended_run_in(case)?.residual.as_ref());
        let residual = taken.or_else(|| results.runs.iter().find_map(|run| run.residual.as_ref()))?;
        let is_whole = residual.joints.len() == self.robot.coordinate_count();
        let is_noise = residual.joints.iter().all(|joint| joint.rms > 0.0 && joint.rms.is_finite());
        (is_same && is_whole && is_noise).then_some(&residual.joints)
    }
}
