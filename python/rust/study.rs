//! `study`: one valve at many mesh sizes and settings, error against time.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use coapt::model::Model;
use coapt::relax::relax_watched;
use coapt::scene::Fault;
use coapt::state::State;
use coapt_io::study::{Tried, carry_out, csv, svg, text, write_study};
use pyo3::prelude::*;

use crate::fault::outside_error;
use crate::run::run;
use crate::stored;
use crate::valve::Valve;

/// A study.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Study {
    inner: Arc<coapt_io::study::Study>,
}

/// Closes valves at many settings; none where the reference does not close to a certified state.
#[pyfunction]
pub(crate) fn study(
    py: Python<'_>,
    valves: Vec<Bound<'_, Valve>>,
    reference: Bound<'_, Valve>,
    tolerances: Option<Vec<f64>>,
    thicknesses_mm: Option<Vec<f64>>,
    repeats: Option<u16>,
) -> PyResult<Option<Study>> {
    let usual = Tried::default();
    let tried = Tried {
        tolerances: tolerances.unwrap_or(usual.tolerances),
        thicknesses_mm: thicknesses_mm.unwrap_or(usual.thicknesses_mm),
        repeats: repeats.unwrap_or(usual.repeats),
    };
    let models: Vec<Model> = valves
        .iter()
        .map(|valve| valve.get().built.model.clone())
        .collect();
    let finest = Arc::clone(&reference.get().built);
    let done = run(py, move |stop| {
        let close = |_: &str, model: &Model| {
            let begun = Instant::now();
            let closed = relax_watched(model, &State::open(model), |_| stop.flow());
            (closed, begun.elapsed().as_secs_f64() * 1e3)
        };
        carry_out(&models, &finest.model, &tried, &close, &|_| {})
    })?;
    Ok(done.map(|inner| Study {
        inner: Arc::new(inner),
    }))
}

#[pymethods]
impl Study {
    /// A line per closure, as comma-separated values.
    fn csv(&self) -> String {
        csv(&self.inner)
    }

    /// The study as JSON.
    fn report_json(&self) -> PyResult<String> {
        stored::json(&*self.inner)
    }

    /// The study as a table for people.
    fn text(&self) -> String {
        text(&self.inner)
    }

    /// Error against time, as a picture.
    fn svg(&self) -> String {
        svg(&self.inner)
    }

    /// Writes what `coapt study --out` writes.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let inner = Arc::clone(&self.inner);
        let written = run(py, move |_| -> Result<(), Fault> {
            coapt_io::atomic::make_folder(&folder)?;
            write_study(&folder, &inner)
        })?;
        written.map_err(|fault| outside_error(&fault))
    }
}
