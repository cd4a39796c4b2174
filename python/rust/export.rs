//! `export`: a valve as input of another engine, and that engine's result as a surface.

use std::path::PathBuf;
use std::sync::Arc;

use coapt::scene::Fault;
use coapt_io::export::{calculix, febio, read_positions, write_export};
use coapt_io::report::write_closed_surface;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::fault::{Told, input_error, outside_error, told};
use crate::run::run;
use crate::valve::Valve;

/// Writes a valve as input of an engine.
#[pyfunction]
pub(crate) fn export_model(
    py: Python<'_>,
    valve: &Bound<'_, Valve>,
    out: PathBuf,
    format: &str,
) -> PyResult<()> {
    let write = match format {
        "calculix" => calculix,
        "febio" => febio,
        _ => {
            let message = format!("format is '{format}'; expected 'calculix' or 'febio'");
            return Err(PyValueError::new_err(message));
        }
    };
    let built = Arc::clone(&valve.get().built);
    let text = run(py, move |_| {
        let located =
            |faults: Vec<Fault>| -> Vec<Fault> { faults.iter().map(|fault| built.located(fault)).collect() };
        write(&built.model).map_err(located)
    })?;
    let text = text.map_err(|faults| input_error(py, &faults))?;
    let written = run(py, move |_| write_export(&out, &text))?;
    written.map_err(|fault| outside_error(&fault))
}

/// Writes the closed leaflets as a result of an engine places them; doubts are returned.
#[pyfunction]
pub(crate) fn export_results(
    py: Python<'_>,
    valve: &Bound<'_, Valve>,
    out: PathBuf,
    results: PathBuf,
) -> PyResult<Vec<Told>> {
    let built = Arc::clone(&valve.get().built);
    let read = run(py, move |_| {
        let (positions, warnings) = read_positions(&results, &built.model)?;
        Ok((write_closed_surface(&out, &built.model, &positions), warnings))
    })?;
    let (written, warnings) = read.map_err(|faults: Vec<_>| input_error(py, &faults))?;
    written.map_err(|fault| outside_error(&fault))?;
    Ok(warnings.iter().map(told).collect())
}
