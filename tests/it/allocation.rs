//! The solver allocates when it begins and when contact needs a new pattern, not in every iteration.

use allocation_counter::measure;
use coapt::mesh::parametric::Preset;
use coapt::model::Model;
use coapt::relax::relax;
use coapt::state::State;
use coapt_tests::{close, preset_model};

/// Iterations and allocations of a closure to a tolerance, from a state.
fn cost(model: &Model, start: &State, tolerance: f64) -> (usize, u64) {
    let mut model = model.clone();
    model.settings.residual_tolerance = tolerance;
    let mut iterations = 0;
    let counted = measure(|| iterations = relax(&model, start).history.len());
    (iterations, counted.count_total)
}

/// From the closed valve at another pressure, so that contact hardly changes: what further iterations allocate is at most a
/// longer history and one new pattern, and that is less than what beginning allocates.
#[test]
fn further_iterations_allocate_next_to_nothing() {
    for preset in Preset::ALL {
        let mut model = preset_model(preset, 650, 0.0, 0);
        let closed = close(&model).state;
        model.pressure_mpa *= 1.02;
        let [(few, begun), (many, gone_on)] = [1e-1, 1e-8].map(|tolerance| cost(&model, &closed, tolerance));
        assert!(many >= few + 3, "{}: {few} and {many} iterations", preset.name());
        let more = gone_on.saturating_sub(begun);
        assert!(
            2 * more < begun,
            "{}: {begun} allocations, then {more}",
            preset.name()
        );
    }
}
