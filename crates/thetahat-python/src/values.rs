//! Settings from Python: dictionaries with the keys of an experiment file.

use pyo3::{
    exceptions::PyTypeError,
    prelude::*,
    types::{PyBool, PyDict, PyString},
};
use serde::de::DeserializeOwned;
use thetahat_ground::syntax::in_plain_words;

use crate::python_error::PythonError;

/// A value of the library from a dictionary; None leaves a key out.
///
/// # Errors
/// `SettingsError` for what is no such value, `TypeError` for what no file could hold.
pub fn read<T: DeserializeOwned>(value: &Bound<'_, PyAny>) -> PyResult<T> {
    T::deserialize(toml_of(value)?)
        .map_err(|e| PythonError::new("SettingsError", in_plain_words(&e.to_string())).into())
}

fn toml_of(value: &Bound<'_, PyAny>) -> PyResult<toml::Value> {
    if let Ok(table) = value.cast::<PyDict>() {
        return table_of(table).map(toml::Value::Table);
    }
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(toml::Value::Boolean(flag.is_true()));
    }
    if value.is_instance_of::<PyString>() {
        return Ok(toml::Value::String(value.extract()?));
    }
    if let Ok(number) = value.extract::<i64>() {
        return Ok(toml::Value::Integer(number));
    }
    if let Ok(number) = value.extract::<f64>() {
        return Ok(toml::Value::Float(number));
    }
    let refuse = |_| {
        let kind = value.get_type().name().map_or_else(|_| String::new(), |name| name.to_string());
        PyTypeError::new_err(format!("settings hold numbers, text, lists and dictionaries, and not {kind}"))
    };
    let items = value.try_iter().map_err(refuse)?;
    items.map(|item| toml_of(&item?)).collect::<PyResult<Vec<_>>>().map(toml::Value::Array)
}

fn table_of(table: &Bound<'_, PyDict>) -> PyResult<toml::Table> {
    let given = table.iter().filter(|(_, value)| !value.is_none());
    given.map(|(key, value)| Ok((key.extract()?, toml_of(&value)?))).collect()
}
