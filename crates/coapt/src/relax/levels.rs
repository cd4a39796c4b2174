//! From coarse to fine: where a coarser model of the valve closes is where the fine one begins.
//!
//! On a coarse mesh a step costs little and may be long. What is left to the fine mesh is to settle, whatever its size: the
//! same fifteen to thirty iterations at 650 faces and at 10,000. The way that the fine vertices took does not matter, as
//! long as nothing crosses where they begin; where something would, they walk there from the open valve, bounded by contact.

use super::load::reference_force_n;
use super::newton::Newton;
use super::{Iteration, Status};
use crate::Vec3;
use crate::coarsen::coarsen;
use crate::contact::crossing::crossings;
use crate::energy::chord_law::response;
use crate::model::Model;

/// Leaflet vertices of the fine model per vertex of the coarse one [1]: edges twice as long. Where the carried-over shape
/// crosses itself, which is chance, another coarse mesh is tried.
const VERTEX_RATIOS: [f64; 3] = [4.0, 3.0, 5.0];
/// No level has fewer leaflet vertices than this. Below, leaflets are two or three triangles high and close elsewhere.
const LEAST_VERTICES: usize = 60;
/// Residual at which a coarse valve is closed enough [1]. At 0.1 the coarse iterations are a third more and the fine ones
/// no fewer; from 1.5 on these are more, at 3 twice as many.
const COARSE_TOLERANCE: f64 = 0.5;
/// A coarse valve's longest step, in those of a closure by itself [1]: how exactly it follows the way does not matter. At 1
/// it takes a third more iterations; beyond 2 hardly fewer, and pairs in reach become many.
const COARSE_STEP: f64 = 2.0;
/// A coarse valve that takes longer is of no help.
const COARSE_ITERATION_LIMIT: u32 = 300;

/// Where to begin: the closed shape of a coarser model, carried over; nothing where there is no such model or it did not
/// close.
pub(super) fn begin(newton: &mut Newton, history: &mut Vec<Iteration>) -> Option<Vec<Vec3>> {
    let mut tangled = None;
    for ratio in VERTEX_RATIOS {
        let vertex_target = (newton.model.leaflet_vertex_count as f64 / ratio) as usize;
        if vertex_target < LEAST_VERTICES {
            continue;
        }
        let Some(shape) = carried_over(newton.model, vertex_target, history) else {
            break;
        };
        if crossings(&newton.surface, &shape).is_empty() {
            return Some(shape);
        }
        tangled.get_or_insert(shape);
    }
    let mut positions = newton.model.rest_mm.clone();
    newton.walk(&mut positions, &tangled?);
    Some(positions)
}

fn carried_over(model: &Model, vertex_target: usize, history: &mut Vec<Iteration>) -> Option<Vec<Vec3>> {
    let mut coarse = coarsen(model, vertex_target)?;
    let settings = &mut coarse.model.settings;
    settings.residual_tolerance = settings.residual_tolerance.max(COARSE_TOLERANCE);
    settings.iteration_limit = settings.iteration_limit.min(COARSE_ITERATION_LIMIT);
    soften(&mut coarse.model, COARSE_CHORD_STRETCH_MM);
    let mut newton = Newton::new(&coarse.model);
    newton.step_limit_mm *= COARSE_STEP;
    // Whether the coarse valve is stable does not matter.
    newton.escape_limit = 0;
    let begun = begin(&mut newton, history);
    let mut positions = begun.unwrap_or_else(|| coarse.model.rest_mm.clone());
    if newton.iterate(&mut positions, history) != Status::Converged {
        return None;
    }
    let mut shape = coarse
        .prolongation
        .prolong(&coarse.model.rest_mm, &positions, &model.rest_mm);
    for prescribed in &model.prescribed {
        shape[prescribed.vertex as usize] = prescribed.target_mm;
    }
    Some(shape)
}

/// Chordae of a coarse valve give at least so much under their share of the load [mm].
const COARSE_CHORD_STRETCH_MM: f64 = 0.1;

/// Chordae that give less than this under their share of the load are stiffened in stages, each of so many times the last.
const STIFFENING: f64 = 10.0;
const STIFFENED_TOLERANCE: f64 = 0.3;
const STIFFENING_LIMIT: u32 = 60;

/// From the soft chordae of coarse valves to those of this one, stage by stage, so that none goes slack on the way.
pub(super) fn stiffen(model: &Model, positions: &mut Vec<Vec3>, history: &mut Vec<Iteration>) {
    let mut give_mm = COARSE_CHORD_STRETCH_MM;
    loop {
        let mut soft = model.clone();
        let ratio = soften(&mut soft, give_mm);
        if ratio > 0.1 {
            return;
        }
        soft.settings.residual_tolerance = soft.settings.residual_tolerance.max(STIFFENED_TOLERANCE);
        soft.settings.iteration_limit = soft.settings.iteration_limit.min(STIFFENING_LIMIT);
        let mut newton = Newton::new(&soft);
        newton.escape_limit = 0;
        newton.iterate(positions, history);
        give_mm /= STIFFENING;
    }
}

/// Makes chordae so thin that each gives by so much under its share of the pressure's force; the smallest ratio of what is
/// left to what was [1].
///
/// A stiff rod that passes from slack to taut within a step throws the valve about: it carries nothing, then a hundred times
/// its load, and every such kink costs iterations.
fn soften(model: &mut Model, give_mm: f64) -> f64 {
    let count = model.chords.ends.len().max(1) as f64;
    let share_n = reference_force_n(model) * model.leaflet_vertex_count as f64 / count;
    let chords = &mut model.chords;
    let mut least = 1.0_f64;
    for index in 0..chords.ends.len() {
        let rest_length_mm = chords.rest_length_mm[index];
        let law = &chords.laws[chords.group[index] as usize];
        let stress_mpa = response(law, give_mm / rest_length_mm).stress_mpa;
        let area = chords.area_mm2[index].min(share_n / stress_mpa);
        least = least.min(area / chords.area_mm2[index]);
        chords.area_mm2[index] = area;
    }
    least
}
