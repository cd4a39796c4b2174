//! `study`: one valve at many mesh sizes and settings, error against time; or under every tissue law.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use coapt::model::Model;
use coapt::relax::relax_watched;
use coapt::scene::{Fault, Scene};
use coapt::state::State;
use coapt_io::study::{
    FACES, FACES_OF_LAWS, LawStudy, Laws, MeshOfLaws, REFERENCE, Sizes, Tried, carry_out, carry_out_laws,
    closure_count, csv, csv_of_laws, expect_no_sizes, svg, text, text_of_laws, write_laws, write_study,
};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::built::Built;
use crate::fault::{input_error, outside_error};
use crate::progress::Count;
use crate::run::{Stop, run, run_told};
use crate::stored;
use crate::stored_results;
use crate::valve::Valve;

/// A study.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Study {
    inner: Arc<coapt_io::study::Study>,
}

/// A study of tissue laws.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct StudyOfLaws {
    inner: Arc<LawStudy>,
}

/// Mesh sizes of a preset to be studied, in triangles, and that of the reference.
#[pyfunction]
pub(crate) fn study_sizes(
    py: Python<'_>,
    faces: Option<Vec<i64>>,
    reference_faces: Option<i64>,
    laws: bool,
) -> PyResult<(Vec<u32>, u32)> {
    let usual: &[u32] = if laws { &FACES_OF_LAWS } else { &FACES };
    let sizes = Sizes::asked(faces.as_deref(), reference_faces, usual);
    let sizes = sizes.map_err(|faults| input_error(py, &faults))?;
    Ok((sizes.faces, sizes.reference_faces))
}

/// Refuses mesh sizes of valves that are not generated.
#[pyfunction]
pub(crate) fn study_no_sizes(
    py: Python<'_>,
    faces: Option<Vec<i64>>,
    reference_faces: Option<i64>,
) -> PyResult<()> {
    expect_no_sizes(faces.as_deref(), reference_faces).map_err(|faults| input_error(py, &faults))
}

/// Closes valves at many settings; none where the reference does not close to a certified state.
#[pyfunction]
pub(crate) fn study(
    py: Python<'_>,
    valves: Vec<Bound<'_, Valve>>,
    reference: Bound<'_, Valve>,
    tolerances: Option<Vec<f64>>,
    thicknesses_mm: Option<Vec<f64>>,
    repeats: Option<i64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Option<Study>> {
    let tried = Tried::asked(tolerances, thicknesses_mm, repeats);
    let tried = tried.map_err(|faults| input_error(py, &faults))?;
    let models: Vec<Model> = valves
        .iter()
        .map(|valve| valve.get().built.model.clone())
        .collect();
    let finest = Arc::clone(&reference.get().built);
    let done = run_told(py, progress, move |stop, count| {
        count.begin(closure_count(&models, &tried));
        let close = timed(stop, count);
        carry_out(&models, &finest.model, &tried, &close, &|_| {})
    })?;
    Ok(done.map(|inner| Study {
        inner: Arc::new(inner),
    }))
}

/// Closes valves under every law, against the reference if there is one.
#[pyfunction]
pub(crate) fn study_laws(
    py: Python<'_>,
    valves: Vec<Bound<'_, Valve>>,
    reference: Option<Bound<'_, Valve>>,
    repeats: Option<i64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<StudyOfLaws> {
    let meshes: Vec<Arc<Built>> = valves
        .iter()
        .map(|valve| Arc::clone(&valve.get().built))
        .collect();
    let finest = reference.map(|reference| Arc::clone(&reference.get().built));
    let repeats = coapt_io::study::repeats(repeats).map_err(|fault| input_error(py, &[fault]))?;
    let done = run_told(py, progress, move |stop, count| {
        let laws = Laws::new()?;
        count.begin(laws.count() * meshes.len() * usize::from(repeats));
        let build = |built: &Arc<Built>| {
            let built = Arc::clone(built);
            move |scene: Scene| -> Result<Model, Vec<Fault>> { Ok(built.of(scene)?.model) }
        };
        let builds: Vec<_> = meshes.iter().chain(&finest).map(build).collect();
        let each = meshes.iter().chain(&finest).zip(&builds);
        let all: Vec<MeshOfLaws> = each
            .map(|(built, build)| MeshOfLaws {
                scene: &built.scene,
                build,
            })
            .collect();
        let (meshes, finest) = all.split_at(meshes.len());
        carry_out_laws(
            meshes,
            finest.first(),
            &laws,
            repeats,
            &timed(stop, count),
            &|_| {},
        )
    })?;
    let inner = done.map_err(|faults| input_error(py, &faults))?;
    Ok(StudyOfLaws {
        inner: Arc::new(inner),
    })
}

/// Closes a valve, takes the time [ms] and counts it, unless it is the reference.
fn timed(stop: &Stop, count: &Count) -> impl Fn(&str, &Model) -> (coapt::relax::Equilibrium, f64) {
    move |what, model| {
        let begun = Instant::now();
        let closed = relax_watched(model, &State::open(model), |_| stop.flow());
        let wall_ms = begun.elapsed().as_secs_f64() * 1e3;
        if what != REFERENCE {
            count.step();
        }
        (closed, wall_ms)
    }
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

    /// The study as bytes, with a version.
    fn stored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &stored_results::study(&self.inner)?))
    }

    /// The study of such bytes.
    #[staticmethod]
    fn from_stored(py: Python<'_>, bytes: Vec<u8>) -> PyResult<Self> {
        let read = stored_results::read_study(&bytes).map_err(|faults| input_error(py, &faults))?;
        Ok(Self {
            inner: Arc::new(read),
        })
    }
}

#[pymethods]
impl StudyOfLaws {
    /// A line per closure, as comma-separated values.
    fn csv(&self) -> String {
        csv_of_laws(&self.inner)
    }

    /// The study as JSON.
    fn report_json(&self) -> PyResult<String> {
        stored::json(&*self.inner)
    }

    /// The study as a table for people.
    fn text(&self) -> String {
        text_of_laws(&self.inner)
    }

    /// Writes what `coapt study --laws --out` writes.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let inner = Arc::clone(&self.inner);
        let written = run(py, move |_| -> Result<(), Fault> {
            coapt_io::atomic::make_folder(&folder)?;
            write_laws(&folder, &inner)
        })?;
        written.map_err(|fault| outside_error(&fault))
    }

    /// The study as bytes, with a version.
    fn stored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &stored_results::study_of_laws(&self.inner)?))
    }

    /// The study of such bytes.
    #[staticmethod]
    fn from_stored(py: Python<'_>, bytes: Vec<u8>) -> PyResult<Self> {
        let read = stored_results::read_study_of_laws(&bytes).map_err(|faults| input_error(py, &faults))?;
        Ok(Self {
            inner: Arc::new(read),
        })
    }
}
