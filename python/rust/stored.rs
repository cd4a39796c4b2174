//! Valves and results as bytes, with a version: what pickles hold.
//!
//! A valve is its scene and its repairs, of which the same model is built again; a result is that and what the solver found.
//! Numbers of the solver are stored by their bits, since those of a valve that did not close may be undefined.

use std::fmt::Display;
use std::sync::Arc;

use coapt::Vec3;
use coapt::contact::crossing::Crossing;
use coapt::relax::{Certificate, Equilibrium, Iteration, Status, Untangled};
use coapt::scene::{Fault, Repair, Scene};
use coapt::state::State;
use pyo3::PyResult;
use pyo3::exceptions::PyValueError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::built::{Built, Source, build};
use crate::closed::{Inner, Relaxed};

const VALVE_FORMAT: &str = "coapt-valve/1";
const CLOSED_FORMAT: &str = "coapt-closed/1";

#[derive(Serialize, Deserialize)]
pub(crate) struct StoredValve {
    format: String,
    scene: Scene,
    source: Option<Source>,
    /// Place and message.
    of_reading: Vec<(String, String)>,
    repairs: Vec<Repair>,
}

#[derive(Serialize, Deserialize)]
pub(crate) struct StoredClosed {
    format: String,
    valve: StoredValve,
    status: Status,
    stable: bool,
    crossings: Vec<[u32; 3]>,
    untangled: Option<(usize, u64)>,
    wall_ms: u64,
    /// Residual, penetration, mesh error.
    certificate: [u64; 3],
    max_penetration_at_mm: Option<[u64; 3]>,
    positions_mm: Vec<[u64; 3]>,
    reactions_n: Vec<[u64; 3]>,
    /// Residual, step, damping, fraction.
    history: Vec<([u64; 4], bool, usize)>,
}

