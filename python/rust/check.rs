//! `check`: what is wrong with a valve, or doubted, without closing it.

use std::path::PathBuf;

use coapt_io::check::{BuiltValve, CheckReport};
use pyo3::prelude::*;

use crate::built;
use crate::run::run;
use crate::valve::Valve;

/// The report as JSON, and as text for people.
type Told = (String, String);

/// Checks a scene file, or a folder with one.
#[pyfunction]
pub(crate) fn check_file(py: Python<'_>, path: PathBuf, face_limit: Option<u32>) -> PyResult<Told> {
    run(py, move |_| {
        let scene = path.display().to_string();
        let (valve, faults) = match built::read(&path, face_limit) {
            Ok(built) => (Some(BuiltValve::from(&built.model)), built.warnings),
            Err(faults) => (None, faults),
        };
        told(&CheckReport { scene, faults, valve })
    })
}

/// Tells what was found of a valve that is built.
#[pyfunction]
pub(crate) fn check_valve(py: Python<'_>, valve: &Bound<'_, Valve>) -> PyResult<Told> {
    let built = std::sync::Arc::clone(&valve.get().built);
    run(py, move |_| {
        told(&CheckReport {
            scene: built.model.name.clone(),
            faults: built.warnings.clone(),
            valve: Some(BuiltValve::from(&built.model)),
        })
    })
}

fn told(report: &CheckReport) -> Told {
    (report.json(), report.text())
}
