use std::path::Path;

use super::{
    compressed::Compressed,
    error::ReductionError,
    value::{ComparedRecordings, ReducedRecording, Reduction},
};
use crate::{
    experiment::Experiment,
    preparation::{Case, Recording},
    run::{Folds, ModelData, ReducedData, ReducedIdentification, SimulatedInstruments},
};
use thetahat_estimation::{
    identification::{DesignMatrix, Needs},
    regression::Regression,
};
use thetahat_report::results::{NotExamined, ReasonCode, RecordingFindings, RecordingResult, Results};

/// The name under which findings of several recordings stand.
const TOGETHER: &str = "all recordings";

/// The estimate from a reduction.
#[derive(Debug, Clone)]
pub struct Solution {
    /// In the form of an identification. From rows: the nominal runs of the methods that need the measured motion alone, and
    /// with instruments also of IDIM-IV.
    pub results: Results,
    /// Where the intervals come from.
    pub intervals: IntervalSource,
}

/// From what intervals of estimates are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IntervalSource {
    /// From the correlation of the rows in time, as those of an identification.
    Rows,
    /// From the scores of so many stretches of time.
    Stretches(usize),
    /// There are none.
    None,
}

impl Reduction {
    /// Identifies: [`Experiment::run`] on the samples of the recordings, where they are kept. Otherwise from the rows, or from
    /// their triangular factors: estimates, classical deviations, errors and the model are the same, and so are the reasons of the
    /// verdict, but for those that are listed as not examined.
    ///
    /// The settings are those of the experiment of the first reduction. Intervals are those of an identification where all
    /// rows are kept; else they come from the scores of the stretches of time, by bias-reduced linearisation (CR2) of
    /// R. M. Bell and D. F. McCaffrey, 2002, with its degrees of freedom.
    ///
    /// A motion that does not identify the parameters is not an error: the run says so in its status.
    ///
    /// # Errors
    /// [`ReductionError`] where the experiment in the reduction cannot be used.
    pub fn solve(&self) -> Result<Solution, ReductionError> {
        self.solve_with_progress(&mut |_| {})
    }

    /// The same; `progress` receives what is being done.
    ///
    /// # Errors
    /// As [`Reduction::solve`].
    pub fn solve_with_progress(&self, progress: &mut dyn FnMut(&str)) -> Result<Solution, ReductionError> {
        let experiment = self.experiment()?;
        if !self.recordings.is_empty()
            && let Some(recordings) = self.recordings.iter().map(ReducedRecording::recording).collect()
        {
            return self.solve_samples(&experiment, recordings, progress);
        }
        self.solve_rows(&experiment)
    }