/// Anything as JSON.
///
/// # Errors
/// None that our types allow.
pub(crate) fn json(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// A valve as text.
pub(crate) fn valve(built: &Built) -> PyResult<String> {
    json(&stored(built))
}

/// A result as text.
pub(crate) fn closed(inner: &Inner) -> PyResult<String> {
    json(&stored_closed(&inner.built, &inner.relaxed))
}

pub(crate) fn stored_closed(built: &Built, Relaxed { equilibrium, wall_ms }: &Relaxed) -> StoredClosed {
    let certificate = &equilibrium.certificate;
    let all = |points: &[Vec3]| points.iter().map(bits).collect();
    StoredClosed {
        format: CLOSED_FORMAT.to_owned(),
        valve: stored(built),
        status: equilibrium.status,
        stable: certificate.stable,
        crossings: certificate
            .crossings
            .iter()
            .map(|it| [it.edge[0], it.edge[1], it.face])
            .collect(),
        untangled: equilibrium
            .untangled
            .map(|it| (it.places, it.farthest_mm.to_bits())),
        wall_ms: wall_ms.to_bits(),
        certificate: [
            certificate.residual,
            certificate.max_penetration_mm,
            certificate.discretisation_mm,
        ]
        .map(f64::to_bits),
        max_penetration_at_mm: certificate.max_penetration_at_mm.as_ref().map(bits),
        positions_mm: all(&equilibrium.state.positions_mm),
        reactions_n: all(&equilibrium.reactions_n),
        history: equilibrium.history.iter().map(stored_iteration).collect(),
    }
}

pub(crate) fn stored(built: &Built) -> StoredValve {
    let words = |fault: &Fault| (fault.place.clone(), fault.message.clone());
    StoredValve {
        format: VALVE_FORMAT.to_owned(),
        scene: Scene::clone(&built.scene),
        source: built.source.as_deref().cloned(),
        of_reading: built.of_reading.iter().map(words).collect(),
        repairs: built.repairs.clone(),
    }
}

fn bits(point: &Vec3) -> [u64; 3] {
    [point.x, point.y, point.z].map(f64::to_bits)
}

fn point(bits: [u64; 3]) -> Vec3 {
    Vec3::from(bits.map(f64::from_bits))
}

fn stored_iteration(it: &Iteration) -> ([u64; 4], bool, usize) {
    let numbers = [it.residual, it.step_mm, it.damping, it.fraction];
    (numbers.map(f64::to_bits), it.exact, it.faces)
}

fn iteration((numbers, exact, faces): ([u64; 4], bool, usize)) -> Iteration {
    let [residual, step_mm, damping, fraction] = numbers.map(f64::from_bits);
    Iteration {
        residual,
        step_mm,
        damping,
        fraction,
        exact,
        faces,
    }
}

/// A valve of its bytes.
///
/// # Errors
/// Another format, or a scene that cannot be built.
pub(crate) fn read_valve(bytes: &[u8]) -> Result<Built, Vec<Fault>> {
    rebuilt(read(bytes, VALVE_FORMAT)?)
}

/// A result of its bytes.
///
/// # Errors
/// As of [`read_valve`]; positions that are none of this valve.
pub(crate) fn read_closed(bytes: &[u8]) -> Result<(Built, Relaxed), Vec<Fault>> {
    reclosed(read(bytes, CLOSED_FORMAT)?)
}

pub(crate) fn reclosed(stored: StoredClosed) -> Result<(Built, Relaxed), Vec<Fault>> {
    let built = rebuilt(stored.valve)?;
    let wanted = built.model.rest_mm.len();
    if [stored.positions_mm.len(), stored.reactions_n.len()] != [wanted; 2] {
        let found = stored.positions_mm.len();
        let message = format!(
            "holds {found} positions, but this version makes {wanted} vertices of its valve; close the valve again"
        );
        return Err(vec![Fault::error("pickle", message)]);
    }
    let [residual, max_penetration_mm, discretisation_mm] = stored.certificate.map(f64::from_bits);
    let crossing = |[a, b, face]: [u32; 3]| Crossing { edge: [a, b], face };
    let equilibrium = Equilibrium {
        state: State {
            positions_mm: stored.positions_mm.into_iter().map(point).collect(),
        },
        status: stored.status,
        certificate: Certificate {
            residual,
            stable: stored.stable,
            crossings: stored.crossings.into_iter().map(crossing).collect(),
            max_penetration_mm,
            max_penetration_at_mm: stored.max_penetration_at_mm.map(point),
            discretisation_mm,
        },
        untangled: stored.untangled.map(|(places, farthest)| Untangled {
            places,
            farthest_mm: f64::from_bits(farthest),
        }),
        reactions_n: stored.reactions_n.into_iter().map(point).collect(),
        history: stored.history.into_iter().map(iteration).collect(),
    };
    let relaxed = Relaxed {
        equilibrium,
        wall_ms: f64::from_bits(stored.wall_ms),
    };
    Ok((built, relaxed))
}

pub(crate) fn rebuilt(stored: StoredValve) -> Result<Built, Vec<Fault>> {
    let warning = |(place, message): (String, String)| Fault::warning(place, message);
    let of_reading = stored.of_reading.into_iter().map(warning).collect();
    build(stored.scene, stored.source.map(Arc::new), of_reading)?.repaired(&stored.repairs)
}

fn read<T: DeserializeOwned>(bytes: &[u8], format: &str) -> Result<T, Vec<Fault>> {
    check_format(serde_json::from_slice(bytes), "valve", format)?;
    serde_json::from_slice(bytes).map_err(damaged)
}

#[derive(Deserialize)]
pub(crate) struct Head {
    format: String,
}

pub(crate) fn check_format<E: Display>(
    head: Result<Head, E>,
    what: &str,
    format: &str,
) -> Result<(), Vec<Fault>> {
    let fault = |message: String| Err(vec![Fault::error("pickle", message)]);
    match head {
        Ok(head) if head.format == format => Ok(()),
        Ok(head) => fault(format!("is `{}`; this version reads `{format}`", head.format)),
        Err(error) => fault(format!("is no {what} of coapt ({error}); expected {format}")),
    }
}

pub(crate) fn damaged(error: impl Display) -> Vec<Fault> {
    vec![Fault::error("pickle", format!("is damaged: {error}"))]
}
