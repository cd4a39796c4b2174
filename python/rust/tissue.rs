//! `fit_tissue`: springs that follow a biaxial table.

use std::path::PathBuf;

use pyo3::prelude::*;

use crate::fault::input_error;
use crate::run::run;
use crate::stored;

/// The fit as JSON, as the block of a scene, and its tissue as JSON.
#[pyfunction]
pub(crate) fn fit_tissue(
    py: Python<'_>,
    curve: PathBuf,
    anisotropic: bool,
    up_to_kpa: f64,
    thickness_mm: Option<f64>,
) -> PyResult<(String, String, String)> {
    let fit = run(py, move |_| {
        coapt_io::tissue::fit_tissue(&curve, anisotropic, up_to_kpa, thickness_mm)
    })?;
    let fit = fit.map_err(|faults| input_error(py, &faults))?;
    Ok((fit.json(), fit.text(), stored::json(&fit.tissue())?))
}
