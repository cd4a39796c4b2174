//! `Closed`: a closed valve, its certificate and its measures.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use coapt::film::{Film, film_watched};
use coapt::measure;
use coapt::relax::{Equilibrium, Status};
use coapt::scene::Fault;
use coapt_io::atomic::write_text_atomically;
use coapt_io::page::{Page, add_film, page_html, page_of_closure};
use coapt_io::picture::{Quantity, check_name, write_closure_picture};
use coapt_io::record::{Filmed, Source, write_recording};
use coapt_io::report::{self, Closure, Report, text, write_results};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyBytes;

use crate::arrays::{out_list, out_points, out_rows};
use crate::built::Built;
use crate::fault::{input_error, outside_error};
use crate::run::{Stop, run};
use crate::stored;
use crate::valve::{Lines, Valve, chords_at};

/// A closed valve.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Closed {
    pub(crate) inner: Arc<Inner>,
    positions_mm: PyOnceLock<Py<PyArray2<f64>>>,
}

/// What work on other threads needs of it.
pub(crate) struct Inner {
    pub(crate) built: Arc<Built>,
    pub(crate) relaxed: Relaxed,
    report: OnceLock<Report>,
}

/// Where a valve came to rest, and how long that took.
#[derive(Clone)]
pub(crate) struct Relaxed {
    pub(crate) equilibrium: Equilibrium,
    /// Wall-clock time [ms].
    pub(crate) wall_ms: f64,
}

impl Inner {
    fn closure(&self) -> Closure {
        closure(self, None)
    }

    /// As reports are made of it.
    fn told(&self) -> report::Closed {
        report::Closed {
            model: self.built.model.clone(),
            equilibrium: self.relaxed.equilibrium.clone(),
            wall_ms: self.relaxed.wall_ms,
        }
    }

    /// Measured when first asked for.
    fn report(&self) -> &Report {
        self.report.get_or_init(|| Report::new(&self.closure()))
    }
}

/// A valve closed, and perhaps closed again after more repairs, as reports are made of it.
fn closure(before: &Inner, after: Option<&Inner>) -> Closure {
    let last = &after.unwrap_or(before).built;
    Closure {
        before: before.told(),
        after: after.map(Inner::told),
        repairs: last.reports.clone(),
        warnings: last.warnings.clone(),
        untangled: last.untangled.clone(),
        chordae_left_out: last.chordae_left_out.clone(),
    }
}

impl Closed {
    pub(crate) fn new(built: Arc<Built>, relaxed: Relaxed) -> Self {
        Self {
            inner: Arc::new(Inner {
                built,
                relaxed,
                report: OnceLock::new(),
            }),
            positions_mm: PyOnceLock::new(),
        }
    }
}

/// Residual, stable, crossings as (edge, edge, face), penetration, its place, mesh error.
type CertificateParts<'py> = (
    f64,
    bool,
    Bound<'py, PyArray2<u32>>,
    f64,
    Option<(f64, f64, f64)>,
    f64,
);

/// Residual, step, damping, fraction, exact, faces.
type IterationParts = (f64, f64, f64, f64, bool, usize);

#[pymethods]
impl Closed {
    /// The valve that was closed.
    #[getter]
    fn valve(&self) -> Valve {
        Valve::from(Arc::clone(&self.inner.built))
    }

