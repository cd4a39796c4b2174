//! The last resort: pressure that rises in steps.
//!
//! Pressure follows the surface and has no energy there to fall. A leaflet that little holds is thrown about by it as a flag
//! is by the wind, from the full load on; it comes to rest where the load has risen bit by bit. Of five flail and Barlow valves
//! without marginal chordae, or with all chordae slack, that did not come to rest in 2000 iterations, three did so by this way in
//! 155, 389 and 1021; with steps half or a fifth as long none did, without coarse meshes one. The others take it for nothing, and all
//! the iterations that their settings allow.

use super::levels;
use super::newton::Newton;
use super::watch::Log;
use crate::Vec3;
use crate::model::Model;

/// Iterations at the full load before it is tried, where as many are left for it [1]. Our choice, above what nearly all of
/// `docs/hard-cases.md` takes on all its meshes together: sooner, and valves that come to rest by themselves would begin anew; later,
/// and lost ones wait for longer.
pub(crate) const PATIENCE: u32 = 500;
/// Steps in which pressure rises. Our choice; no other number was tried.
const STEPS: u32 = 4;
/// Iterations of a step: it is only a way. Fewer where few are left, so that as many are for the full load.
const STEP_ITERATION_LIMIT: u32 = 400;

/// Closes the open valve under pressures that rise to the last but one step; each begins where the one before ended.
pub(super) fn raise_pressure(model: &Model, positions: &mut Vec<Vec3>, log: &mut Log) {
    positions.clone_from(&model.rest_mm);
    for step in 1..STEPS {
        let mut lighter = model.clone();
        lighter.pressure_mpa *= f64::from(step) / f64::from(STEPS);
        let mut newton = Newton::new(&lighter);
        newton.iteration_limit = STEP_ITERATION_LIMIT.min(log.iterations_left(model) / STEPS);
        newton.evaluate(positions);
        if step == 1 && model.settings.coarse_to_fine {
            *positions = levels::begin(&mut newton, log).unwrap_or_else(|| positions.clone());
        }
        if log.interrupted {
            return;
        }
        newton.iterate(positions, log);
    }
}
