//! What ranks and what does not, and that a comparison is what its closures are.

use super::ensemble::{Uncertainty, ensemble};
use super::*;
use crate::measure::flow::mean_diastolic_gradient_mmhg;
use crate::measure::{DiastolicOrifice, diastolic_orifice};
use crate::mesh::parametric::{Preset, ValveParameters, generate};
use crate::relax::relax;
use crate::repair::parse_ring_spec;
use crate::scene::{Clip, Neochord, Ring, Rupture, Segment};
use crate::sensitivity::{Parameter, sensitivity};

fn small(preset: Preset) -> Model {
    meshed(preset, 200)
}

fn meshed(preset: Preset, face_count_target: u32) -> Model {
    let parameters = ValveParameters {
        face_count_target,
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
    measures.coaptation.length_a2p2_mm = length;
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
        only_takes_chordae: false,
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
    let all = &Criterion::DEFAULT;
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
    assert_eq!(
        ranked(&values, &Criterion::DEFAULT),
        [(2, 1), (3, 1), (0, 1), (1, 4)]
    );
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
            only_takes_chordae: false,
            result,
        })
        .collect();
    ranking::rank(&mut rows, &Criterion::DEFAULT);
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

/// The open valve is the model at rest without pressure, by planimetry; where that has no certificate there is no figure.
#[test]
fn the_open_valve_is_the_one_without_pressure() {
    let settings = Settings {
        diastole: true,
        ..Settings::default()
    };
    let mut model = small(Preset::Dilated);
    let before = compare(&model, &[], &settings).before;
    let closed_alone = compare(&model, &[], &Settings::default()).before;
    assert_eq!(closed_alone.diastole, None);
    assert_eq!(before.measures, closed_alone.measures);
    let mut slack = model.clone();
    slack.pressure_mpa = 0.0;
    let alone = relax(&slack, &State::open(&slack));
    let diastole = before.diastole.unwrap();
    let orifice = diastolic_orifice(&model, &alone.state.positions_mm);
    let area_mm2 = orifice.area_mm2;
    assert!(diastole.is_certified() && area_mm2 > 100.0, "{diastole:?}");
    assert_eq!(diastole.orifice, Some(orifice));
    assert_eq!(
        diastole.mean_gradient_mmhg,
        mean_diastolic_gradient_mmhg(area_mm2, &Default::default())
    );
    let [sharp, rounded] = before.regurgitant_volume_ml;
    assert!(0.0 < sharp && sharp < rounded && before.measures.orifice.area_mm2 > 0.0);
    model.settings.iteration_limit = 2;
    let hasty = compare(&model, &[], &settings).before.diastole.unwrap();
    assert!(!hasty.is_certified() && hasty.orifice.is_none() && hasty.mean_gradient_mmhg.is_none());
}

/// More of it is better up to the target; an alternative whose open valve is not known stands behind, ranked all the same.
#[test]
fn the_open_valve_ranks_up_to_its_target() {
    let model = small(Preset::Healthy);
    let settings = Settings {
        diastole: true,
        ..Settings::default()
    };
    let like = compare(&model, &[], &settings).before;
    let with = |area_mm2: Option<f64>| {
        let mut outcome = like.clone();
        let diastole = outcome.diastole.as_mut().unwrap();
        let orifice = diastole.orifice.take().unwrap();
        diastole.orifice = area_mm2.map(|area_mm2| DiastolicOrifice { area_mm2, ..orifice });
        outcome
    };
    let outcomes = [
        None,
        Some(380.0),
        Some(500.0),
        Some(190.0),
        Some(99.0),
        Some(-0.0),
    ]
    .map(with);
    let row = |(alternative, outcome): (usize, Outcome)| Row {
        alternative,
        rank: None,
        only_takes_chordae: false,
        result: Ok(outcome),
    };
    let mut rows: Vec<Row> = outcomes.into_iter().enumerate().map(row).collect();
    ranking::rank(&mut rows, &Criterion::default_with(true));
    let told: Vec<_> = rows
        .iter()
        .map(|row| (row.alternative, row.rank.unwrap()))
        .collect();
    // 380 mm² are not half of 400; 190 are, and 99 half of that. What does not open stands with what is not known, whatever the sign
    // of its zero.
    assert_eq!(told, [(2, 1), (1, 1), (3, 3), (4, 4), (0, 5), (5, 5)]);
}

