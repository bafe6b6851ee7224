//! Filters, differences and decimation of arrays.

use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use thetahat::signal::{Decimator, Derivative, Padding, SecondOrderSections};
use thetahat_estimation::signal;

use crate::{
    arrays::{array_of, series_of},
    python_error::PythonError,
    values,
};

/// Positions, velocities and accelerations after the band-pass.
#[pyfunction]
pub fn band_pass<'py>(
    py: Python<'py>,
    position: PyReadonlyArray2<'py, f64>,
    sample_rate_hz: f64,
    cutoff_hz: f64,
    order: usize,
    derivative: &Bound<'py, PyAny>,
) -> PyResult<[Bound<'py, PyArray2<f64>>; 3]> {
    let (position, derivative) = (series_of(position.as_array()), values::read::<Derivative>(derivative)?);
    let motion = py
        .detach(|| signal::band_pass(&position, sample_rate_hz, order, cutoff_hz, derivative))
        .map_err(PythonError::from)?;
    Ok([array_of(py, motion.q)?, array_of(py, motion.dq)?, array_of(py, motion.ddq)?])
}

/// A Butterworth low-pass forward and backward.
#[pyfunction]
pub fn zero_phase<'py>(
    py: Python<'py>,
    array: PyReadonlyArray2<'py, f64>,
    sample_rate_hz: f64,
    cutoff_hz: f64,
    order: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let series = series_of(array.as_array());
    let filtered = py.detach(|| {
        let filter = SecondOrderSections::butterworth_lowpass(order, cutoff_hz, sample_rate_hz)?;
        signal::zero_phase(&filter, &series, Padding::Matlab)
    });
    array_of(py, filtered.map_err(PythonError::from)?)
}

/// The time derivative.
#[pyfunction]
pub fn derivative<'py>(
    py: Python<'py>,
    array: PyReadonlyArray2<'py, f64>,
    sample_rate_hz: f64,
    kind: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (series, kind) = (series_of(array.as_array()), values::read::<Derivative>(kind)?);
    array_of(py, py.detach(|| kind.of(&series, sample_rate_hz)))
}

/// The parallel filter and every `factor`-th sample.
#[pyfunction]
pub fn decimate<'py>(
    py: Python<'py>,
    array: PyReadonlyArray2<'py, f64>,
    factor: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let series = series_of(array.as_array());
    let decimated = py.detach(|| Decimator::new(factor, series.len())?.decimate(&series));
    array_of(py, decimated.map_err(PythonError::from)?)
}
