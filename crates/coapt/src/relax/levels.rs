//! From coarse to fine: where a coarser model of the valve closes is where the fine one begins.
//!
//! On a coarse mesh a step costs little and may be long. What is left to the fine mesh is to settle, whatever its size: the
//! same seven to twenty-five iterations at 650 faces and at 10,000. The way that the fine vertices took does not matter, as
//! long as nothing crosses where they begin; where something would, they walk there from the open valve, bounded by contact.

use super::Status;
use super::newton::Newton;
use super::soft_chordae::{SOFT_MM, softened};
use super::watch::Log;
use crate::Vec3;
use crate::coarsen::coarsen;
use crate::contact::tangle::tangles;
use crate::model::Model;

/// Leaflet vertices of the fine model per vertex of the coarse one [1]: edges twice as long. Where the carried-over shape
/// crosses or touches itself, which is chance, another coarse mesh is tried.
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

/// Where to begin: the closed shape of a coarser model, carried over; nothing where there is no such model, where it did not
/// close or was interrupted.
pub(super) fn begin(newton: &mut Newton, log: &mut Log) -> Option<Vec<Vec3>> {
    let mut tangled = None;
    for ratio in VERTEX_RATIOS {
        let vertex_target = (newton.model.leaflet_vertex_count as f64 / ratio) as usize;
        if vertex_target < LEAST_VERTICES {
            continue;
        }
        let Some(shape) = carried_over(newton.model, vertex_target, log) else {
            break;
        };
        // Not only crossings: parts that are nearer than steps ever let them come would not move.
        if tangles(&newton.surface, &shape).is_empty() {
            return Some(shape);
        }
        tangled.get_or_insert(shape);
    }
    if log.interrupted {
        return None;
    }
    let mut positions = newton.model.rest_mm.clone();
    newton.walk(&mut positions, &tangled?);
    Some(positions)
}

fn carried_over(model: &Model, vertex_target: usize, log: &mut Log) -> Option<Vec<Vec3>> {
    let mut coarse = coarsen(model, vertex_target)?;
    let settings = &mut coarse.model.settings;
    settings.residual_tolerance = settings.residual_tolerance.max(COARSE_TOLERANCE);
    settings.iteration_limit = settings.iteration_limit.min(COARSE_ITERATION_LIMIT);
    if let Some(softer) = softened(&coarse.model, SOFT_MM) {
        coarse.model = softer;
    }
    let mut newton = Newton::new(&coarse.model);
    newton.step_limit_mm *= COARSE_STEP;
    // Whether the coarse valve is stable does not matter.
    newton.escape_limit = 0;
    let begun = begin(&mut newton, log);
    if log.interrupted {
        return None;
    }
    let mut positions = begun.unwrap_or_else(|| coarse.model.rest_mm.clone());
    if newton.iterate(&mut positions, log) != Status::Converged {
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
