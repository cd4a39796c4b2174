//! Stiff chordae are approached from soft ones.
//!
//! A stiff rod that passes from slack to taut within a step throws the valve about: it carries nothing, then a hundred times
//! its load, and every such kink costs iterations. What a chord gives under its share of the load, mitral chordae 0.1 mm,
//! those of the tricuspid valve in `tests/it/texas/` 0.004 mm, hardly matters to the shape. So a valve whose chordae are far
//! stiffer than the former closes with softer ones first, on coarse meshes always, on its own in stages, in which taut
//! chordae stay taut. Without it, residuals at that valve's chordae stay above 1 for 250 iterations.

use super::load::reference_force_n;
use super::newton::Newton;
use super::watch::Log;
use crate::Vec3;
use crate::energy::chord_law::response;
use crate::model::Model;

/// What soft chordae give under their share of the load [mm]: what mitral ones do.
pub(super) const SOFT_MM: f64 = 0.1;
/// Chordae more than so many times as stiff are softened, and stiffened by as much from stage to stage [1]; our choice. Softened to the
/// same give where they are a few times as stiff, the healthy valve took 39 iterations instead of 48 and that of Barlow 68 instead of
/// 61 when it was tried: not worth another road.
const STAGE: f64 = 10.0;
/// Residual at which a stage ends [1], and the iterations after which the next begins all the same: it is only a way.
const STAGE_TOLERANCE: f64 = 0.3;
const STAGE_ITERATION_LIMIT: u32 = 60;

/// Goes from soft chordae to nearly those of the model.
pub(super) fn stiffen(model: &Model, positions: &mut Vec<Vec3>, log: &mut Log) {
    let mut give_mm = SOFT_MM;
    while !log.interrupted
        && let Some(mut soft) = softened(model, give_mm)
    {
        soft.settings.residual_tolerance = soft.settings.residual_tolerance.max(STAGE_TOLERANCE);
        soft.settings.iteration_limit = soft.settings.iteration_limit.min(STAGE_ITERATION_LIMIT);
        let mut newton = Newton::new(&soft);
        newton.escape_limit = 0;
        newton.iterate(positions, log);
        give_mm /= STAGE;
    }
}

/// The model with chordae so thin that each gives at least so much under its share of the nodal forces that residuals are
/// measured by; nothing where all keep a tenth of their cross-sections, nor without pressure: chordae have no load to share then, and
/// softened by what tissue bears at a strain of 1e-3 they took a valve with a clip through three stages, of ten to sixteen iterations
/// each, that led nowhere.
pub(super) fn softened(model: &Model, give_mm: f64) -> Option<Model> {
    let chords = &model.chords;
    if chords.ends.is_empty() || model.pressure_mpa == 0.0 {
        return None;
    }
    let count = chords.ends.len() as f64;
    let share_n = reference_force_n(model) * model.leaflet_vertex_count as f64 / count;
    let part_left = |index: usize| {
        let law = &chords.laws[chords.group[index] as usize];
        let stress_mpa = response(law, give_mm / chords.rest_length_mm[index]).stress_mpa;
        (share_n / (stress_mpa * chords.area_mm2[index])).min(1.0)
    };
    let parts: Vec<f64> = (0..chords.ends.len()).map(part_left).collect();
    if parts.iter().all(|part| *part >= 1.0 / STAGE) {
        return None;
    }
    let mut soft = model.clone();
    for (area_mm2, part) in soft.chords.area_mm2.iter_mut().zip(parts) {
        *area_mm2 *= part;
    }
    Some(soft)
}