    fn solve_samples(
        &self,
        experiment: &Experiment,
        recordings: Vec<Recording>,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Solution, ReductionError> {
        let results = experiment.run_on_kept(recordings, progress)?;
        let not_examined = not_held_back(experiment).into_iter().collect();
        Ok(Solution { results: Results { not_examined, ..results }, intervals: IntervalSource::Rows })
    }

    fn solve_rows(&self, experiment: &Experiment) -> Result<Solution, ReductionError> {
        let setup = experiment.setup();
        let basis = setup.basis(&Case::nominal()).map_err(|e| experiment.refuse(e))?;
        if basis.base.parameters().iter().map(|p| &p.name).ne(&self.identity.parameters) {
            let reason = "its base parameters are not those that this program finds for its robot".to_owned();
            return Err(ReductionError::Damaged { path: (&self.experiment_name).into(), reason });
        }
        if self.recordings.is_empty() {
            return Err(ReductionError::Nothing);
        }
        let data = self.data(experiment);
        let stretches = data.regression.layout.blocks().iter().map(|b| b.stretch + 1).max().unwrap_or(0);
        let is_in_time_order = data.regression.is_in_time_order;
        let identification = ReducedIdentification::new(setup, basis, data).map_err(|e| experiment.refuse(e))?;
        let results = identification.run().map_err(|e| experiment.refuse(e))?;
        let has_intervals = results.runs.iter().flat_map(|r| &r.parameters).any(|p| p.interval_95.is_some());
        let intervals = match (has_intervals, is_in_time_order) {
            (false, _) => IntervalSource::None,
            (true, true) => IntervalSource::Rows,
            (true, false) => IntervalSource::Stretches(stretches),
        };
        let results = Results {
            title: experiment.file.title.clone(),
            seed: experiment.file.twin.as_ref().map(|t| t.sensors.seed),
            experiment_description: self.experiment_description.clone(),
            robot_description: self.robot_description.clone(),
            robot_files: experiment.robot_hashes.clone(),
            ..results
        };
        Ok(Solution { results, intervals })
    }

    /// The experiment from the texts of the reduction.
    pub(super) fn experiment(&self) -> Result<Experiment, ReductionError> {
        let (text, robot) = (self.experiment_description.clone(), self.robot_description.clone());
        Ok(Experiment::from_texts(Path::new(&self.experiment_name), text, robot)?)
    }

    /// The rows with what is known of the recordings.
    fn data(&self, experiment: &Experiment) -> ReducedData {
        let Compressed { regression, z } = Compressed::of(self);
        let theta = self.instruments.clone();
        let findings = |r: &ReducedRecording| RecordingFindings {
            recording: r.name.clone(),
            held_back: false,
            findings: r.findings.clone(),
        };
        let together = |c: &ComparedRecordings| {
            let findings = c.findings.clone();
            (!findings.is_empty()).then(|| RecordingFindings {
                recording: TOGETHER.to_owned(),
                held_back: false,
                findings,
            })
        };
        ReducedData {
            folds: self.folds(&regression),
            not_examined: self.not_examined(experiment, &regression),
            instruments: z.zip(theta).map(|(z, theta)| SimulatedInstruments { z, theta }),
            regression,
            model: self.model_data(),
            recordings: self.recordings.iter().map(ReducedRecording::describe).collect(),
            rows: self.recordings.iter().map(|r| r.rows * self.identity.joints.len()).sum(),
            truth: self.recordings.first().and_then(|r| r.truth.clone()),
            findings: self.recordings.iter().map(findings).collect(),
            compared: self.compared.iter().filter_map(together).collect(),
        }
    }

    /// What the model is chosen from.
    fn model_data(&self) -> ModelData {
        let recordings = self.recordings.iter().map(|r| (r.weight.sqrt(), r.model.clone())).collect();
        ModelData { columns: self.identity.model_columns(), recordings }
    }

    /// What is left out in turn: a recording where there are several, else what was found in the only one, else fifths of
    /// its stretches of time.
    fn folds(&self, regression: &Regression) -> Option<Folds> {
        let layout = &regression.layout;
        let [only] = &self.recordings[..] else {
            let mut of_row = layout.spread(|b| b.recording);
            if regression.is_in_time_order {
                of_row.truncate(layout.len() / layout.joints().max(1));
            }
            return Folds::of_recordings(of_row, self.recordings.iter().map(|r| &*r.name));
        };
        if !regression.is_in_time_order {
            return Some(Folds::of_stretches(&layout.spread(|b| b.stretch)));
        }
        only.folds.as_ref().map(|folds| Folds { of_row: folds.of_row.clone(), names: folds.names.clone() })
    }

    /// The reasons of a verdict that only samples give which are not there.
    fn not_examined(&self, experiment: &Experiment, regression: &Regression) -> Vec<NotExamined> {
        let not_compared = !self.are_compared();
        let in_parts = self.recordings.iter().any(|r| r.examined_parts != 1);
        let simulates = experiment.settings.estimation.methods.iter().any(|m| {
            !matches!((m.needs(), m.design()), (Needs::Measurement, _) | (Needs::Instruments, DesignMatrix::Measured))
        });
        let absent = [
            (
                not_compared,
                ReasonCode::RecordingsDisagree,
                "the recordings were not reduced together, or are too long to compare: whether one estimate explains all of them \
                 was not tested",
            ),
            (
                in_parts,
                ReasonCode::CheckProblem,
                "long recordings were checked in parts, at most sixteen of each, without recorded velocities, references and time \
                 stamps",
            ),
            (
                !regression.is_in_time_order,
                ReasonCode::CorrelatedResidual,
                "triangular factors have no rows in time order: the residual was not tested for noise",
            ),
            (
                !regression.is_in_time_order,
                ReasonCode::NothingExplained,
                "triangular factors have no rows in time order: what the model explains of each joint was judged by its error alone",
            ),
            (
                true,
                ReasonCode::Cause,
                "what a reduction keeps has no samples: causes of the model's error, and torque terms for them, were not tested",
            ),
            (
                simulates,
                ReasonCode::Undecided,
                "methods that simulate the closed loop need the recordings: none was compared with the estimate",
            ),
        ];
        let missing = absent.into_iter().filter(|(is_absent, ..)| *is_absent);
        let missing = missing.map(|(_, code, why)| NotExamined { code, why: why.to_owned() });
        missing.chain(not_held_back(experiment)).collect()
    }

    /// Whether all recordings were compared with one another.
    fn are_compared(&self) -> bool {
        let all = |c: &ComparedRecordings| self.recordings.iter().all(|r| c.fingerprints.contains(&r.fingerprint));
        self.recordings.len() < 2 || self.compared.iter().any(all)
    }
}

/// That recordings which are held back were not reduced.
fn not_held_back(experiment: &Experiment) -> Option<NotExamined> {
    let why = "recordings that are held back are not reduced: the estimate was not tested on them";
    let not_examined = NotExamined { code: ReasonCode::CrossValidation, why: why.to_owned() };
    (!experiment.file.validation.is_empty()).then_some(not_examined)
}

impl ReducedRecording {
    /// The recording itself, where it is kept.
    fn recording(&self) -> Option<Recording> {
        self.samples_kept.as_deref().cloned()
    }

    fn describe(&self) -> RecordingResult {
        RecordingResult {
            name: self.name.clone(),
            weight: self.weight,
            samples_used: self.samples,
            sample_rate_hz: self.sample_rate_hz,
            window_s: self.window_s,
            resampling: None,
            notes: Vec::new(),
            torque_bandwidth_hz: None,
            torque_hold_s: self.torque_hold_s,
            near_rest: self.near_rest.clone(),
            reference: None,
        }
    }
}
