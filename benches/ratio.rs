//! What a closure costs in evaluations of all forces, and beside the explicit baseline, in one run on one machine:
//! times of different days or machines do not make a ratio.
//!
//! The four take turns, so that whatever else the machine does falls on all of them; medians are printed.

use coapt::measure::visible_distance;
use coapt::relax::{load, relax};
use coapt::state::State;
use coapt_benches::explicit::{self, assert_closed, close_explicitly};
use coapt_benches::{PLANNING_SIZE, assert_certified, closed_scenery, label};
use std::hint::black_box;
use std::io::Write;
use std::time::Instant;

/// Turns; an odd number has a median of its own.
const TURNS: usize = 9;
/// Evaluations of all forces in a turn: one alone is too short to be timed.
const EVALUATIONS: u32 = 200;

fn main() {
    // As with the other benches, a filter that does not name this one leaves it out.
    let mut filters = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with('-'))
        .peekable();
    if filters.peek().is_some() && !filters.any(|word| "ratio".contains(&word)) {
        return;
    }
    let scenery = closed_scenery(PLANNING_SIZE);
    let positions_mm = &scenery.state.positions_mm;
    let start = State::open(&scenery.model);
    let mut rough = scenery.model.clone();
    rough.settings.residual_tolerance = explicit::TOLERANCE;
    assert_certified(&relax(&rough, &start));
    let baseline = close_explicitly(&scenery.model, &start, explicit::TOLERANCE, explicit::STEP_LIMIT);
    assert_closed(&baseline);
    let mut times = [const { Vec::new() }; 4];
    for _ in 0..TURNS {
        let turn = [
            milliseconds(EVALUATIONS, || {
                load::gradient(&scenery.model, &scenery.pairs, positions_mm)
            }),
            milliseconds(1, || relax(&scenery.model, &start)),
            milliseconds(1, || relax(&rough, &start)),
            milliseconds(1, || {
                close_explicitly(&scenery.model, &start, explicit::TOLERANCE, explicit::STEP_LIMIT)
            }),
        ];
        times
            .iter_mut()
            .zip(turn)
            .for_each(|(times, time)| times.push(time));
    }
    let [forces, closure, roughly, explicitly] = times.map(median);
    let apart = visible_distance(
        &scenery.model,
        &baseline.state.positions_mm,
        &scenery.model,
        positions_mm,
    );
    let tolerance = scenery.model.settings.residual_tolerance;
    let text = format!(
        "ratio/{}: medians of {TURNS} turns\n\
         all forces once, closed               {forces:9.4} ms        1\n\
         closure to {tolerance:.0e}, certified          {closure:9.2} ms {:8.0}\n\
         closure to {:.0e}, certified          {roughly:9.2} ms {:8.0}\n\
         explicit baseline to {:.0e}           {explicitly:9.2} ms {:8.0}\n\
         explicit over closure, both to {:.0e} {:9.2}\n\
         explicit: {} steps, residual {:.1e}, {} crossings, {:.3} mm (root mean square) from the closure\n",
        label(PLANNING_SIZE),
        closure / forces,
        explicit::TOLERANCE,
        roughly / forces,
        explicit::TOLERANCE,
        explicitly / forces,
        explicit::TOLERANCE,
        explicitly / roughly,
        baseline.steps,
        baseline.residual,
        baseline.crossings,
        apart.map_or(f64::NAN, |apart| apart.rms_mm),
    );
    // Where standard output is closed there is nobody to tell.
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// Mean time of one call [ms].
fn milliseconds<T>(calls: u32, work: impl Fn() -> T) -> f64 {
    let start = Instant::now();
    for _ in 0..calls {
        black_box(work());
    }
    start.elapsed().as_secs_f64() * 1e3 / f64::from(calls)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
