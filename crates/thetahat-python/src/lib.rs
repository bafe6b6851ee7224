//! thetahat for Python.
use pyo3::prelude::*;
/// The compiled part.
#[pymodule]
mod _thetahat {}
