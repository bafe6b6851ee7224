//! Recordings: arrays from Python, and arrays from files.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use numpy::{IntoPyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::{prelude::*, types::PyDict};
use thetahat::{
    Experiment, OneOrEach,
    experiment::{ProposalRequest, propose},
    recording::{Unit, inspect_with_time},
};

use crate::{
    arrays::{array_of, series_of},
    interruptible,
    python_error::PythonError,
    robot::{Robot, vector_of},
    values,
};

/// A recording of the package: its arrays have the same number of rows.
#[derive(FromPyObject)]
pub struct Recording<'py> {
    name: String,
    weight: f64,
    sample_rate_hz: Option<f64>,
    time: Option<PyReadonlyArray1<'py, f64>>,
    window_s: (Option<f64>, Option<f64>),
    gaps: Vec<(usize, usize)>,
    position: PyReadonlyArray2<'py, f64>,
    torque: Option<PyReadonlyArray2<'py, f64>>,
    torque_hold_s: f64,
    velocity: Option<PyReadonlyArray2<'py, f64>>,
    reference: Option<PyReadonlyArray2<'py, f64>>,
    added_signal: Option<PyReadonlyArray2<'py, f64>>,
    channels: BTreeMap<String, PyReadonlyArray2<'py, f64>>,
    payload: Option<String>,
    geared: bool,
}

impl Recording<'_> {
    /// The library's recording, with copies of the arrays; without a rate, it is resampled to equal steps.
    pub fn into_library(self) -> Result<thetahat::Recording, PythonError> {
        let optional = |array: &Option<PyReadonlyArray2<'_, f64>>| array.as_ref().map(|a| series_of(a.as_array()));
        let time = self.time.as_ref().map(vector_of);
        let recording = thetahat::Recording {
            name: self.name,
            weight: self.weight,
            window_s: [self.window_s.0, self.window_s.1],
            gaps: self.gaps.iter().map(|&(start, end)| start..end).collect(),
            torque: optional(&self.torque),
            torque_hold_s: self.torque_hold_s,
            velocity: optional(&self.velocity),
            reference: optional(&self.reference),
            added_signal: optional(&self.added_signal),
            channels: self.channels.iter().map(|(name, a)| (name.clone(), series_of(a.as_array()))).collect(),
            payload: self.payload,
            geared: self.geared,
            ..thetahat::Recording::without_torque(
                self.sample_rate_hz.unwrap_or(1.0),
                series_of(self.position.as_array()),
            )
        };
        match (self.sample_rate_hz, time) {
            (None, Some(time)) => Ok(recording.with_time_stamps(time)?),
            (_, time_stamps_s) => Ok(thetahat::Recording { time_stamps_s, ..recording }),
        }
    }
}

/// Recordings of the library.
pub fn into_library(recordings: Vec<Recording<'_>>) -> Result<Vec<thetahat::Recording>, PythonError> {
    recordings.into_iter().map(Recording::into_library).collect()
}

/// A recording as the arguments of the package's class; arrays share the memory of the library's series.
fn arguments(py: Python<'_>, recording: thetahat::Recording) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("name", recording.name)?;
    all.set_item("weight", recording.weight)?;
    all.set_item("sample_rate_hz", recording.sample_rate_hz)?;
    all.set_item("time", recording.time_stamps_s.map(|stamps| stamps.into_pyarray(py)))?;
    all.set_item("window_s", (recording.window_s[0], recording.window_s[1]))?;
    all.set_item("gaps", recording.gaps.iter().map(|gap| (gap.start, gap.end)).collect::<Vec<_>>())?;
    all.set_item("position", array_of(py, recording.position)?)?;
    all.set_item("torque_hold_s", recording.torque_hold_s)?;
    for (key, series) in [
        ("torque", recording.torque),
        ("velocity", recording.velocity),
        ("reference", recording.reference),
        ("added_signal", recording.added_signal),
    ] {
        all.set_item(key, series.map(|series| array_of(py, series)).transpose()?)?;
    }
    let channels = PyDict::new(py);
    for (name, series) in recording.channels {
        channels.set_item(name, array_of(py, series)?)?;
    }
    all.set_item("channels", channels)?;
    all.set_item("payload", recording.payload)?;
    all.set_item("geared", recording.geared)?;
    Ok(all)
}

/// Settings for what the names of columns do not show.
#[derive(serde::Deserialize)]
struct Columns {
    #[serde(default)]
    position: Vec<String>,
    #[serde(default)]
    torque: Vec<String>,
    #[serde(default)]
    joints: Vec<String>,
    time: Option<String>,
    sample_rate_hz: Option<f64>,
    position_unit: Option<OneOrEach<Unit>>,
    torque_unit: Option<OneOrEach<Unit>>,
}

/// Reads recordings of a robot from files in a folder, as `thetahat init` understands them.
#[pyfunction]
pub fn read_recordings<'py>(
    py: Python<'py>,
    robot: &Robot,
    files: Vec<PathBuf>,
    folder: PathBuf,
    columns: &Bound<'py, PyAny>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let columns: Columns = values::read(columns)?;
    let robot = robot.clone();
    let found = interruptible::run(py, None, move |_| read(&robot, files, &folder, columns))?;
    found.into_iter().map(|recording| arguments(py, recording)).collect()
}

fn read(
    robot: &Robot,
    files: Vec<PathBuf>,
    folder: &Path,
    columns: Columns,
) -> Result<Vec<thetahat::Recording>, PythonError> {
    let inspect = |file: &Path| inspect_with_time(file, columns.time.as_deref());
    let contents = files.iter().map(|file| inspect(&folder.join(file))).collect::<Result<Vec<_>, _>>()?;
    let request = ProposalRequest {
        robot_file: PathBuf::from("robot"),
        recording_files: files,
        position: columns.position,
        torque: columns.torque,
        joints: columns.joints,
        time: columns.time,
        sample_rate_hz: columns.sample_rate_hz,
        position_unit: columns.position_unit,
        torque_unit: columns.torque_unit,
        ..ProposalRequest::default()
    };
    let source = robot.source()?;
    let proposal = propose(&request, &source, &contents)?;
    let is_locked = |joint: &str| robot.robot.locked.iter().any(|locked| locked.name == joint);
    let missing: Vec<String> = proposal.locks.iter().map(|lock| lock.joint.clone()).filter(|j| !is_locked(j)).collect();
    if !missing.is_empty() {
        let text = format!(
            "the recording has no channels of {}; lock them where they stand: locked={{\"{}\": 0.0}} as the robot is read",
            missing.join(", "),
            missing[0]
        );
        return Err(PythonError::new("RecordingError", text));
    }
    let experiment = Experiment::from_texts(Path::new("the recording"), proposal.text(), source.to_text())?;
    Ok(experiment.recordings(folder)?)
}
