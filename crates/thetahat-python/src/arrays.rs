//! Between arrays of NumPy and series of the library. An array has a row for each sample and a column for each channel, in C
//! order, in Fortran order or as a slice of another: it is read in place.

use std::ops::Range;

use numpy::{
    PyArray2, PyReadonlyArray2,
    ndarray::{Array2, ArrayView2, Axis, ShapeBuilder, Slice},
};
use pyo3::prelude::*;
use thetahat::{Matrix, Series, dynamics::DynamicsError};

use crate::python_error::PythonError;

/// Samples of a piece: its inputs fit in the cache, and signals are checked many times a second.
const PIECE: usize = 8192;

/// A copy of an array, or of a part of it.
pub fn series_of(array: ArrayView2<'_, f64>) -> Series {
    Series::shaped(array.ncols(), array.iter().copied().collect())
}

/// A series as an array, without a copy.
pub fn array_of(py: Python<'_>, series: Series) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let (samples, channels) = (series.len(), series.channels());
    rows(py, samples, channels, series.into_values())
}

/// Values row by row as an array, without a copy.
pub fn rows(py: Python<'_>, rows: usize, columns: usize, values: Vec<f64>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let array = Array2::from_shape_vec((rows, columns), values).map_err(shape_error)?;
    Ok(PyArray2::from_owned_array(py, array))
}

/// A matrix as an array in Fortran order, without a copy.
pub fn matrix_array(py: Python<'_>, matrix: Matrix) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let shape = (matrix.rows(), matrix.columns());
    let array = Array2::from_shape_vec(shape.f(), matrix.into_values()).map_err(shape_error)?;
    Ok(PyArray2::from_owned_array(py, array))
}

/// A copy of an array as a matrix.
pub fn matrix_of(array: ArrayView2<'_, f64>) -> Matrix {
    Matrix::from_fn(array.nrows(), array.ncols(), |i, j| array[[i, j]])
}

fn shape_error(error: numpy::ndarray::ShapeError) -> PyErr {
    pyo3::exceptions::PyValueError::new_err(error.to_string())
}

/// The sample at which there is no value, and why.
type Failed = (usize, DynamicsError);

/// Arrays with the same samples and channels, processed in pieces.
pub struct Samples<'a, const N: usize> {
    arrays: [ArrayView2<'a, f64>; N],
}

impl<'a, const N: usize> Samples<'a, N> {
    /// The samples of arrays whose shapes the package has compared.
    pub fn of(arrays: [&'a PyReadonlyArray2<'_, f64>; N]) -> Self {
        Self { arrays: arrays.map(|array| array.as_array()) }
    }

    pub fn len(&self) -> usize {
        self.arrays[0].nrows()
    }

    /// Fills `out`, an array in C order with as many values for each sample, piece by piece: without the interpreter's lock,
    /// which is acquired between pieces to check signals.
    ///
    /// The package allocates these arrays: NumPy allocates large pages, which is fast.
    pub fn fill(
        &self,
        py: Python<'_>,
        out: &mut [f64],
        work: impl Fn([&Series; N], &mut [f64]) -> Result<(), Failed> + Sync,
    ) -> PyResult<()> {
        let size = out.len() / self.len().max(1);
        for (number, part) in out.chunks_mut((PIECE * size).max(1)).enumerate() {
            let start = number * PIECE;
            let range = start..self.len().min(start + PIECE);
            let done = py.detach(|| self.fill_piece(range, size, part, &work));
            done.map_err(|(k, error)| PythonError::from((start + k, error)))?;
            py.check_signals()?;
        }
        Ok(())
    }

    fn fill_piece(
        &self,
        range: Range<usize>,
        size: usize,
        out: &mut [f64],
        work: &impl Fn([&Series; N], &mut [f64]) -> Result<(), Failed>,
    ) -> Result<(), Failed> {
        for (number, out) in out.chunks_mut((CACHED * size).max(1)).enumerate() {
            let start = range.start + number * CACHED;
            let end = range.end.min(start + CACHED);
            let copies =
                self.arrays.each_ref().map(|array| series_of(array.slice_axis(Axis(0), Slice::from(start..end))));
            work(copies.each_ref(), out).map_err(|(k, e)| (number * CACHED + k, e))?;
        }
        Ok(())
    }
}

/// Samples copied at a time: some ten kilobytes.
const CACHED: usize = 256;
