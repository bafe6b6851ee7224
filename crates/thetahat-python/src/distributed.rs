//! Jobs of campaigns and reductions that may run elsewhere: texts in, the content of files out.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use pyo3::{prelude::*, types::PyBytes};
use thetahat::{
    Experiment,
    campaign::{self, Campaign, Key, Row, Store, Subset},
    reduction::{ReduceOptions, Reduction, estimates_of_results},
};
use thetahat_estimation::statistics;
use thetahat_ground::output::{OutputError, OutputGuard};
use thetahat_report::report::{self, TextWidth};

use crate::{python_error::PythonError, remedies, results::Results, robot::Robot};

/// The texts of a campaign, of its experiment and of its robot, each of the first two after its path, and the SHA-256 of the file that
/// the twin follows, if it follows one.
type CampaignTexts = (PathBuf, String, PathBuf, String, String, Option<String>);

/// The index of a recording: noise level, start and seed, from zero.
type Place = (u32, u32, u32);

/// Reads a campaign; a job needs only its texts and the file that the twin follows. Paths are absolute: a worker may be in
/// another folder.
#[pyfunction]
pub fn campaign_texts(path: PathBuf) -> Result<CampaignTexts, PythonError> {
    let Campaign { path, text, experiment, .. } = Campaign::read(&path)?;
    let followed = experiment.reference_sha256()?;
    Ok((absolute(path), text, absolute(experiment.path), experiment.text, experiment.robot_text, followed))
}

/// The absolute path; unchanged if the system does not report the current folder.
fn absolute(path: PathBuf) -> PathBuf {
    std::path::absolute(&path).unwrap_or(path)
}

/// The shared data of all recordings of a campaign, made from its texts.
#[pyclass(frozen, module = "thetahat._thetahat")]
#[derive(Debug)]
pub struct Bench(campaign::Bench);

#[pymethods]
impl Bench {
    #[new]
    fn new(py: Python<'_>, texts: CampaignTexts, starts: Option<u32>) -> Result<Self, PythonError> {
        py.detach(|| {
            let limits = Subset { starts, seeds: None };
            Ok(Self(campaign::Bench::new(&campaign_of(texts)?, limits)?))
        })
    }

    /// Runs recordings: the content of a part of the campaign's store.
    fn part<'py>(&self, py: Python<'py>, places: Vec<Place>) -> Result<Bound<'py, PyBytes>, PythonError> {
        let keys: Vec<Key> = places.into_iter().map(|(level, start, seed)| Key { level, start, seed }).collect();
        let content = py.detach(|| self.0.part(&keys))?;
        Ok(PyBytes::new(py, &content))
    }

    /// The recordings that a folder does not have yet; it must be new or empty, or contain runs of this campaign.
    fn missing(
        &self,
        py: Python<'_>,
        texts: CampaignTexts,
        folder: PathBuf,
        limits: (Option<u32>, Option<u32>),
    ) -> Result<Vec<Place>, PythonError> {
        py.detach(|| {
            let campaign = campaign_of(texts)?;
            OutputGuard::new(campaign.input_files(), false)
                .folder(&folder, [report::CAMPAIGN_PAGE])
                .map_err(not_replaced)?;
            let store = Store::open(&folder, &campaign)?;
            let missing = campaign.missing(&self.0, subset(limits), &store)?;
            Ok(missing.into_iter().map(|key| (key.level, key.start, key.seed)).collect())
        })
    }
}

/// Why a campaign's page is not written; unlike the command, this never replaces a page of another origin.
fn not_replaced(error: OutputError) -> PythonError {
    let remedy = remedies::of_campaign_folder(&error);
    PythonError::with_remedy("CampaignError", error, remedy)
}

/// Combines the parts of a folder, as the command `campaign` does at its end: the tables, the numbers of runs and of converged runs, and
/// the files.
#[pyfunction]
pub fn finish_campaign(
    py: Python<'_>,
    bench: &Bench,
    texts: CampaignTexts,
    folder: PathBuf,
    limits: (Option<u32>, Option<u32>),
) -> Result<(String, usize, usize, Vec<PathBuf>), PythonError> {
    py.detach(|| {
        let campaign = campaign_of(texts)?;
        let store = Store::open(&folder, &campaign)?;
        let runs = campaign.run_on(&bench.0, subset(limits), 1, Some(&store), &mut |_| {})?;
        let results = campaign.results(&runs);
        let page = report::write_campaign(&results, &folder)?;
        let text = report::campaign_text(&results, TextWidth::DEFAULT);
        let converged = runs.rows.iter().filter(|row| Row::has_converged(row)).count();
        Ok((text, runs.rows.len(), converged, runs.files.into_iter().chain([page]).collect()))
    })
}

fn campaign_of(
    (path, text, experiment_path, experiment, robot, followed): CampaignTexts,
) -> Result<Campaign, PythonError> {
    let experiment = Experiment::from_texts(&experiment_path, experiment, robot)?;
    if experiment.reference_sha256()? != followed {
        let problem = "the file of [twin] reference is not the one that the campaign was begun with; all workers need the same file";
        return Err(PythonError::new("CampaignError", format!("{}: {problem}", experiment_path.display())));
    }
    Ok(Campaign::from_text(&path, text, experiment)?)
}

fn subset((starts, seeds): (Option<u32>, Option<u32>)) -> Subset {
    Subset { starts, seeds }
}

