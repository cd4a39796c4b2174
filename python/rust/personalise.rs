//! `personalise`: chord lengths fitted to a closed surface.

use std::sync::Arc;
use std::time::Instant;

use coapt::personalise::{ChordFit, FitSettings, FitStatus, Target, Tried, fit_chord_lengths_watched};
use coapt::scene::{Fault, Scene};
use coapt_io::mesh::read_mesh;
use coapt_io::personalise::{FitReport, fitted_scene, target_of};
use coapt_io::report;
use coapt_io::scene::sentence;
use pyo3::prelude::*;

use crate::built::Built;
use crate::closed::{Closed, Relaxed};
use crate::compare::{Source, source};
use crate::fault::{input_error, one_error};
use crate::run::{Stop, run};
use crate::valve::{Valve, closed_of};

/// Chordae fitted to a target.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Fit {
    case: String,
    fit: ChordFit,
    per_group: bool,
    target: String,
    wall_ms: f64,
    warnings: Vec<Fault>,
    /// The valve as given, closed.
    untuned: Option<Closure>,
    /// The valve with the fitted lengths, closed; nothing without a result.
    tuned: Option<Closure>,
}

/// A valve and its closed state, made as everybody makes it: what the fit found, but for the rounding of lengths.
type Closure = (Arc<Built>, Relaxed);

/// Fits the lengths of the chordae so that the valve closes to a surface.
#[pyfunction]
pub(crate) fn personalise(
    py: Python<'_>,
    valve: &Bound<'_, Valve>,
    closed_surface: &Bound<'_, PyAny>,
    per_group: bool,
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
    let done = run(py, move |stop| {
        fitted(given, &target, &settings, &of_target, stop)
    })?;
    let mut fit = done.map_err(|faults| input_error(py, &faults))?;
    fit.warnings.extend(warnings);
    Ok(fit)
}

fn fitted(
    given: Arc<Built>,
    target: &Target,
    settings: &FitSettings,
    name: &str,
    stop: &Stop,
) -> Result<Fit, Vec<Fault>> {
    let begun = Instant::now();
    let fit = fit_chord_lengths_watched(&given.model, target, settings, &|_| stop.flow());
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
    let close = |built: Arc<Built>| {
        let closed = closed_of(&built, None, stop);
        (built, closed)
    };
    let tuned = match &fit.tuned {
        Some(_) => Some(close(Arc::new(
            given.of(fitted_scene(Scene::clone(&given.scene), &fit))?,
        ))),
        None => None,
    };
    Ok(Fit {
        per_group: settings.per_group,
        target: name.to_owned(),
        wall_ms,
        warnings: given.warnings.clone(),
        untuned: fit.untuned.as_ref().map(|_| close(Arc::clone(&given))),
        tuned,
        case: given.model.name.clone(),
        fit,
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
        self.report().json()
    }

    /// The fit as a table for people.
    fn text(&self) -> String {
        self.report().text()
    }

    /// Whether there is a result, with every factor within its range, of a certified closure.
    #[getter]
    fn certified(&self) -> bool {
        let certified = self.fit.tuned.as_ref().is_some_and(Tried::certified);
        self.fit.status == FitStatus::Fitted && certified
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
}

impl Fit {
    fn report(&self) -> FitReport<'_> {
        FitReport {
            case: &self.case,
            per_group: self.per_group,
            target: &self.target,
            fit: &self.fit,
            wall_ms: self.wall_ms,
            warnings: self.warnings.iter().map(sentence).collect(),
        }
    }
}

fn closed((built, relaxed): &Closure) -> Closed {
    Closed::new(Arc::clone(built), relaxed.clone())
}
