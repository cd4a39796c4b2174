//! Python's dictionaries as the tables that scenes and plans are read from.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use toml::{Table, Value};

use crate::fault::one_error;

/// A dictionary as a table; `None` is as good as absent. `place` is what messages call it.
///
/// # Errors
/// A key that is no text, or a value that no file could hold.
pub(crate) fn table(place: &str, dict: &Bound<'_, PyDict>) -> PyResult<Table> {
    let mut made = Table::new();
    for (key, value) in dict {
        let Ok(key) = key.extract::<String>() else {
            let message = format!("has the key {}; expected text", key.repr()?);
            return Err(one_error(dict.py(), place, message));
        };
        if !value.is_none() {
            let inside = value_of(&format!("{place}.{key}"), &value)?;
            made.insert(key, inside);
        }
    }
    Ok(made)
}

/// Any value.
///
/// # Errors
/// As of [`table`].
pub(crate) fn value_of(place: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_string()));
    }
    if let Ok(number) = value.cast::<PyFloat>() {
        return Ok(Value::Float(number.extract()?));
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        return Ok(Value::Table(table(place, dict)?));
    }
    if value.cast::<PyList>().is_ok() || value.cast::<PyTuple>().is_ok() {
        let items = value.try_iter()?.enumerate();
        let made = items.map(|(number, item)| value_of(&format!("{place}[{number}]"), &item?));
        return Ok(Value::Array(made.collect::<PyResult<_>>()?));
    }
    // Numbers of NumPy are none of Python's.
    if let Ok(whole) = value.extract::<i64>() {
        return Ok(Value::Integer(whole));
    }
    if value.cast::<PyInt>().is_err()
        && value.hasattr("__float__")?
        && let Ok(number) = value.extract::<f64>()
    {
        return Ok(Value::Float(number));
    }
    let message = format!(
        "is {}; expected a number, text, a list or a dictionary",
        short(value)?
    );
    Err(one_error(value.py(), place, message))
}

/// What something is, in a few letters.
fn short(value: &Bound<'_, PyAny>) -> PyResult<String> {
    let told = value.repr()?.to_string();
    let kind = value.get_type().name()?;
    Ok(match told.chars().count() {
        0..=40 => told,
        _ => format!("of type {kind}"),
    })
}