/// Samples begun at the closed valve are, within the noise of meshes and roads, those begun at the open one; a start of another valve
/// is left alone. On meshes of 200 faces single samples come out elsewhere by 0.65 mm of coaptation.
#[test]
fn where_samples_begin_does_not_matter() {
    let model = meshed(Preset::Dilated, 650);
    let repairs = &ring(30.0).repairs;
    let start = sampling::middle(&model, repairs, &|_| ControlFlow::Continue(())).unwrap();
    let from = |start: Option<&State>| {
        let look = |_: &Progress| ControlFlow::Continue(());
        ensemble(&model, repairs, &Uncertainty::default(), (8, 1), start, &look)
    };
    let (warm, cold) = (from(Some(&start)), from(None));
    assert_eq!((warm.certified().count(), cold.certified().count()), (8, 8));
    for (warm, cold) in warm.certified().zip(cold.certified()) {
        for criterion in Criterion::ALL {
            let [one, other] = [warm, cold].map(|it| criterion.value(it, None).unwrap_or(0.0));
            assert!(
                (one - other).abs() < criterion.noise(),
                "{criterion:?}: {one} {other}"
            );
        }
    }
    let foreign = State {
        positions_mm: vec![Vec3::zeros()],
    };
    assert_eq!(from(Some(&foreign)), cold);
}

/// Where the value is the least that there is, as 0 mm from the margin, rates are those from there on.
#[test]
fn rates_at_the_end_of_a_range_are_one_sided() {
    let model = small(Preset::Dilated);
    let at = |size_mm: f64| apply_all(&model, &ring(size_mm).repairs).map(|applied| applied.model);
    let here = at(30.0).unwrap();
    let closed = relax(&here, &State::open(&here));
    let found = |least_mm: f64, most_mm: f64| {
        let parameter = Parameter {
            model_at: &|value| match (least_mm..=most_mm).contains(&value) {
                true => at(value).map_err(|refusal| refusal.faults),
                false => Err(vec![Fault::error("ring.size_mm", "is out of range")]),
            },
            value: 30.0,
            scale: 1.0,
        };
        sensitivity(&here, &closed, &parameter)
    };
    let both = found(20.0, 40.0).unwrap().shape_rate_mm;
    let fastest = both.iter().map(Vec3::norm).fold(0.0, f64::max);
    for (least_mm, most_mm) in [(30.0, 40.0), (20.0, 30.0)] {
        let one_sided = found(least_mm, most_mm).unwrap().shape_rate_mm;
        let apart = both.iter().zip(&one_sided).map(|(a, b)| (a - b).norm());
        // Forces are differences over a millionth of the scale, in which they are straight.
        assert!(apart.fold(0.0, f64::max) < 1e-3 * fastest);
    }
    assert!(found(30.0, 30.0).is_err());
}

/// The best get an ensemble, and the valve before; the watcher is told of each sample once.
#[test]
fn the_best_alternatives_get_ensembles() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let model = small(Preset::Dilated);
    let alternatives = [ring(28.0), ring(10.0), ring(32.0), ring(30.0)];
    let comparison = compare(&model, &alternatives, &Settings::default());
    let sampling = Sampling {
        samples: 3,
        alternatives: 2,
        ..Sampling::default()
    };
    let told = AtomicUsize::new(0);
    let watch = |progress: &Progress| {
        told.fetch_add(
            usize::from(!matches!(progress, Progress::Iterated(_))),
            Ordering::Relaxed,
        );
        ControlFlow::Continue(())
    };
    let found = summaries(&model, &alternatives, &comparison, &sampling, &watch);
    assert_eq!((found.rows.len(), told.into_inner()), (2, 9));
    assert_eq!((found.before.samples, found.before.refused), (3, 0));
    let all = Sampling {
        alternatives: 9,
        ..sampling
    };
    assert_eq!(all.count(&comparison), 3, "what failed has none");
    let best = &found.rows[0];
    let (_, lengths) = best.intervals[1];
    let sealed = best.sealed.unwrap();
    assert!(best.certified > 0 && lengths.low < lengths.high && sealed.low < sealed.high);
}

