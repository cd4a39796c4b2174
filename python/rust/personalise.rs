//! `personalise`: chord lengths fitted to a closed surface.

use std::sync::Arc;
use std::time::Instant;

use coapt::personalise::{FitSettings, Progress, Target, fit_chord_lengths_watched};
use coapt::scene::{Fault, Scene};
use coapt_io::mesh::read_mesh;
use coapt_io::personalise::{FitReport, fitted_scene, target_of};
use coapt_io::report;
use coapt_io::scene::sentence;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::built::Built;
use crate::closed::{Closed, Relaxed};
use crate::compare::{Source, source};
use crate::fault::{input_error, one_error};
use crate::progress::Count;
use crate::run::{Stop, run, run_told};
use crate::stored_results;
use crate::valve::{Valve, closed_of};

/// Chordae fitted to a target.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Fit {
    pub(crate) report: FitReport,
    /// The valve as given, closed.
    pub(crate) untuned: Option<Closure>,
    /// The valve with the fitted lengths, closed; nothing without a result.
    pub(crate) tuned: Option<Closure>,
}

/// A valve and its closed state, made as everybody makes it: what the fit found, but for the rounding of lengths.
pub(crate) type Closure = (Arc<Built>, Relaxed);

/// Fits the lengths of the chordae so that the valve closes to a surface.
#[pyfunction]
pub(crate) fn personalise(
    py: Python<'_>,
    valve: &Bound<'_, Valve>,
    closed_surface: &Bound<'_, PyAny>,
    per_group: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Fit> {
    let given = Arc::clone(&valve.get().built);
    if !given.repairs.is_empty() {
        let message = format!(
            "has {} repair(s); expected the patient's valve before any, whose chordae are fitted",
            given.repairs.len()
        );
        return Err(one_error(py, "valve", message));
    }
    let (name, target, warnings) = target(py, closed_surface)?;
    let settings = FitSettings {
        per_group,
        ..FitSettings::default()
    };
    let of_target = name.clone();
    let done = run_told(py, progress, move |stop, count| {
        fitted(given, &target, &settings, &of_target, (stop, count))
    })?;
    let mut fit = done.map_err(|faults| input_error(py, &faults))?;
    fit.report.warnings.extend(warnings.iter().map(sentence));
    Ok(fit)
}

fn fitted(
    given: Arc<Built>,
    target: &Target,
    settings: &FitSettings,
    name: &str,
    (stop, count): (&Stop, &Count),
) -> Result<Fit, Vec<Fault>> {
    let begun = Instant::now();
    let look = |progress: &Progress| {
        match progress {
            Progress::Begun(more) => count.more(*more),
            Progress::Closed => count.step(),
            Progress::Iterated(_) => {}
        }
        stop.flow()
    };
    let fit = fit_chord_lengths_watched(&given.model, target, settings, &look);
    let fit = fit.map_err(|faults| -> Vec<Fault> {
        let named = |fault: Fault| match fault.place.strip_prefix("target") {
            Some(rest) => Fault {
                place: format!("{name}{rest}"),
                ..fault
            },
            None => fault,
        };
        faults.into_iter().map(named).collect()
    })?;
    let wall_ms = begun.elapsed().as_secs_f64() * 1e3;
    let tuned = match &fit.tuned {
        Some(_) => Some(given.of(fitted_scene(Scene::clone(&given.scene), &fit))?),
        None => None,
    };
    // Once more, as everybody closes them.
    count.more(usize::from(fit.untuned.is_some()) + usize::from(tuned.is_some()));
    let close = |built: Arc<Built>| {
        let closed = closed_of(&built, None, stop);
        count.step();
        (built, closed)
    };
    let untuned = fit.untuned.as_ref().map(|_| close(Arc::clone(&given)));
    let tuned = tuned.map(|built| close(Arc::new(built)));
    let warnings = given.warnings.iter().map(sentence).collect();
    Ok(Fit {
        report: FitReport::new(
            &given.model.name,
            name,
            settings.per_group,
            &fit,
            wall_ms,
            warnings,
        ),
        untuned,
        tuned,
    })
}

/// What it is called, its points, and doubts.
fn target(py: Python<'_>, given: &Bound<'_, PyAny>) -> PyResult<(String, Target, Vec<Fault>)> {
    let place = "closed_surface";
    let (name, mesh, warnings) = match source(place, given)? {
        Source::Closed(inner) => {
            let positions_mm = &inner.relaxed.equilibrium.state.positions_mm;
            let mesh = report::closed_surface(&inner.built.model, positions_mm);
            (place.to_owned(), mesh, Vec::new())
        }
        Source::Arrays(mesh) => (place.to_owned(), mesh, Vec::new()),
        Source::File(path) => {
            let name = path.display().to_string();
            let read = run(py, move |_| read_mesh(&path))?;
            let (mesh, mut warnings) = read.map_err(|faults| input_error(py, &faults))?;
            if mesh.space.is_none() {
                warnings.push(Fault::warning(name.clone(), "no SPACE mark: taken as LPS"));
            }
            (name, mesh, warnings)
        }
    };
    let target = target_of(&name, &mesh).map_err(|fault| input_error(py, &[fault]))?;
    Ok((name, target, warnings))
}

#[pymethods]
impl Fit {
    /// The fit as `personalise.json` holds it.
    fn report_json(&self) -> String {
        self.report.json()
    }

    /// The fit as a table for people.
    fn text(&self) -> String {
        self.report.text()
    }

    /// Whether there is a result, with every factor within its range, of a certified closure.
    #[getter]
    fn certified(&self) -> bool {
        self.report.certified()
    }

    /// The valve with the fitted lengths.
    #[getter]
    fn valve(&self) -> Option<Valve> {
        let (built, _) = self.tuned.as_ref()?;
        Some(Valve::from(Arc::clone(built)))
    }

    /// The valve as given, closed.
    #[getter]
    fn untuned(&self) -> Option<Closed> {
        self.untuned.as_ref().map(closed)
    }

    /// The valve with the fitted lengths, closed.
    #[getter]
    fn tuned(&self) -> Option<Closed> {
        self.tuned.as_ref().map(closed)
    }

    /// The fit as bytes, with a version.
    fn stored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &stored_results::fit(self)?))
    }

    /// The fit of such bytes.
    #[staticmethod]
    fn from_stored(py: Python<'_>, bytes: Vec<u8>) -> PyResult<Self> {
        let read = run(py, move |_| stored_results::read_fit(&bytes))?;
        read.map_err(|faults| input_error(py, &faults))
    }
}

fn closed((built, relaxed): &Closure) -> Closed {
    Closed::new(Arc::clone(built), relaxed.clone())
}