/// The texts of an experiment and of its robot, the first after its path.
type ExperimentTexts = (PathBuf, String, String);

/// Reads an experiment: its texts, the files that a run reads, and the number of its recordings, one for a twin. If a run reads a file
/// next to the experiment, its path is absolute: a worker may be in another folder.
#[pyfunction]
pub fn experiment_texts(
    path: PathBuf,
    data: PathBuf,
    robot: Option<PathBuf>,
) -> Result<(ExperimentTexts, Vec<PathBuf>, usize), PythonError> {
    let experiment = match robot {
        Some(robot) => Experiment::read_with_robot(&path, &robot)?,
        None => Experiment::read(&path, &data)?,
    };
    let (files, recordings) = (experiment.input_files(&data), experiment.file.recording.len());
    let reads_neighbour = experiment.file.twin.as_ref().is_some_and(|twin| twin.reference.is_some());
    let path = if reads_neighbour { absolute(experiment.path) } else { experiment.path };
    Ok(((path, experiment.text, experiment.robot_text), files, recordings.max(1)))
}

fn experiment_of((path, text, robot): ExperimentTexts) -> Result<Experiment, PythonError> {
    Ok(Experiment::from_texts(&path, text, robot)?)
}

/// Runs an experiment from texts on one thread: jobs run in parallel.
#[pyfunction]
pub fn run_texts(py: Python<'_>, texts: ExperimentTexts, data: PathBuf) -> Result<Results, PythonError> {
    py.detach(|| {
        let experiment = experiment_of(texts)?;
        let results = experiment.run_on_threads(&data, 1, &mut |_| {})?;
        Ok(Results::new(results, experiment.published_path()))
    })
}

/// Start and end of the reduced part of each recording of an experiment, s.
#[pyfunction]
pub fn recording_spans(py: Python<'_>, texts: ExperimentTexts, data: PathBuf) -> Result<Vec<[f64; 2]>, PythonError> {
    py.detach(|| Ok(experiment_of(texts)?.recording_spans_s(&data)?))
}

/// The estimates of a `results.json` from which instruments are simulated.
#[pyfunction]
pub fn instruments_of(path: PathBuf, texts: ExperimentTexts) -> Result<BTreeMap<String, f64>, PythonError> {
    Ok(estimates_of_results(&path, &experiment_of(texts)?)?)
}

/// Reduces a recording of an experiment, or a time segment of it: the content of the file.
#[pyfunction]
pub fn reduce<'py>(
    py: Python<'py>,
    texts: ExperimentTexts,
    data: PathBuf,
    recording: usize,
    window_s: Option<[f64; 2]>,
    instruments: Option<BTreeMap<String, f64>>,
) -> Result<Bound<'py, PyBytes>, PythonError> {
    let content = py.detach(|| {
        let part = experiment_of(texts)?.part(recording, window_s)?;
        // Parts of one recording are solved as the whole from their rows alone.
        let options = ReduceOptions { rows_only: window_s.is_some(), ..ReduceOptions::default() };
        let reduction = part.reduce_with_instruments(&data, instruments.as_ref(), options, &mut |_| {})?;
        bytes_of(&reduction)
    })?;
    Ok(PyBytes::new(py, &content))
}

/// Merges reductions, each given by the name and content of its file, in their order.
#[pyfunction]
pub fn merge<'py>(py: Python<'py>, reductions: Vec<(PathBuf, Vec<u8>)>) -> Result<Bound<'py, PyBytes>, PythonError> {
    let content = py.detach(|| {
        let all = reductions.iter().map(|(name, bytes)| Reduction::from_bytes(bytes, name));
        bytes_of(&Reduction::merge_all(all.collect::<Result<Vec<_>, _>>()?)?)
    })?;
    Ok(PyBytes::new(py, &content))
}

/// Estimates from the content of a reduction's file.
#[pyfunction]
pub fn solve(py: Python<'_>, name: PathBuf, content: Vec<u8>) -> Result<(Results, Robot), PythonError> {
    py.detach(|| {
        let reduction = Reduction::from_bytes(&content, &name)?;
        let results = reduction.solve()?.results;
        let (text, robot_text) = (&results.experiment_description, &results.robot_description);
        let path = Path::new(&reduction.experiment_name);
        let robot = Robot::of_experiment(path, text, robot_text, &results.profiled_terms)?;
        Ok((Results::new(results, None), robot))
    })
}

fn bytes_of(reduction: &Reduction) -> Result<Vec<u8>, PythonError> {
    reduction.to_bytes().map_err(|e| PythonError::new("ReductionError", e))
}

/// Probability that a chi-squared variable is at least as large; NaN without degrees of freedom.
#[pyfunction]
pub fn chi_squared_probability(statistic: f64, freedom: usize) -> f64 {
    statistics::chi_squared_test(statistic, freedom).map_or(f64::NAN, |test| test.p_value)
}

/// The same for an F variable.
#[pyfunction]
pub fn f_probability(statistic: f64, numerator_freedom: f64, denominator_freedom: f64) -> f64 {
    statistics::f_probability(statistic, numerator_freedom, denominator_freedom).unwrap_or(f64::NAN)
}

/// The quantile of Student's t; NaN without degrees of freedom.
#[pyfunction]
pub fn t_quantile(probability: f64, freedom: f64) -> f64 {
    statistics::t_quantile(probability, freedom).unwrap_or(f64::NAN)
}