/// Rates are those that the closed valve has with the same number (which `tests/it/sensitivity.rs` holds against closures on either
/// side), and none are told of a shape that is in no balance.
#[test]
fn rates_are_those_of_the_closed_valve() {
    let model = small(Preset::Dilated);
    let settings = Settings {
        keep_positions: true,
        ..Settings::default()
    };
    let repairs = ring(33.0).repairs;
    let mut rows = compare(&model, &[ring(33.0)], &settings).rows;
    let number = Number {
        key: "size_mm".into(),
        value: 33.0,
        scale: 1.0,
        repairs_at: &|size_mm| Ok(ring(size_mm).repairs),
    };
    let found = rates(&model, &repairs, &rows.remove(0).result.unwrap(), &[number]).unwrap();
    let keys: Vec<&str> = found.iter().map(|rates| rates.key.as_str()).collect();
    assert_eq!(keys, ["size_mm", CHORD_SCALE]);
    let at = |size_mm: f64| Ok(apply_all(&model, &ring(size_mm).repairs).unwrap().model);
    let here = at(33.0).unwrap();
    let parameter = Parameter {
        model_at: &at,
        value: 33.0,
        scale: 1.0,
    };
    let alone = sensitivity(&here, &relax(&here, &State::open(&here)), &parameter).unwrap();
    let length = |measures: &Measures| measures.coaptation.length_a2p2_mm;
    let [with_size, with_chords] = [0, 1].map(|at: usize| found[at].rates.clone().unwrap());
    assert_eq!(
        with_size[1],
        (Criterion::CoaptationLengthA2P2, alone.rate(length))
    );
    assert!(alone.rate(length) < 0.0, "a larger ring leaves less coaptation");
    assert!(found[1].value == 1.0 && with_chords.iter().any(|(_, rate)| *rate != 0.0));
    let mut hasty = model.clone();
    hasty.settings.iteration_limit = 2;
    let lost = compare(&hasty, &[], &settings).before;
    assert!(rates(&hasty, &[], &lost, &[]).unwrap()[0].rates.is_err());
}

/// Twelve alternatives in three groups: warm ones are certified and, within the noise of meshes and roads, what they are begun open; the
/// first of each group begins open, to the last bit.
#[test]
fn warm_alternatives_are_within_the_noise_of_those_begun_open() {
    let model = meshed(Preset::Dilated, 650);
    let neochord = |length_mm: f64| {
        Repair::Neochord(Neochord {
            position: Some(0.5),
            length_mm: Some(length_mm),
            ..Neochord::to("posterior")
        })
    };
    let with = |size_mm: f64, length_mm: f64| Alternative {
        name: format!("{size_mm} {length_mm}"),
        repairs: vec![ring(size_mm).repairs[0].clone(), neochord(length_mm)],
    };
    let alternatives: Vec<Alternative> = [28.0, 30.0, 32.0]
        .into_iter()
        .flat_map(|size_mm| [16.0, 18.0, 20.0, 22.0].map(|length_mm| with(size_mm, length_mm)))
        .collect();
    let settings = |warm| Settings {
        warm,
        diastole: true,
        ..Settings::default()
    };
    let [warm, cold] = [true, false].map(|warm| compare(&model, &alternatives, &settings(warm)));
    let by_number = |comparison: &Comparison| {
        let mut rows = comparison.rows.clone();
        rows.sort_by_key(|row| row.alternative);
        rows.into_iter()
            .map(|row| row.result.unwrap())
            .collect::<Vec<_>>()
    };
    let (warm, cold) = (by_number(&warm), by_number(&cold));
    let begun: Vec<_> = warm.iter().map(|outcome| outcome.begun_at).collect();
    let expected = [0, 4, 8]
        .map(|lead| [None, Some(lead), Some(lead), Some(lead)])
        .concat();
    assert_eq!(begun, expected);
    let opened = |outcome: &Outcome| outcome.diastole.clone().unwrap();
    let closing = |outcomes: &[Outcome]| outcomes.iter().map(|it| it.iterations).sum::<usize>();
    let opening = |outcomes: &[Outcome]| outcomes.iter().map(|it| opened(it).iterations).sum::<usize>();
    for iterations in [[closing(&warm), closing(&cold)], [opening(&warm), opening(&cold)]] {
        assert!(3 * iterations[0] < 2 * iterations[1], "{iterations:?}");
    }
    for (warm, cold) in warm.iter().zip(&cold) {
        assert!(warm.is_certified() && cold.is_certified());
        assert_eq!(warm == cold, warm.begun_at.is_none());
        for criterion in Criterion::ALL {
            let value = |it: &Outcome| criterion.value(&it.measures, it.diastole.as_ref()).unwrap();
            let [one, other] = [warm, cold].map(value);
            assert!(
                (one - other).abs() < criterion.noise(),
                "{criterion:?}: {one} {other}"
            );
        }
    }
}

