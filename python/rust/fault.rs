//! Faults of the library as `coapt.InputError`.

use coapt::scene::{Fault, Severity};
use coapt_io::scene::sentence;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

/// Severity, place and message.
pub(crate) type Told = (&'static str, String, String);

/// A fault as Python takes it.
pub(crate) fn told(fault: &Fault) -> Told {
    let severity = match fault.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    (severity, fault.place.clone(), fault.message.clone())
}

/// `coapt.InputError` with these faults.
pub(crate) fn input_error(py: Python<'_>, faults: &[Fault]) -> PyErr {
    let told: Vec<Told> = faults.iter().map(told).collect();
    let made = py
        .import("coapt._errors")
        .and_then(|module| module.getattr("input_error"))
        .and_then(|make| make.call1((told,)));
    match made {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// `coapt.InputError` with one fault.
pub(crate) fn one_error(py: Python<'_>, place: &str, message: impl Into<String>) -> PyErr {
    input_error(py, &[Fault::error(place, message)])
}

/// The file system or the machine stood against it.
pub(crate) fn outside_error(fault: &Fault) -> PyErr {
    PyOSError::new_err(sentence(fault))
}
