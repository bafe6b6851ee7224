//! Results: their JSON, the files of the report, and curves as arrays.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use pyo3::{prelude::*, types::PyBytes};
use thetahat::{
    Experiment,
    experiment::EstimateRequest,
    export::{ExportFormat, IdentifiedModel},
    identification::UnknownMethod,
    report::Published,
};
use thetahat_ground::output::{FileKind, OutputGuard, replace_file};
use thetahat_report::{
    report::{self, TextWidth},
    results::{Plots, RunPlots},
};

use crate::{arrays::rows, python_error::PythonError, robot::Robot};

/// Curves of joints over the same times, one array with a column for each joint.
type Curves<'py> = Bound<'py, numpy::PyArray2<f64>>;

/// The results of a run.
#[pyclass(frozen, module = "thetahat._thetahat")]
#[derive(Debug)]
pub struct Results {
    results: thetahat::Results,
    published: Option<PathBuf>,
}

impl Results {
    pub fn new(results: thetahat::Results, published: Option<PathBuf>) -> Self {
        Self { results, published }
    }

    fn published(&self) -> Result<Option<Published>, PythonError> {
        Ok(self.published.as_deref().map(Published::read).transpose()?)
    }
}

/// Curves of the results, of their runs, and predictions of the user's own estimators: the samples of each joint.
type PackedCurves = (Plots, Vec<RunPlots>, Vec<Vec<Vec<f64>>>);

#[pymethods]
impl Results {
    /// Results of a `results.json`, without curves, and the robot of their experiment, if they have one.
    #[staticmethod]
    fn read(path: PathBuf) -> Result<(Self, Option<Robot>), PythonError> {
        let mut results = thetahat::Results::read(&path)?;
        let (text, robot_text) = (&results.experiment_description, &results.robot_description);
        if text.is_empty() {
            return Ok((Self::new(results, None), None));
        }
        let parameters = Experiment::from_texts(&path, text.clone(), robot_text.clone())?.settings.parameters;
        let robot = Robot::of_experiment(&path, text, robot_text, &results.profiled_terms)?;
        // Files of before these keys have them in their experiment alone.
        (results.excluded_parameters, results.fixed_parameters) = (parameters.exclude, parameters.fix);
        Ok((Self::new(results, None), Some(robot)))
    }

