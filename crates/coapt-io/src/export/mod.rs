//! Models for other engines, and their answers: the same mesh, laws, supports and loads, so that a closure can be
//! checked by a program that shares no line with this one.
//!
//! | file | engine | what is carried over |
//! |---|---|---|
//! | `.inp` | CalculiX (and Abaqus, not tried) | leaflets, chordae, supports, pressure; no contact |
//! | `.feb` | FEBio, spec 4.0 | the same, and contact between leaflets, of FEBio's kind |
//!
//! Node v + 1 is vertex v in both. Units are mm, N, MPa. Each file begins with a comment that says which law became
//! which card, and what could not be carried over. A law without an equal is refused.
//!
//! A `.feb` was checked against FEBio's documentation only: we have never run FEBio.

mod calculix;
mod febio;
mod material;
mod results;

use std::fmt::{Arguments, Write};
use std::path::Path;

use coapt::Vec3;
use coapt::model::{ChordGroup, ChordKind, Model};
use coapt::scene::Fault;

pub use calculix::calculix;
pub use febio::febio;
pub use results::read_positions;

use crate::atomic::write_text_atomically;
use crate::report::NOTICE;

/// Writes an exported model.
///
/// # Errors
/// What the file system says; the old file is then untouched.
pub fn write_export(path: &Path, text: &str) -> Result<(), Fault> {
    write_text_atomically(path, text.as_bytes())
}

/// A line more. Writing to a string cannot fail.
fn put(text: &mut String, line: Arguments<'_>) {
    let _ = text.write_fmt(line);
    text.push('\n');
}

/// What both formats say first, a line each.
fn heading(model: &Model, engine: &str, cards: &[String], lost: &[&str]) -> Vec<String> {
    let mut lines = vec![
        format!(
            "{} for {engine}, made by coapt {}",
            plain(&model.name),
            env!("CARGO_PKG_VERSION")
        ),
        NOTICE.to_owned(),
        "units: mm, N, MPa; node v + 1 is vertex v of the model; element f + 1 is its face f".to_owned(),
    ];
    for (leaflet, card) in model.leaflets.iter().zip(cards) {
        lines.push(format!("leaflet {}: {card}", plain(&leaflet.name)));
    }
    lines.extend(lost.iter().map(|what| format!("not carried over: {what}")));
    lines
}

/// No scene has dead loads or sutures, so that no export carries them; a model made in a program may. Sutures are stretched
/// ten times their length and more before the valve closes, beyond the tables of other engines, and what they pull together
/// passes through itself in CalculiX, which gets no contact.
fn refuse_what_no_scene_has(model: &Model) -> Result<(), Vec<Fault>> {
    let mut faults = Vec::new();
    if !model.dead_loads_n.is_empty() {
        let message = format!(
            "{} forces on vertices are not exported; expected none",
            model.dead_loads_n.len()
        );
        faults.push(Fault::error("dead_loads_n", message));
    }
    let is_suture = |group: &&ChordGroup| group.kind == ChordKind::Suture;
    if let Some(group) = model.chord_groups.iter().find(is_suture) {
        let message = format!(
            "has the sutures of `{}`, which are not exported; expected a valve that is not sewn together",
            group.name
        );
        faults.push(Fault::error("chord_groups", message));
    }
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

/// A name as it may stand in any comment: printable ASCII, no `--`, not long.
fn plain(name: &str) -> String {
    let safe = |letter: char| match letter {
        ' '..='~' if letter != '-' => letter,
        _ => '_',
    };
    name.chars().take(60).map(safe).collect()
}

/// Density [t/mm³] for the dynamic step, no tissue's: so heavy that the step is orderly, so light that it ends near the
/// balance. A piece of leaflet under the pressure alone would travel ½ p / (ρ t) in the step of one second, here 17 times
/// the size of the valve. At ten times the density CalculiX takes half the time, but one of four valves came to rest in
/// another balance.
fn density(model: &Model) -> f64 {
    let areas = (0..model.faces.len()).map(|face| {
        let [a, b, c] = corners(model, face);
        0.5 * (b - a).cross(&(c - a)).norm()
    });
    let size_mm = areas.sum::<f64>().sqrt();
    let thickest = model
        .leaflets
        .iter()
        .map(|leaflet| leaflet.thickness_mm)
        .fold(0.0, f64::max);
    // About 1 mmHg, where there is next to no pressure.
    0.03 * model.pressure_mpa.abs().max(1e-4) / (thickest * size_mm)
}

fn corners(model: &Model, face: usize) -> [Vec3; 3] {
    model.faces[face].map(|vertex| model.rest_mm[vertex as usize])
}

#[cfg(test)]
mod tests;
