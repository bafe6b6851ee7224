//! The robot: its description, its model, and computations on many samples.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2, PyReadwriteArray3,
};
use pyo3::{exceptions::PyValueError, prelude::*};
use thetahat::{
    Experiment,
    base_parameters::BaseParameters,
    dynamics::{DynamicParameters, DynamicsError, FrictionTransition, Model, Sign, State, Workspace},
    regressor::Regressor,
    results::ProfiledTerm,
    robot::{Locks, RobotSource, RobotSummary},
    run::with_constants,
};
use thetahat_report::report;

use crate::{
    arrays::{Samples, array_of, series_of},
    python_error::PythonError,
};

/// The data from which a robot is rebuilt.
#[derive(Debug, Clone)]
enum Origin {
    /// A description, with joints locked in addition to those that it locks.
    Description(RobotSource, Locks),
    /// An experiment, which may lock joints and add torque terms, and the constants that were found for these.
    Experiment { path: PathBuf, text: String, robot_text: String, constants: Vec<ProfiledTerm> },
}

/// A robot with its model.
#[pyclass(frozen, module = "thetahat._thetahat")]
#[derive(Debug, Clone)]
pub struct Robot {
    origin: Origin,
    pub robot: thetahat::Robot,
    model: Model,
}

impl Robot {
    fn new(origin: Origin) -> Result<Self, PythonError> {
        let robot = match &origin {
            Origin::Description(source, locks) => source.robot_with_locks(locks, Path::new("locked"))?,
            Origin::Experiment { path, text, robot_text, constants } => {
                let experiment = Experiment::from_texts(path, text.clone(), robot_text.clone())?;
                with_constants(&experiment.robot, constants)
            }
        };
        let model = Model::new(&robot);
        Ok(Self { origin, robot, model })
    }

    /// The robot of an experiment with the constants that a run found.
    pub fn of_experiment(
        path: &Path,
        text: &str,
        robot_text: &str,
        constants: &[ProfiledTerm],
    ) -> Result<Self, PythonError> {
        let (path, constants) = (path.to_owned(), constants.to_vec());
        Self::new(Origin::Experiment { path, text: text.to_owned(), robot_text: robot_text.to_owned(), constants })
    }

    /// The text of its description.
    pub fn description(&self) -> String {
        match &self.origin {
            Origin::Description(source, _) => source.to_text(),
            Origin::Experiment { robot_text, .. } => robot_text.clone(),
        }
    }

    /// The description without the joints that are locked on top of it.
    pub fn source(&self) -> Result<RobotSource, PythonError> {
        match &self.origin {
            Origin::Description(source, _) => Ok(source.clone()),
            Origin::Experiment { path, robot_text, .. } => Ok(RobotSource::from_text(robot_text.clone(), path)?),
        }
    }

    pub fn model(&self) -> &Model {
        &self.model
    }

    fn base(&self, excluded: &[String], fixed: &BTreeMap<String, f64>) -> Result<BaseParameters, PythonError> {
        Ok(BaseParameters::with_fixed(&self.model, excluded, fixed)?)
    }
}

#[pymethods]
impl Robot {
    /// A robot from the text of its description; `path` is its name in messages.
    #[staticmethod]
    fn parse(text: String, path: PathBuf, locked: BTreeMap<String, f64>) -> Result<Self, PythonError> {
        let locks = Locks { locked, until: Vec::new() };
        Self::new(Origin::Description(RobotSource::from_text(text, &path)?, locks))
    }

    /// A robot from a file.
    #[staticmethod]
    fn read(path: PathBuf, locked: BTreeMap<String, f64>) -> Result<Self, PythonError> {
        let locks = Locks { locked, until: Vec::new() };
        Self::new(Origin::Description(RobotSource::read(&path)?, locks))
    }

