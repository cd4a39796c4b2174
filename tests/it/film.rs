//! Films: rows of balances that end with the closure, bit for bit.

use std::ops::ControlFlow;

use coapt::film::{film, film_watched};
use coapt::mesh::parametric::Preset;
use coapt::model::Model;
use coapt::plan::apply_all;
use coapt::relax::{Status, relax};
use coapt::repair::parse_ring_spec;
use coapt::scene::Repair;
use coapt::state::State;
use coapt_tests::{assert_balanced, close, preset_model};

fn ringed(model: &Model) -> Model {
    let ring = parse_ring_spec("physio-like:32").expect("a ring");
    apply_all(model, &[Repair::Ring(ring)]).expect("it fits").model
}

/// Each frame is a certified balance under its own pressure, which rises from nothing to all of it.
#[test]
fn every_frame_is_a_balance_and_the_last_is_the_closure() {
    for preset in Preset::ALL {
        for model in [preset_model(preset, 300, 0.0, 0)]
            .into_iter()
            .flat_map(|model| [ringed(&model), model])
        {
            let closed = close(&model);
            let film = film(&model, &closed, 30);
            let name = preset.name();
            assert_eq!(film.frames.len(), 30);
            assert_eq!(film.frames[29].equilibrium, closed, "{name}");
            assert_eq!(film.frames[29].pressure_mpa, model.pressure_mpa);
            assert_eq!(film.frames[0].pressure_mpa, 0.0);
            assert!(
                film.frames
                    .is_sorted_by(|one, next| one.pressure_mpa < next.pressure_mpa)
            );
            for (number, frame) in film.frames.iter().enumerate() {
                assert!(
                    frame.is_certified(),
                    "{name}: frame {number}: {:?}",
                    frame.equilibrium.status
                );
                let mut lighter = model.clone();
                lighter.pressure_mpa = frame.pressure_mpa;
                // Without pressure there is nothing to carry.
                if number > 0 {
                    let name = format!("{name}, frame {number}");
                    assert_balanced(&name, &lighter, &frame.equilibrium);
                }
            }
        }
    }
}

/// The unloaded valve is the one that the open valve comes to without pressure. What is left between the two is the residual, 1e-6
/// of a small force, over the softest stiffness: 1e-3 mm is far below any mesh error and far above it.
#[test]
fn the_first_frame_is_the_balance_of_the_open_valve() {
    for preset in Preset::ALL {
        let model = preset_model(preset, 300, 0.0, 0);
        let film = film(&model, &close(&model), 30);
        let gap_mm = film.open_gap_mm.expect("it opens");
        assert!(gap_mm < 1e-3, "{}: {gap_mm}", preset.name());
        // It is told of leaflets alone: measured here anew.
        let unloaded = Model {
            pressure_mpa: 0.0,
            ..model.clone()
        };
        let open = relax(&unloaded, &State::open(&model)).state.positions_mm;
        let first = &film.frames[0].equilibrium.state.positions_mm;
        let gaps = first.iter().zip(&open).take(model.leaflet_vertex_count);
        let largest = gaps.map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
        assert_eq!(gap_mm, largest);
    }
}

/// Three iterations are too few for a balance.
#[test]
fn a_frame_that_does_not_converge_is_kept_and_says_so() {
    let mut model = preset_model(Preset::Healthy, 160, 0.0, 0);
    let closed = close(&model);
    model.settings.iteration_limit = 3;
    let film = film(&model, &closed, 4);
    assert!(film.frames[3].is_certified());
    let lost = film
        .frames
        .iter()
        .filter(|frame| frame.equilibrium.status == Status::IterationLimit);
    let lost: Vec<_> = lost.collect();
    assert!(!lost.is_empty());
    assert!(lost.iter().all(|frame| !frame.is_certified()));
    assert_eq!(film.open_gap_mm, None);
}

#[test]
fn a_film_stops_where_it_is_told_to_and_looking_on_changes_nothing() {
    let model = preset_model(Preset::Healthy, 160, 0.0, 0);
    let closed = close(&model);
    let alone = film(&model, &closed, 6);
    let mut seen = 0;
    let watched = film_watched(&model, &closed, 6, |_| {
        seen += 1;
        ControlFlow::Continue(())
    });
    assert_eq!(alone, watched);
    // Within the unloading, before its last frame.
    let mut left = seen / 4;
    let stopped = film_watched(&model, &closed, 6, |_| {
        left -= 1;
        match left {
            0 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    assert!(stopped.frames.len() < 6);
    assert_eq!(stopped.frames[0].equilibrium.status, Status::Interrupted);
    let whole = alone.frames.len() - (stopped.frames.len() - 1);
    assert_eq!(stopped.frames[1..], alone.frames[whole..]);
}

/// Two frames are the fewest that show anything.
#[test]
fn a_film_has_two_frames_at_least() {
    let model = preset_model(Preset::Healthy, 160, 0.0, 0);
    let closed = close(&model);
    for frames in [0, 1, 2] {
        let film = film(&model, &closed, frames);
        assert_eq!(film.frames.len(), 2);
        assert_eq!(film.frames[1].equilibrium, closed);
    }
}
