//! What ranks and what does not, and that a comparison is what its closures are.

use super::*;
use crate::mesh::parametric::{Preset, ValveParameters, generate};
use crate::relax::relax;
use crate::repair::parse_ring_spec;
use crate::scene::Ring;

fn small(preset: Preset) -> Model {
    let parameters = ValveParameters {
        face_count_target: 200,
        ..ValveParameters::preset(preset)
    };
    Model::build(&generate(&parameters).unwrap()).unwrap().model
}

/// A saddle ring; one of 10 mm belongs to no mitral valve.
fn ring(size_mm: f64) -> Alternative {
    let ring = Ring {
        size_mm: Some(size_mm),
        ..parse_ring_spec("saddle:30").unwrap()
    };
    Alternative {
        name: size_mm.to_string(),
        repairs: vec![Repair::Ring(ring)],
    }
}

/// A closed valve with other measures.
fn outcome(of: &Outcome, [orifice, length, force, strain]: [f64; 4]) -> Outcome {
    let mut outcome = of.clone();
    let measures = &mut outcome.measures;
    measures.orifice.area_mm2 = orifice;
    measures.coaptation.length_mean_mm = length;
    measures.chords.max_force_n = force;
    measures
        .leaflets
        .iter_mut()
        .for_each(|leaflet| leaflet.strain_p95 = strain);
    outcome
}

fn certified() -> Outcome {
    let outcome = compare(&small(Preset::Healthy), &[], &Settings::default()).before;
    assert!(outcome.is_certified());
    outcome
}

/// The numbers of the rows in their order, each with its rank.
fn ranked(values: &[[f64; 4]], criteria: &[Criterion]) -> Vec<(usize, usize)> {
    let like = certified();
    let row = |(alternative, &values): (usize, &[f64; 4])| Row {
        alternative,
        rank: None,
        result: Ok(outcome(&like, values)),
    };
    let mut rows: Vec<Row> = values.iter().enumerate().map(row).collect();
    let mut backwards: Vec<Row> = rows.iter().rev().cloned().collect();
    ranking::rank(&mut rows, criteria);
    ranking::rank(&mut backwards, criteria);
    assert_eq!(rows, backwards, "the order they come in does not matter");
    rows.iter()
        .map(|row| (row.alternative, row.rank.unwrap()))
        .collect()
}

#[test]
fn criteria_count_in_their_order_and_noise_is_a_tie() {
    let all = &Criterion::ALL;
    // 7.9 mm² are noise beside none: coaptation decides; 8.1 are not.
    let values = [[8.1, 8.0, 1.0, 0.1], [7.9, 8.0, 1.0, 0.1], [0.0, 4.0, 1.0, 0.1]];
    assert_eq!(ranked(&values, all), [(1, 1), (2, 2), (0, 3)]);
    // Beyond 8 mm more coaptation is no better: then the chordae decide, then the strain.
    let values = [
        [0.0, 12.0, 1.25, 0.1],
        [0.0, 8.2, 1.05, 0.1],
        [0.0, 9.0, 1.05, 0.08],
    ];
    assert_eq!(ranked(&values, all), [(2, 1), (1, 2), (0, 3)]);
    assert_eq!(ranked(&values, &[Criterion::Strain]), [(2, 1), (0, 2), (1, 2)]);
}

/// Ties share a place, stand in the order of their values, and the places behind them stay empty.
#[test]
fn ties_share_a_place() {
    let values = [
        [3.0, 7.9, 1.01, 0.105],
        [9.0, 8.0, 1.0, 0.1],
        [1.0, 7.7, 1.09, 0.109],
        [1.0, 7.7, 1.09, 0.109],
    ];
    assert_eq!(ranked(&values, &Criterion::ALL), [(2, 1), (3, 1), (0, 1), (1, 4)]);
}

#[test]
fn what_is_not_certified_is_never_ranked() {
    let like = certified();
    let uncertified = Outcome {
        status: Status::IterationLimit,
        ..outcome(&like, [0.0, 9.0, 0.5, 0.01])
    };
    let refusal = Refusal {
        repair: 0,
        faults: vec![Fault::error("ring", "too small")],
    };
    let results = [
        Err(refusal.clone()),
        Ok(uncertified.clone()),
        Ok(outcome(&like, [30.0, 0.0, 9.0, 0.5])),
        Err(refusal),
        Ok(uncertified),
    ];
    let mut rows: Vec<Row> = results
        .into_iter()
        .enumerate()
        .map(|(alternative, result)| Row {
            alternative,
            rank: None,
            result,
        })
        .collect();
    ranking::rank(&mut rows, &Criterion::ALL);
    let told: Vec<_> = rows.iter().map(|row| (row.alternative, row.rank)).collect();
    assert_eq!(told, [(2, Some(1)), (1, None), (4, None), (0, None), (3, None)]);
}

/// A row is the closure of the repaired valve from its open state, bit for bit, at any number of threads.
#[test]
fn rows_are_the_closures_at_any_number_of_threads() {
    let model = small(Preset::Dilated);
    let alternatives = [28.0, 10.0, 32.0, 30.0].map(ring);
    let settings = Settings {
        keep_positions: true,
        ..Settings::default()
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| compare(&model, &alternatives, &settings))
    };
    let one = on(1);
    assert_eq!(one, on(3));
    for row in &one.rows {
        let repaired = apply_all(&model, &alternatives[row.alternative].repairs);
        match (&row.result, repaired) {
            (Ok(outcome), Ok(applied)) => {
                let alone = relax(&applied.model, &State::open(&applied.model));
                assert_eq!(outcome.positions_mm, alone.state.positions_mm);
                assert_eq!(outcome.repairs, applied.reports);
            }
            (Err(refusal), Err(again)) => assert_eq!((refusal, row.alternative), (&again, 1)),
            _ => panic!("{row:?}"),
        }
    }
    assert_eq!(one.rows.last().map(|row| row.alternative), Some(1));
    assert!(
        compare(&model, &alternatives[..1], &Settings::default()).rows[0]
            .result
            .as_ref()
            .unwrap()
            .positions_mm
            .is_empty()
    );
}

/// Every alternative is told of once, the valve before as well; who says stop gets no certificate.
#[test]
fn a_watcher_sees_all_and_stops_all() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let model = small(Preset::Dilated);
    let alternatives = [ring(28.0), ring(10.0)];
    let done = AtomicUsize::new(0);
    let watch = |progress: &Progress| {
        match progress {
            Progress::Iterated(_) => 0,
            Progress::Closed => done.fetch_add(1, Ordering::Relaxed),
            Progress::Refused => done.fetch_add(10, Ordering::Relaxed),
        };
        ControlFlow::Break(())
    };
    let stopped = compare_watched(&model, &alternatives, &Settings::default(), &watch);
    assert_eq!(done.into_inner(), 12);
    assert_eq!(stopped.before.status, Status::Interrupted);
    assert!(stopped.rows.iter().all(|row| row.rank.is_none()));
}