    /// Why the solver stopped.
    #[getter]
    fn status(&self) -> &'static str {
        match self.inner.relaxed.equilibrium.status {
            Status::Converged => "converged",
            Status::IterationLimit => "iteration-limit",
            Status::Stalled => "stalled",
            Status::Burst => "burst",
            Status::TangledStart => "tangled-start",
            Status::Interrupted => "interrupted",
        }
    }

    /// Whether the result may be used.
    #[getter]
    fn certified(&self) -> bool {
        let equilibrium = &self.inner.relaxed.equilibrium;
        equilibrium.certificate.is_certified(equilibrium.status)
    }

    /// Wall-clock time of the closure [ms].
    #[getter]
    fn wall_ms(&self) -> f64 {
        self.inner.relaxed.wall_ms
    }

    /// Closed positions of all vertices [mm].
    #[getter]
    fn positions_mm(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        let positions = &self.inner.relaxed.equilibrium.state.positions_mm;
        let make = || Ok::<_, PyErr>(out_points(py, positions)?.unbind());
        Ok(self.positions_mm.get_or_try_init(py, make)?.clone_ref(py))
    }

    /// Force of the valve on its supports [N], zero at free vertices.
    #[getter]
    fn reactions_n<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        out_points(py, &self.inner.relaxed.equilibrium.reactions_n)
    }

    /// The parts of the certificate.
    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<CertificateParts<'py>> {
        let certificate = &self.inner.relaxed.equilibrium.certificate;
        let crossings = certificate.crossings.iter();
        let rows = crossings.flat_map(|crossing| [crossing.edge[0], crossing.edge[1], crossing.face]);
        Ok((
            certificate.residual,
            certificate.stable,
            out_rows(py, rows.collect(), 3)?,
            certificate.max_penetration_mm,
            certificate.max_penetration_at_mm.map(|at| (at.x, at.y, at.z)),
            certificate.discretisation_mm,
        ))
    }

    /// What happened, iteration by iteration.
    fn history(&self) -> Vec<IterationParts> {
        let history = self.inner.relaxed.equilibrium.history.iter();
        history
            .map(|it| {
                (
                    it.residual,
                    it.step_mm,
                    it.damping,
                    it.fraction,
                    it.exact,
                    it.faces,
                )
            })
            .collect()
    }

    /// Of each vertex of the leaflets: gap to the opposite leaflet [mm], whether in contact, mean strain of its edges.
    fn at_points<'py>(&self, py: Python<'py>) -> PyResult<PointArrays<'py>> {
        let inner = Arc::clone(&self.inner);
        let (gap, contact, strain) = run(py, move |_| {
            let model = &inner.built.model;
            let positions = &inner.relaxed.equilibrium.state.positions_mm;
            let count = model.leaflet_vertex_count;
            let mut gap = measure::gap_mm(model, positions);
            let mut contact = measure::in_contact(model, positions);
            let mut strain = measure::vertex_strain(model, positions);
            gap.truncate(count);
            contact.truncate(count);
            strain.truncate(count);
            (gap, contact, strain)
        })?;
        Ok((out_list(py, gap), out_list(py, contact), out_list(py, strain)))
    }

    /// Ends of the chord segments where they now are [mm], and the segments between them.
    fn chords<'py>(&self, py: Python<'py>) -> PyResult<Lines<'py>> {
        chords_at(
            py,
            &self.inner.built,
            &self.inner.relaxed.equilibrium.state.positions_mm,
        )
    }

    /// Tension of each chord segment [N].
    fn chord_forces_n<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let inner = &self.inner;
        let positions = &inner.relaxed.equilibrium.state.positions_mm;
        out_list(py, measure::chord_forces(&inner.built.model, positions))
    }

    /// The report as JSON; with `after`, of a valve before and after more repairs.
    fn report_json(&self, py: Python<'_>, after: Option<&Self>) -> PyResult<String> {
        self.told(py, after, |_, report| report.json())?
            .map_err(|fault| outside_error(&fault))
    }

    /// The report as a table for people.
    fn text(&self, py: Python<'_>, after: Option<&Self>) -> PyResult<String> {
        self.told(py, after, |_, report| text(report))
    }

    /// The rows of that table: title, name, unit, digits, value before, value after.
    fn rows(&self, py: Python<'_>, after: Option<&Self>) -> PyResult<Vec<RowParts>> {
        self.told(py, after, |_, report| {
            let rows = report::rows(report).into_iter();
            let value = |row: &report::TableRow, state: usize| row.values.get(state).copied().flatten();
            rows.map(|row| {
                let (before, after) = (value(&row, 0), value(&row, 1));
                (row.title, row.name, row.unit, row.digits, before, after)
            })
            .collect()
        })
    }

    /// Writes what `coapt closure --out` writes.
    fn write(&self, py: Python<'_>, folder: PathBuf, after: Option<&Self>) -> PyResult<()> {
        let written = self.told(py, after, move |closure, report| {
            write_results(&folder, closure, report)
        })?;
        written.map_err(|fault| outside_error(&fault))
    }

    /// Writes what `coapt closure --record` writes.
    fn record(&self, py: Python<'_>, path: PathBuf, frames: usize, after: Option<&Self>) -> PyResult<()> {
        let before = Arc::clone(&self.inner);
        let after = after.map(|after| Arc::clone(&after.inner));
        let written = run(py, move |stop| {
            recorded(&path, frames, &before, after.as_deref(), stop)
        })?;
        written.map_err(|fault| outside_error(&fault))
    }

    /// Writes what `coapt closure --picture` writes.
    fn picture(&self, py: Python<'_>, path: PathBuf, colour: &str, after: Option<&Self>) -> PyResult<()> {
        let quantity = match colour {
            "gap" => Quantity::Gap,
            "strain" => Quantity::Strain,
            "displacement" => Quantity::Displacement,
            "leaflet" => Quantity::Leaflet,
            _ => {
                let message =
                    format!("colour is '{colour}'; expected 'gap', 'strain', 'displacement' or 'leaflet'");
                return Err(PyValueError::new_err(message));
            }
        };
        check_name("path", &path).map_err(|fault| input_error(py, &[fault]))?;
        let written = self.told(py, after, move |closure, _| {
            write_closure_picture(&path, closure, quantity)
        })?;
        written.map_err(|fault| outside_error(&fault))
    }

    /// Writes what `coapt report` writes of the folder that `write` writes, with a film if one is named.
    fn report(
        &self,
        py: Python<'_>,
        path: PathBuf,
        recording: Option<PathBuf>,
        after: Option<&Self>,
    ) -> PyResult<()> {
        let page = self.told(py, after, move |closure, report| {
            let mut page = page_of_closure(closure, report)?;
            if let Some(recording) = &recording {
                add_film(&mut page, recording)?;
            }
            Ok(page)
        })?;
        write_page(py, path, page)
    }

    /// The closed valve as bytes, with a version.
    fn stored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, stored::closed(&self.inner)?.as_bytes()))
    }

    /// The closed valve of such bytes.
    #[staticmethod]
    fn from_stored(py: Python<'_>, bytes: Vec<u8>) -> PyResult<Self> {
        let read = run(py, move |_| stored::read_closed(&bytes))?;
        let (built, closed) = read.map_err(|faults| input_error(py, &faults))?;
        Ok(Self::new(Arc::new(built), closed))
    }
}

