//! The run of an experiment: its recordings are read, and identified with its settings.

use std::path::Path;

use super::{
    description::{Experiment, RecordingDescription},
    error::ExperimentError,
    remedies,
};
use crate::{
    filter_choice::choose_filter,
    preparation::{Case, Recording},
    run::{Identification, check_recordings, examine_robot},
};
use thetahat_ground::pool::available_threads;
use thetahat_report::results::{Filter, FilterChoice, RecordingFindings, Results, Sensitivity};

impl Experiment {
    /// Runs every case and method. `data` is the folder against which the paths of the data are resolved; `progress` receives what is being done.
    ///
    /// A method that does not converge or a motion that does not identify the parameters is not an error: the run says
    /// so in its status.
    ///
    /// # Errors
    /// [`ExperimentError`] for input that cannot be used.
    pub fn run(&self, data: &Path, progress: &mut dyn FnMut(&str)) -> Result<Results, ExperimentError> {
        self.run_on_threads(data, available_threads(), progress)
    }

    /// The same on `threads` threads; the results do not depend on their number.
    ///
    /// # Errors
    /// As [`Experiment::run`].
    pub fn run_on_threads(
        &self,
        data: &Path,
        threads: usize,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Results, ExperimentError> {
        progress("reading and filtering the recordings");
        self.results_of(self.identification(data)?.on_threads(threads), progress)
    }

    /// The same on recordings that were read before, as by [`Experiment::recordings`].
    ///
    /// # Errors
    /// As [`Experiment::run`].
    pub fn run_on(
        &self,
        recordings: Vec<Recording>,
        data: &Path,
        threads: usize,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Results, ExperimentError> {
        self.results_of(self.with_validation(recordings, data)?.on_threads(threads), progress)
    }

    fn results_of(
        &self,
        identification: Identification,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Results, ExperimentError> {
        let mut results = self.results_without_steps(identification, progress)?;
        remedies::enter(self, &mut results);
        Ok(results)
    }

    /// The results on recordings that have no files: no recording is held back, and no step of a remedy changes a file.
    pub(crate) fn run_on_kept(
        &self,
        recordings: Vec<Recording>,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Results, ExperimentError> {
        self.results_without_steps(self.identification_of(recordings)?, progress)
    }

    fn results_without_steps(
        &self,
        identification: Identification,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Results, ExperimentError> {
        let results = identification.run_with_progress(progress).map_err(|e| self.refuse(e))?;
        Ok(Results {
            title: self.file.title.clone(),
            seed: self.file.twin.as_ref().map(|t| t.sensors.seed),
            experiment_description: self.text.clone(),
            robot_description: self.robot_text.clone(),
            robot_files: self.robot_hashes.clone(),
            ..results
        })
    }

    /// Estimates by IV and DIDIM without an error of the simulator and with each one. `progress` receives the number of estimations that
    /// are done and their total; the result does not depend on the number of `threads`.
    ///
    /// # Errors
    /// [`ExperimentError`] for input that cannot be used, or without a `[controller]`.
    pub fn sensitivity(
        &self,
        data: &Path,
        threads: usize,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Sensitivity, ExperimentError> {
        let identification = self.identification(data)?;
        let sensitivity = identification.sensitivity(threads, progress).map_err(|e| self.refuse(e))?;
        Ok(Sensitivity { title: self.file.title.clone(), ..sensitivity })
    }

    /// Checks every recording; nothing is estimated.
    ///
    /// # Errors
    /// [`ExperimentError`] for input that cannot be used. What is used but looks wrong is a finding.
    pub fn check(&self, data: &Path) -> Result<Vec<RecordingFindings>, ExperimentError> {
        let held_back = self.read_all(&self.file.validation, data)?;
        let of_recordings = check_recordings(self.setup(), self.recordings(data)?, held_back);
        let of_robot = examine_robot(&self.robot).into_iter();
        Ok(of_robot.chain(of_recordings.map_err(|e| self.refuse(e))?).collect())
    }

    /// The filter that is best for the estimates from the recordings, compared with a grid of others and with
    /// `also`. The result does not depend on the number of `threads`.
    ///
    /// # Errors
    /// [`ExperimentError`] for input that cannot be used, and where no filter gives an estimate.
    pub fn choose_filter(
        &self,
        data: &Path,
        also: Option<Filter>,
        threads: usize,
    ) -> Result<FilterChoice, ExperimentError> {
        let recordings = self.recordings(data)?;
        choose_filter(&self.robot, &self.settings, &recordings, also, threads)
            .map_err(|source| ExperimentError::Filter { path: self.path.clone(), source })
    }

    /// The recordings, read or made by the twin, with the settings.
    fn identification(&self, data: &Path) -> Result<Identification, ExperimentError> {
        self.with_validation(self.recordings(data)?, data)
    }

    /// Given recordings and those that are held back, with the settings.
    fn with_validation(&self, recordings: Vec<Recording>, data: &Path) -> Result<Identification, ExperimentError> {
        let main = self.identification_of(recordings)?;
        main.with_validation(self.read_all(&self.file.validation, data)?).map_err(|e| self.refuse(e))
    }

    /// Given recordings with the settings.
    pub(super) fn identification_of(&self, recordings: Vec<Recording>) -> Result<Identification, ExperimentError> {
        Identification::new(&self.robot, recordings, self.settings.clone()).map_err(|e| self.refuse(e))
    }

    /// The recordings to identify from, on the joint side and at equal time steps, or the recording of the twin.
    ///
    /// # Errors
    /// [`ExperimentError`] for files that cannot be used, or a twin that cannot be simulated.
    pub fn recordings(&self, data: &Path) -> Result<Vec<Recording>, ExperimentError> {
        match &self.file.twin {
            Some(twin) => Ok(vec![self.simulate_twin(twin)?]),
            None => self.read_all(&self.file.recording, data),
        }
    }

    fn read_all(&self, descriptions: &[RecordingDescription], data: &Path) -> Result<Vec<Recording>, ExperimentError> {
        descriptions.iter().enumerate().map(|(i, d)| self.read_recording(d, i + 1, data)).collect()
    }

    /// The nominal case and the others.
    #[must_use]
    pub fn cases(&self) -> Vec<Case> {
        self.settings.all_cases()
    }
}