    /// A robot of an experiment; the constants are those of [`Robot::state`].
    #[staticmethod]
    fn from_experiment(path: PathBuf, text: &str, robot_text: &str, constants: &str) -> PyResult<Self> {
        let constants: Vec<ProfiledTerm> =
            serde_json::from_str(constants).map_err(|e| PythonError::new("RobotError", e))?;
        Ok(Self::of_experiment(&path, text, robot_text, &constants)?)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, class) = (slf.py(), slf.get_type());
        match &slf.get().origin {
            Origin::Description(source, locks) => {
                let state = (source.to_text(), source.path(), &locks.locked);
                Ok((class.getattr("parse")?, state.into_pyobject(py)?.into_any()))
            }
            Origin::Experiment { path, text, robot_text, constants } => {
                let constants = serde_json::to_string(constants).map_err(|e| PythonError::new("RobotError", e))?;
                let state = (path, text, robot_text, constants);
                Ok((class.getattr("from_experiment")?, state.into_pyobject(py)?.into_any()))
            }
        }
    }

    /// The text of its description.
    fn text(&self) -> String {
        self.description()
    }

    #[getter]
    fn coordinates(&self) -> usize {
        self.model.coordinate_count()
    }

    #[getter]
    fn parameter_names(&self) -> Vec<String> {
        self.model.parameter_table().iter().map(|p| p.name()).collect()
    }

    #[getter]
    fn parameter_units(&self) -> Vec<String> {
        self.model.parameter_table().iter().map(|p| p.unit.to_string()).collect()
    }

    #[getter]
    fn channels(&self) -> Vec<String> {
        self.robot.channels()
    }

    #[getter]
    fn a_priori<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.robot.a_priori_parameters().into_pyarray(py)
    }

    /// Its summary as JSON.
    fn summary(&self, py: Python<'_>) -> Result<String, PythonError> {
        py.detach(|| Ok(report::model_json(&RobotSummary::new(&self.source()?, &self.robot))?))
    }

    /// The indices of the columns that base parameters keep, their names, their formulas and their units.
    #[expect(clippy::type_complexity, reason = "a tuple is what Python unpacks")]
    fn base_parameters(
        &self,
        excluded: Vec<String>,
        fixed: BTreeMap<String, f64>,
    ) -> Result<(Vec<usize>, Vec<String>, Vec<String>, Vec<String>), PythonError> {
        let base = self.base(&excluded, &fixed)?;
        let all = base.parameters();
        Ok((
            base.columns(),
            all.iter().map(|p| p.name.clone()).collect(),
            all.iter().map(|p| p.expression.clone()).collect(),
            all.iter().map(|p| p.unit.to_string()).collect(),
        ))
    }

    /// The base parameters that standard ones have.
    fn base_of<'py>(&self, py: Python<'py>, theta: Vec<f64>) -> Result<Bound<'py, PyArray1<f64>>, PythonError> {
        let base = self.base(&[], &BTreeMap::new())?;
        Ok(base.from_standard(&theta).into_pyarray(py))
    }

    /// Standard parameters with the same torques as base parameters of these names.
    fn standard_of<'py>(
        &self,
        py: Python<'py>,
        estimates: BTreeMap<String, f64>,
        excluded: Vec<String>,
        fixed: BTreeMap<String, f64>,
    ) -> Result<Bound<'py, PyArray1<f64>>, PythonError> {
        let base = self.base(&excluded, &fixed)?;
        let values: Vec<f64> =
            base.parameters().iter().map(|p| estimates.get(&p.name).copied().unwrap_or(0.0)).collect();
        Ok(base.to_standard(&values).into_pyarray(py))
    }

    /// Fills `phi`, samples by coordinates by columns, over a motion `[q, dq, ddq]`.
    fn regressor<'py>(
        &self,
        py: Python<'py>,
        motion: [PyReadonlyArray2<'py, f64>; 3],
        columns: Vec<usize>,
        sign_velocity_scale: Option<SignScale>,
        mut phi: PyReadwriteArray3<'py, f64>,
    ) -> PyResult<()> {
        let regressor = Regressor::new(&self.model, &columns);
        let sign = sign_of(sign_velocity_scale)?;
        Samples::of(motion.each_ref()).fill(py, phi.as_slice_mut()?, |motion, phi| {
            self.model.check_positions(motion[0])?;
            regressor.evaluate_rows(&self.model, motion, 0..motion[0].len(), sign, phi);
            Ok(())
        })
    }

    /// Fills `tau`, samples by coordinates, with the torques of a motion `[q, dq, ddq]`.
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        motion: [PyReadonlyArray2<'py, f64>; 3],
        theta: Vec<f64>,
        sign_velocity_scale: Option<SignScale>,
        mut tau: PyReadwriteArray2<'py, f64>,
    ) -> PyResult<()> {
        let (n, sign) = (self.model.coordinate_count(), sign_of(sign_velocity_scale)?);
        let parameters = DynamicParameters::new(&self.model, &theta).map_err(wrong_parameters)?;
        Samples::of(motion.each_ref()).fill(py, tau.as_slice_mut()?, |[q, dq, ddq], tau| {
            self.model.check_positions(q)?;
            let mut workspace = Workspace::new(&self.model);
            for (k, tau) in tau.chunks_exact_mut(n).enumerate() {
                let state = State::new(q.sample(k), dq.sample(k));
                self.model.inverse_dynamics(&parameters, state, ddq.sample(k), sign, &mut workspace, tau);
            }
            Ok(())
        })
    }

    /// Fills `ddq`, samples by coordinates, with the accelerations of `[q, dq, tau]`.
    fn forward_dynamics<'py>(
        &self,
        py: Python<'py>,
        inputs: [PyReadonlyArray2<'py, f64>; 3],
        theta: Vec<f64>,
        sign_velocity_scale: Option<SignScale>,
        mut ddq: PyReadwriteArray2<'py, f64>,
    ) -> PyResult<()> {
        let sign = sign_of(sign_velocity_scale)?;
        let parameters = DynamicParameters::new(&self.model, &theta).map_err(wrong_parameters)?;
        Samples::of(inputs.each_ref()).fill(py, ddq.as_slice_mut()?, |inputs, ddq| {
            let found = self.model.forward_dynamics_series(&parameters, inputs, sign)?;
            ddq.copy_from_slice(found.values());
            Ok(())
        })
    }

    /// Fills `masses`, samples by coordinates by coordinates, with the mass matrices.
    fn mass_matrix<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        theta: Vec<f64>,
        mut masses: PyReadwriteArray3<'py, f64>,
    ) -> PyResult<()> {
        let n = self.model.coordinate_count();
        let parameters = DynamicParameters::new(&self.model, &theta).map_err(wrong_parameters)?;
        Samples::of([&q]).fill(py, masses.as_slice_mut()?, |[q], masses| {
            self.model.check_positions(q)?;
            let mut workspace = Workspace::new(&self.model);
            for (k, m) in masses.chunks_exact_mut(n * n).enumerate() {
                self.model.mass_matrix(&parameters, q.sample(k), &mut workspace, m);
            }
            Ok(())
        })
    }

    /// Joint torques from drive signals of the motors.
    fn joint_torques<'py>(
        &self,
        py: Python<'py>,
        drive: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array_of(py, self.robot.transmission.joint_torques(&series_of(drive.as_array())))
    }

    /// Joint positions from positions of the motors.
    fn joint_positions<'py>(
        &self,
        py: Python<'py>,
        motors: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array_of(py, self.robot.transmission.joint_positions(&series_of(motors.as_array())))
    }
}