/// Writes a page; nothing where it could not be made.
pub(crate) fn write_page(py: Python<'_>, path: PathBuf, page: Result<Page, Vec<Fault>>) -> PyResult<()> {
    let page = page.map_err(|faults| input_error(py, &faults))?;
    let written = run(py, move |_| {
        write_text_atomically(&path, page_html(&page)?.as_bytes())
    })?;
    written.map_err(|fault| outside_error(&fault))
}

/// Films valves and writes the recording; stopped, it writes nothing.
fn recorded(
    path: &Path,
    frames: usize,
    before: &Inner,
    after: Option<&Inner>,
    stop: &Stop,
) -> Result<(), Fault> {
    let shoot = |inner: &Inner| {
        let closed = &inner.relaxed.equilibrium;
        film_watched(&inner.built.model, closed, frames, |_| stop.flow())
    };
    let (first, second) = rayon::join(|| shoot(before), || after.map(shoot));
    if stop.flow().is_break() {
        return Ok(());
    }
    let standing = &before.built.repairs;
    let source = Source {
        scene: &before.built.scene,
        repairs_before: standing,
        repairs: after
            .and_then(|after| after.built.repairs.get(standing.len()..))
            .unwrap_or_default(),
    };
    let second = after
        .zip(second.as_ref())
        .map(|(after, film)| filmed(after, film));
    write_recording(path, source, filmed(before, &first), second)
}

fn filmed<'a>(inner: &'a Inner, film: &'a Film) -> Filmed<'a> {
    Filmed {
        model: &inner.built.model,
        film,
        repairs: &inner.built.reports,
    }
}

/// Gap, contact, strain.
type PointArrays<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<f64>>,
);

/// Title, name, unit, digits, value before, value after.
type RowParts = (String, String, String, usize, Option<f64>, Option<f64>);

impl Closed {
    /// Tells of this valve, or of it and what became of it.
    fn told<T: Send + 'static>(
        &self,
        py: Python<'_>,
        after: Option<&Self>,
        tell: impl FnOnce(&Closure, &Report) -> T + Send + 'static,
    ) -> PyResult<T> {
        let before = Arc::clone(&self.inner);
        let after = after.map(|after| Arc::clone(&after.inner));
        run(py, move |_| match after {
            None => tell(&before.closure(), before.report()),
            Some(after) => {
                let closure = closure(&before, Some(&after));
                let report = Report::new(&closure);
                tell(&closure, &report)
            }
        })
    }
}
