//! `compare`: how far apart two surfaces lie.

use std::path::PathBuf;
use std::sync::Arc;

use coapt::Vec3;
use coapt::measure::compare::CompareSettings;
use coapt::scene::{Fault, Settings};
use coapt_io::compare::{ComparisonReport, ReadSurface, read_surface, text, write_comparison};
use coapt_io::mesh::PolyData;
use coapt_io::report::closed_surface;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{index_rows, out_list, points};
use crate::closed::{Closed, Inner};
use crate::fault::{input_error, outside_error};
use crate::run::run;
use crate::stored_results;

/// Two surfaces compared.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Comparison {
    /// The mesh of the result, and what is told.
    inner: Arc<(PolyData, ComparisonReport)>,
}

/// The point array that tells contact, as `coapt closure` writes it.
const CONTACT: &str = "contact";

/// A surface as it is given.
#[derive(FromPyObject)]
enum Given<'py> {
    Closed(Bound<'py, Closed>),
    Arrays(Bound<'py, PyAny>, Bound<'py, PyAny>),
    File(PathBuf),
}

/// The same without Python.
pub(crate) enum Source {
    Closed(Arc<Inner>),
    Arrays(PolyData),
    File(PathBuf),
}

/// Compares a result with a reference.
#[pyfunction]
pub(crate) fn compare(
    py: Python<'_>,
    result: &Bound<'_, PyAny>,
    reference: &Bound<'_, PyAny>,
    atrial_direction: Option<[f64; 3]>,
    thickness_mm: Option<f64>,
) -> PyResult<Comparison> {
    let (result, reference) = (source("result", result)?, source("reference", reference)?);
    let settings = CompareSettings {
        atrial_direction: atrial_direction.map(Vec3::from),
        contact_thickness_mm: thickness_mm.unwrap_or(CompareSettings::default().contact_thickness_mm),
    };
    let made = run(py, move |_| compared(result, reference, &settings))?;
    let inner = Arc::new(made.map_err(|faults| input_error(py, &faults))?);
    Ok(Comparison { inner })
}

/// A surface as it is given, called by a name where it is wrong.
///
/// # Errors
/// What is no surface, naming what was found.
pub(crate) fn source(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Source> {
    Ok(match given.extract::<Given<'_>>()? {
        Given::Closed(closed) => Source::Closed(Arc::clone(&closed.get().inner)),
        Given::Arrays(points_mm, triangles) => Source::Arrays(PolyData {
            points: points(&format!("{name}[0]"), &points_mm)?,
            triangles: index_rows(&format!("{name}[1]"), &triangles)?,
            ..PolyData::default()
        }),
        Given::File(path) => Source::File(path),
    })
}

fn compared(
    result: Source,
    reference: Source,
    settings: &CompareSettings,
) -> Result<(PolyData, ComparisonReport), Vec<Fault>> {
    // Both before any of them is refused: two wrong ones are told at once.
    let (result, reference) = (surface("result", result), surface("reference", reference));
    let ((result, mut warnings), (reference, more)) = match (result, reference) {
        (Ok(result), Ok(reference)) => (result, reference),
        (result, reference) => {
            let faults = result.err().into_iter().chain(reference.err());
            return Err(faults.flatten().collect());
        }
    };
    warnings.extend(more);
    let report = ComparisonReport::new(&result, &reference, settings, CONTACT, warnings)?;
    Ok((result.mesh, report))
}

fn surface(name: &str, source: Source) -> Result<(ReadSurface, Vec<Fault>), Vec<Fault>> {
    match source {
        Source::File(path) => read_surface(&path, CONTACT, Settings::default().face_limit),
        Source::Arrays(mesh) => Ok((ReadSurface::new(name, mesh, CONTACT)?, Vec::new())),
        Source::Closed(inner) => {
            let positions_mm = &inner.relaxed.equilibrium.state.positions_mm;
            let mesh = closed_surface(&inner.built.model, positions_mm);
            Ok((ReadSurface::new(name, mesh, CONTACT)?, Vec::new()))
        }
    }
}

#[pymethods]
impl Comparison {
    /// The report as JSON.
    fn report_json(&self) -> PyResult<String> {
        self.inner.1.json().map_err(|fault| outside_error(&fault))
    }

    /// The report as a table for people.
    fn text(&self) -> String {
        text(&self.inner.1)
    }

    /// Distance of each point of the result to the reference [mm], as given and aligned.
    fn distances<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
        let map = &self.inner.1.comparison.map;
        (
            out_list(py, map.distance_mm.clone()),
            out_list(py, map.aligned_distance_mm.clone()),
        )
    }

    /// Writes what `coapt compare --out` writes.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let inner = Arc::clone(&self.inner);
        let written = run(py, move |_| write_comparison(&folder, &inner.0, &inner.1))?;
        written.map_err(|fault| outside_error(&fault))
    }

    /// The comparison as bytes, with a version.
    fn stored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let (mesh, report) = &*self.inner;
        Ok(PyBytes::new(py, &stored_results::comparison(mesh, report)?))
    }

    /// The comparison of such bytes.
    #[staticmethod]
    fn from_stored(py: Python<'_>, bytes: Vec<u8>) -> PyResult<Self> {
        let read = run(py, move |_| stored_results::read_comparison(&bytes))?;
        let read = read.map_err(|faults| input_error(py, &faults))?;
        Ok(Self {
            inner: Arc::new(read),
        })
    }
}
