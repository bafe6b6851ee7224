//! The regression and its estimators as building blocks.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use thetahat::{
    Method,
    identification::{Assembly, uncertainty},
    regression::{Regression, RowLayout},
    signal::Decimator,
};

use crate::{
    arrays::{matrix_array, matrix_of, rows, series_of},
    python_error::PythonError,
    robot::{Robot, SignScale, sign_of, vector_of},
};

/// The decimated observation matrix of a motion: rows ordered by joint, then by time.
#[pyfunction]
pub fn observation_matrix<'py>(
    py: Python<'py>,
    robot: &Robot,
    motion: [PyReadonlyArray2<'py, f64>; 3],
    decimation: usize,
    columns: Vec<usize>,
    sign_velocity_scale: Option<SignScale>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let [q, dq, ddq] = motion.map(|array| series_of(array.as_array()));
    let sign = sign_of(sign_velocity_scale)?;
    let x = py.detach(|| {
        let decimator = Decimator::new(decimation, q.len())?;
        Assembly::new(robot.model(), &columns, decimator).observation_matrix(&q, &dq, &ddq, sign)
    });
    matrix_array(py, x.map_err(PythonError::from)?)
}

/// The decimated torques in the rows of the observation matrix.
#[pyfunction]
pub fn measurement_vector<'py>(
    py: Python<'py>,
    torque: PyReadonlyArray2<'py, f64>,
    decimation: usize,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let torque = series_of(torque.as_array());
    let decimated = Decimator::new(decimation, torque.len()).and_then(|decimator| decimator.decimate(&torque));
    let decimated = decimated.map_err(PythonError::from)?;
    let y: Vec<f64> = (0..decimated.channels()).flat_map(|joint| decimated.channel(joint)).collect();
    Ok(y.into_pyarray(py))
}

/// An estimate with its statistics.
#[pyclass(frozen, module = "thetahat._thetahat", get_all)]
#[derive(Debug)]
pub struct Fit {
    theta: Py<PyArray1<f64>>,
    covariance: Py<PyArray2<f64>>,
    standard_deviation: Py<PyArray1<f64>>,
    standard_deviation_robust: Py<PyArray1<f64>>,
    interval_95: Py<PyArray2<f64>>,
    prediction: Py<PyArray1<f64>>,
    relative_error_percent: f64,
    condition_number: f64,
}

/// Estimates parameters from the rows of a regression.
#[pyfunction]
pub fn estimate<'py>(
    py: Python<'py>,
    method: &str,
    x: PyReadonlyArray2<'py, f64>,
    y: PyReadonlyArray1<'py, f64>,
    z: Option<PyReadonlyArray2<'py, f64>>,
    joints: usize,
    weights: Option<PyReadonlyArray1<'py, f64>>,
) -> PyResult<Fit> {
    let method: Method = method.parse().map_err(PythonError::from)?;
    let z = z.map(|z| matrix_of(z.as_array()));
    let (x, y, weights) = (matrix_of(x.as_array()), vector_of(&y), weights.as_ref().map(vector_of));
    let found = py.detach(|| {
        let layout = RowLayout::new(joints, &[y.len() / joints]);
        let regression = Regression::new(x, y, layout).with_weights(weights);
        let fit = method.estimate(&regression, z.as_ref(), Default::default())?;
        let uncertainty = uncertainty(method, &regression, z.as_ref(), &fit)?;
        Ok((fit, uncertainty))
    });
    let (fit, uncertainty) = found.map_err(|e: thetahat::identification::EstimationError| PythonError::from(e))?;
    let intervals = uncertainty.interval_95.concat();
    Ok(Fit {
        covariance: matrix_array(py, fit.covariance)?.unbind(),
        interval_95: rows(py, fit.theta.len(), 2, intervals)?.unbind(),
        theta: fit.theta.into_pyarray(py).unbind(),
        standard_deviation: fit.standard_deviation.into_pyarray(py).unbind(),
        standard_deviation_robust: uncertainty.standard_deviation.into_pyarray(py).unbind(),
        prediction: fit.prediction.into_pyarray(py).unbind(),
        relative_error_percent: fit.relative_error_percent,
        condition_number: fit.condition_number,
    })
}