    /// The results of their JSON and packed curves, which [`Results::__reduce__`] gives.
    #[staticmethod]
    fn from_state(json: &str, packed_curves: &[u8], published: Option<PathBuf>) -> Result<Self, PythonError> {
        let mut results = thetahat::Results::from_json(Path::new("a pickled result"), json)?;
        let unpacked: Result<PackedCurves, _> = rmp_serde::from_slice(packed_curves);
        let (plots, runs, of_user) =
            unpacked.map_err(|e| PythonError::new("ResultsError", format!("a pickled result's curves: {e}")))?;
        results.plots = plots;
        results.runs.iter_mut().zip(runs).for_each(|(run, plots)| run.plots = plots);
        results.user_runs.iter_mut().zip(of_user).for_each(|(run, predicted)| run.predicted = predicted);
        Ok(Self::new(results, published))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, own) = (slf.py(), slf.get());
        let curves = PyBytes::new(py, &own.packed_curves()?);
        let state = (own.to_json()?, curves, &own.published);
        Ok((slf.get_type().getattr("from_state")?, state.into_pyobject(py)?.into_any()))
    }

    fn to_json(&self) -> Result<String, PythonError> {
        Ok(self.results.to_json()?)
    }

    #[getter]
    fn excluded(&self) -> Vec<String> {
        self.results.excluded_parameters.clone()
    }

    #[getter]
    fn fixed(&self) -> BTreeMap<String, f64> {
        self.results.fixed_parameters.clone()
    }

    /// The text of the experiment, which is at a path, with the remedies of these codes.
    fn with_remedies(&self, path: PathBuf, codes: Vec<String>) -> Result<String, PythonError> {
        let (text, robot) = (&self.results.experiment_description, &self.results.robot_description);
        let experiment = Experiment::from_texts(&path, text.clone(), robot.clone())?;
        Ok(experiment.with_remedies(&self.results.remedies, &codes)?)
    }

    /// The index of the recommended run.
    fn recommended_run(&self) -> Option<usize> {
        let recommended = self.results.recommended_run()?;
        self.results.runs.iter().position(|run| std::ptr::eq(run, recommended))
    }

    /// The tables that the command line prints with `--full`.
    fn text(&self) -> Result<String, PythonError> {
        Ok(report::text::all(&self.results, self.published()?.as_ref(), TextWidth::DEFAULT))
    }

    /// The content of one of the report's files.
    fn render<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyBytes>> {
        let content = py.detach(|| self.rendered(name))?;
        Ok(PyBytes::new(py, &content))
    }

    /// Writes one of the report's files atomically.
    fn write_file(&self, py: Python<'_>, name: &str, path: PathBuf, force: bool) -> PyResult<()> {
        let kind = report::files().find(|file| file.0 == name).map_or(FileKind::Unmarked, |file| file.1);
        py.detach(|| write_guarded((&path, kind), &self.rendered(name)?, force))?;
        Ok(())
    }

    /// Writes all files of the report into a folder; returns their paths.
    fn write(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<Vec<PathBuf>> {
        py.detach(|| {
            OutputGuard::new([], force).of_robot(&self.results.robot).folder(&folder, report::files())?;
            Ok(report::write_all(&self.results, self.published()?.as_ref(), &folder)?)
        })
        .map_err(|e: PythonError| e.into())
    }

    /// Writes the robot as a file atomically; returns remarks on it.
    fn export(
        &self,
        py: Python<'_>,
        path: PathBuf,
        format: &str,
        method: Option<&str>,
        untrusted: bool,
        force: bool,
    ) -> PyResult<Vec<String>> {
        let format: ExportFormat = format.parse().map_err(|e: String| PythonError::new("ResultsError", e))?;
        let method = method.map(str::parse).transpose().map_err(|e: UnknownMethod| PythonError::from(e))?;
        let request = EstimateRequest { method, untrusted, ..EstimateRequest::default() };
        py.detach(|| {
            let model = IdentifiedModel::of_results(Path::new("the results"), &self.results, &request)?;
            let export = model.export(format)?;
            let kind = match format {
                ExportFormat::Urdf | ExportFormat::Mjcf | ExportFormat::Sdf => FileKind::Robot,
                ExportFormat::Json | ExportFormat::Pace | ExportFormat::Isaac | ExportFormat::Bam => {
                    FileKind::RobotJson
                }
            };
            write_guarded((&path, kind), export.text.as_bytes(), force)?;
            Ok([model.about(), export.notes, export.not_represented].concat())
        })
        .map_err(|e: PythonError| e.into())
    }

    /// Times, measured torques and filtered positions of the decimated rows.
    fn curves<'py>(&self, py: Python<'py>) -> PyResult<[Curves<'py>; 3]> {
        let Plots { time_s, measured, position, .. } = &self.results.plots;
        Ok([array(py, std::slice::from_ref(time_s))?, array(py, measured)?, array(py, position)?])
    }

    /// Predicted torques and simulated positions of a run; indices after the runs are the user's own estimators.
    fn run_curves<'py>(&self, py: Python<'py>, run: usize) -> PyResult<[Curves<'py>; 2]> {
        let nothing: &[Vec<f64>] = &[];
        let (predicted, simulated) = match self.results.runs.get(run) {
            Some(run) => (&run.plots.predicted[..], &run.plots.simulated_position[..]),
            None => (&self.results.user_runs[run - self.results.runs.len()].predicted[..], nothing),
        };
        Ok([array(py, predicted)?, array(py, simulated)?])
    }
}

impl Results {
    /// The curves, which `results.json` does not contain, as MessagePack, which keeps NaN.
    fn packed_curves(&self) -> Result<Vec<u8>, PythonError> {
        let runs: Vec<&RunPlots> = self.results.runs.iter().map(|run| &run.plots).collect();
        let of_user: Vec<&Vec<Vec<f64>>> = self.results.user_runs.iter().map(|run| &run.predicted).collect();
        rmp_serde::to_vec(&(&self.results.plots, runs, of_user))
            .map_err(|e| PythonError::new("ResultsError", format!("the curves cannot be packed: {e}")))
    }

    fn rendered(&self, name: &str) -> Result<Vec<u8>, PythonError> {
        let content = report::render(name, &self.results, self.published()?.as_ref())?;
        content.ok_or_else(|| {
            let known: Vec<&str> = report::file_names().collect();
            PythonError::new(
                "ReportError",
                format!("the report has no file {name}; its files are {}", known.join(", ")),
            )
        })
    }
}

/// Writes a file atomically; a file that thetahat did not write is replaced only with `force`.
fn write_guarded((path, kind): (&Path, FileKind), content: &[u8], force: bool) -> Result<(), PythonError> {
    OutputGuard::new([], force).file(path, kind)?;
    replace_file(path, content)
        .map_err(|e| PythonError::new("ReportError", format!("{}: cannot be written: {e}", path.display())))
}

/// Curves side by side.
fn array<'py>(py: Python<'py>, curves: &[Vec<f64>]) -> PyResult<Curves<'py>> {
    let samples = curves.first().map_or(0, Vec::len);
    let values = (0..samples).flat_map(|k| curves.iter().map(move |curve| curve[k])).collect();
    rows(py, samples, curves.len(), values)
}