/// What only tears or cuts chordae is no repair: it has no rank, and stands behind all that have one, whatever it measures.
#[test]
fn what_only_takes_chordae_is_not_ranked() {
    let model = small(Preset::Dilated);
    let rupture = || Repair::Rupture(Rupture::of(Segment::P1));
    let of = |name: &str, repairs: Vec<Repair>| Alternative {
        name: name.to_owned(),
        repairs,
    };
    let ring = ring(30.0);
    let both = of("both", [vec![rupture()], ring.repairs.clone()].concat());
    let alternatives = [of("torn", vec![rupture()]), ring, both, of("nothing", Vec::new())];
    let told = alternatives.each_ref().map(Alternative::only_takes_chordae);
    assert_eq!(told, [true, false, false, false]);
    let rows = compare(&model, &alternatives, &Settings::default()).rows;
    assert_eq!((rows[3].alternative, rows[3].rank), (0, None));
    assert!(rows[..3].iter().all(|row| row.rank.is_some()), "{rows:?}");
    assert!(rows[3].result.as_ref().is_ok_and(Outcome::is_certified));
}

/// What is wrong in itself is told of all repairs at once; what this valve's shape does not allow is not.
#[test]
fn wrong_input_is_told_from_what_does_not_fit() {
    let model = small(Preset::Dilated);
    let clip = |position: Option<f64>, angle_deg: f64| {
        Repair::Clip(Clip {
            position,
            angle_deg,
            ..Clip::default()
        })
    };
    let places = |repairs: &[Repair]| -> Vec<(usize, String)> {
        let wrong = wrong_input(&model, repairs);
        wrong
            .into_iter()
            .map(|(number, fault)| (number, fault.place))
            .collect()
    };
    let ring = ring(30.0).repairs.remove(0);
    assert_eq!(places(&[clip(Some(0.5), 0.0), ring.clone()]), []);
    // Beyond the commissure, and over another clip: with another valve, or alone, it could be done.
    assert_eq!(places(&[clip(Some(0.01), 0.0)]), []);
    assert_eq!(places(&[clip(Some(0.5), 0.0), clip(Some(0.52), 0.0)]), []);
    let wrong = [clip(None, 60.0), ring.clone(), ring, clip(Some(1.5), 0.0)];
    let told = places(&wrong);
    let named: Vec<(usize, &str)> = told
        .iter()
        .map(|(number, place)| (*number, place.as_str()))
        .collect();
    assert_eq!(
        named,
        [
            (0, "clip.angle_deg"),
            (0, "clip.site"),
            (2, "ring"),
            (3, "clip.position")
        ]
    );
}
