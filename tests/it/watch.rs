//! Whoever looks on while a valve closes sees every iteration, changes nothing, and stops it at once.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use coapt::Vec3;
use coapt::mesh::parametric::Preset;
use coapt::model::Model;
use coapt::personalise::{FitSettings, FitStatus, Progress, Target, fit_chord_lengths_watched};
use coapt::relax::{Equilibrium, Interactive, Iteration, Status, relax, relax_watched};
use coapt::state::State;
use coapt_tests::{close, preset_model};

/// Small enough to be closed again and again, large enough for a coarser mesh; with chordae so stiff that they begin soft.
fn valve_of_all_stages() -> Model {
    let mut model = preset_model(Preset::Healthy, 650, 0.0, 0);
    model.chords.area_mm2.iter_mut().for_each(|area| *area *= 300.0);
    model
}

fn stopped_after(model: &Model, count: usize) -> Equilibrium {
    let mut seen = 0;
    let end = relax_watched(model, &State::open(model), |moment| {
        seen += 1;
        assert_eq!(moment.count, seen);
        match seen == count {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    assert!(seen <= count, "asked again after it had said stop");
    end
}

#[test]
fn looking_on_shows_every_iteration_and_changes_no_bit() {
    let model = valve_of_all_stages();
    let alone = relax(&model, &State::open(&model));
    let mut seen: Vec<Iteration> = Vec::new();
    let mut last: Vec<Vec3> = Vec::new();
    let (mut coarser, mut softer) = (false, false);
    let watched = relax_watched(&model, &State::open(&model), |moment| {
        seen.push(moment.iteration);
        assert_eq!(moment.model.faces.len(), moment.iteration.faces);
        assert_eq!(moment.model.rest_mm.len(), moment.positions_mm.len());
        last = moment.positions_mm.to_vec();
        let is_coarser = moment.model.faces.len() < model.faces.len();
        coarser |= is_coarser;
        softer |= !is_coarser && moment.model.chords.area_mm2 != model.chords.area_mm2;
        ControlFlow::Continue(())
    });
    assert!(coarser && softer, "{coarser} {softer}");
    assert_eq!(alone, watched);
    assert_eq!(seen, watched.history);
    assert_eq!(last, watched.state.positions_mm);
}

/// At every third iteration, so that coarse meshes, stages of soft chordae and the last iterations are all met.
#[test]
fn a_closure_stops_wherever_it_is_told_to() {
    let model = valve_of_all_stages();
    let whole = close(&model);
    let faces = model.faces.len();
    let coarse = whole.history.iter().filter(|made| made.faces < faces).count();
    assert!(coarse > 3 && whole.history.len() > coarse + 3);
    for count in (1..whole.history.len()).step_by(3) {
        let end = stopped_after(&model, count);
        assert_eq!(end.status, Status::Interrupted, "after {count}");
        assert_eq!(end.history, whole.history[..count]);
        assert!(!end.certificate.is_certified(end.status) && !end.certificate.stable);
        assert!(end.certificate.crossings.is_empty(), "after {count}");
        // On a coarser mesh the valve itself has not moved.
        assert_eq!(end.state == State::open(&model), count <= coarse, "after {count}");
    }
}

#[test]
fn an_interrupted_edit_goes_on_with_the_next() {
    let model = preset_model(Preset::Healthy, 650, 0.0, 0);
    let closed = close(&model);
    let targets: Vec<Vec3> = model
        .prescribed
        .iter()
        .map(|held| held.target_mm * 1.02)
        .collect();
    let mut edited = Interactive::new(&model, &closed);
    let stopped = edited
        .close_watched(&targets, |_| ControlFlow::Break(()))
        .unwrap();
    assert_eq!((stopped.status, stopped.history.len()), (Status::Interrupted, 1));
    assert_ne!(stopped.state, closed.state);
    assert_eq!(edited.close(&targets).unwrap().status, Status::Converged);
}

#[test]
fn a_wrong_number_of_targets_is_refused_and_moves_nothing() {
    let model = preset_model(Preset::Healthy, 650, 0.0, 0);
    let closed = close(&model);
    let targets: Vec<Vec3> = model
        .prescribed
        .iter()
        .map(|held| held.target_mm * 1.01)
        .collect();
    let mut edited = Interactive::new(&model, &closed);
    let many = [targets.clone(), targets.clone()].concat();
    for wrong in [&[], &targets[1..], &many[..]] {
        let fault = edited.close(wrong).unwrap_err();
        let expected = format!("one for each of the {} prescribed vertices", targets.len());
        assert!(fault.message.contains(&expected), "{fault:?}");
    }
    let untroubled = Interactive::new(&model, &closed).close(&targets);
    assert_eq!(edited.close(&targets), untroubled);
}

/// After the break no closure is begun; those that run side by side were asked once more each at most.
#[test]
fn a_fit_stops_without_a_result() {
    let model = preset_model(Preset::Healthy, 160, 0.0, 0);
    let closed = close(&model).state.positions_mm;
    let target = Target {
        points_mm: closed[..model.leaflet_vertex_count].to_vec(),
    };
    let fit = |limit: usize| {
        let (asked, begun, ended) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
        let count = |counter: &AtomicUsize, by| {
            counter.fetch_add(by, Ordering::Relaxed);
            ControlFlow::Continue(())
        };
        let watch = |progress: &Progress| match progress {
            Progress::Begun(more) => count(&begun, *more),
            Progress::Closed => count(&ended, 1),
            Progress::Iterated(_) => match asked.fetch_add(1, Ordering::Relaxed) < limit {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            },
        };
        let fit = fit_chord_lengths_watched(&model, &target, &FitSettings::default(), &watch).unwrap();
        // Whatever began came to its end, stopped or not.
        assert_eq!([begun.into_inner(), ended.into_inner()], [fit.closures; 2]);
        (fit, asked.into_inner())
    };
    let (whole, asked) = fit(usize::MAX);
    assert_eq!(whole.status, FitStatus::Fitted);
    // In the scan, and in the search.
    for limit in [5, asked / 2] {
        let (stopped, asked) = fit(limit);
        assert_eq!(stopped.status, FitStatus::Interrupted);
        assert!(stopped.tuned.is_none() && stopped.groups.iter().all(|group| group.scale == 1.0));
        assert!(stopped.closures < whole.closures);
        assert!(asked <= limit + 16, "{asked} after {limit}");
    }
}
