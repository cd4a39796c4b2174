//! `personalise`: chord lengths fitted to a closed surface.

use std::sync::Arc;
use std::time::Instant;

use coapt::Vec3;
use coapt::personalise::{ChordFit, FitSettings, FitStatus, Target, Tried, fit_chord_lengths_watched};
use coapt::scene::{Fault, Scene};
use coapt_io::mesh::{PolyData, read_mesh};
use coapt_io::report;
use coapt_io::scene::sentence;
use pyo3::prelude::*;
use serde_json::json;

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
        Some(_) => Some(close(Arc::new(given.of(with_lengths(&given.scene, &fit))?))),
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

/// The scene with the fitted factors.
fn with_lengths(scene: &Scene, fit: &ChordFit) -> Scene {
    let mut scene = scene.clone();
    for (group, fitted) in scene.chordae.iter_mut().zip(&fit.groups) {
        group.rest_length_scale *= fitted.scale;
    }
    scene
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
    let points_mm = used_points(&name, &mesh).map_err(|fault| input_error(py, &[fault]))?;
    Ok((name, Target { points_mm }, warnings))
}

/// The points of a surface that its triangles use.
fn used_points(name: &str, mesh: &PolyData) -> Result<Vec<Vec3>, Fault> {
    if mesh.triangles.is_empty() {
        let message = "has no triangles; expected the surface of the closed leaflets";
        return Err(Fault::error(name, message));
    }
    let count = mesh.points.len();
    let mut used = vec![false; count];
    for &point in mesh.triangles.iter().flatten() {
        let Some(used) = used.get_mut(point as usize) else {
            let message =
                format!("has a triangle with point {point}; expected one of its {count} points, from 0");
            return Err(Fault::error(name, message));
        };
        *used = true;
    }
    let points = mesh.points.iter().zip(used).filter(|(_, used)| *used);
    Ok(points.map(|(&point, _)| Vec3::from(point)).collect())
}

#[pymethods]
impl Fit {
    /// The fit as `personalise.json` holds it.
    fn report_json(&self) -> String {
        let state = |tried: &Option<Tried>| {
            tried.as_ref().map(|tried| {
                json!({
                    "certified": tried.certified(),
                    "all_points": tried.all_points,
                    "visible_points": tried.visible_points,
                })
            })
        };
        let fit = &self.fit;
        let warnings: Vec<String> = self.warnings.iter().map(sentence).collect();
        json!({
            "case": self.case, "target": self.target, "per_group": self.per_group,
            "status": fit.status, "chord_groups": fit.groups,
            "untuned": state(&fit.untuned), "tuned": state(&fit.tuned),
            "closures": fit.closures, "unconverged": fit.unconverged, "wall_ms": self.wall_ms,
            "history": fit.history, "warnings": warnings,
        })
        .to_string()
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

fn closed((built, relaxed): &Closure) -> Closed {
    Closed::new(Arc::clone(built), relaxed.clone())
}