/// The velocity at which the sign of friction changes: of all joints, or of joints that turn and of joints that slide.
#[derive(FromPyObject)]
pub enum SignScale {
    All(f64),
    ByKind((f64, f64)),
}

/// The sign function of velocities: exact, or smoothed with this velocity.
pub fn sign_of(scale: Option<SignScale>) -> PyResult<Sign> {
    let transition = match scale {
        None => return Ok(Sign::Exact),
        Some(SignScale::All(velocity)) => FrictionTransition::of_all(velocity),
        Some(SignScale::ByKind((turning, sliding))) => FrictionTransition { turning, sliding },
    };
    let FrictionTransition { turning, sliding } = transition;
    match [turning, sliding].into_iter().find(|v| !(v.is_finite() && *v > 0.0)) {
        None => Ok(Sign::Smooth(transition)),
        Some(scale) => {
            Err(PyValueError::new_err(format!("sign_velocity_scale is {scale}; it is a velocity above zero, or None")))
        }
    }
}

fn wrong_parameters(error: DynamicsError) -> PythonError {
    PythonError::new("RobotError", error)
}

/// A vector as it was given.
pub fn vector_of(array: &PyReadonlyArray1<'_, f64>) -> Vec<f64> {
    array.as_array().iter().copied().collect()
}
