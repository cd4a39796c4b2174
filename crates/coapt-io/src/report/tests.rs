//! Reports of a small valve, and their files.

use std::path::PathBuf;

use coapt::measure::OrificeMeasures;
use coapt::mesh::parametric::{ValveParameters, generate};
use coapt::model::Model;
use coapt::relax::{Status, relax};
use coapt::repair;
use coapt::scene::Repair;
use coapt::state::State;

use super::*;
use crate::mesh::read_mesh;

fn closed(model: Model) -> Closed {
    let equilibrium = relax(&model, &State::open(&model));
    Closed {
        model,
        equilibrium,
        wall_ms: 1.0,
    }
}

/// A healthy valve of 300 faces, before and after a ring.
pub(crate) fn closure_of(ring: &str) -> Closure {
    closure_with(&[Repair::Ring(repair::parse_ring_spec(ring).unwrap())])
}

/// The same before and after any repairs.
pub(super) fn closure_with(repairs: &[Repair]) -> Closure {
    let parameters = ValveParameters {
        face_count_target: 300,
        ..ValveParameters::default()
    };
    let model = Model::build(&generate(&parameters).unwrap()).unwrap().model;
    let mut repaired = model.clone();
    let mut reports = Vec::new();
    for deed in repairs {
        let done = repair::apply(&repaired, deed).unwrap();
        repaired = done.model;
        reports.push(done.report);
    }
    Closure {
        before: closed(model),
        after: Some(closed(repaired)),
        repairs: reports,
        warnings: vec![Fault::warning("scene.toml:3", "leaflets: turned")],
        untangled: None,
        chordae_left_out: Vec::new(),
    }
}

/// Everything that can be wrong with a result.
pub(super) fn spoil(solve: &mut Solve) {
    *solve = Solve {
        certified: false,
        status: Status::IterationLimit,
        stable: false,
        crossings: 3,
        ..solve.clone()
    };
}

#[test]
fn the_json_has_every_field_of_the_contract() {
    let report = Report::new(&closure_of("saddle:30"));
    let json: serde_json::Value = serde_json::from_str(&report.json().unwrap()).unwrap();
    let contract =
        "schema case pressure_mmhg mesh/vertices mesh/faces mesh/chords repairs/0/kind warnings/0 notice";
    for pointer in contract.split(' ') {
        assert!(json.pointer(&format!("/{pointer}")).is_some(), "{pointer}");
    }
    let of_state = "solve/certified solve/status solve/residual solve/iterations solve/wall_ms solve/stable \
                    solve/crossings solve/max_penetration_mm solve/discretisation_mm annulus/ap_mm \
                    annulus/commissural_mm annulus/circumference_mm annulus/area_2d_mm2 annulus/area_3d_mm2 \
                    annulus/height_mm annulus/ahcwr coaptation/area_mm2 coaptation/length_mean_mm \
                    coaptation/length_max_mm coaptation/length_a2p2_mm coaptation/closure_line_mm orifice/area_mm2 orifice/count \
                    orifice/max_gap_mm tenting/height_mm tenting/area_mm2 tenting/volume_ml billow/height_mm \
                    billow/volume_ml leaflets/0/name leaflets/0/area_rest_mm2 leaflets/0/area_mm2 \
                    leaflets/1/strain_p95 chords/max_force_n chords/total_force_n papillary/0/name \
                    papillary/1/force_n/2 annulus_force_n/2";
    for (state, pointer) in of_state.split(' ').flat_map(|p| [("before", p), ("after", p)]) {
        assert!(
            json.pointer(&format!("/{state}/{pointer}")).is_some(),
            "{state} {pointer}"
        );
    }
    assert!((json["pressure_mmhg"].as_f64().unwrap() - 100.0).abs() < 1e-9);
    assert_eq!(json["warnings"][0], "scene.toml:3: leaflets: turned");
}

/// Rows are what the table prints, with the numbers of the report; what only the plan brings has no value before.
#[test]
fn rows_are_those_of_the_table() {
    let clip = coapt::scene::Clip {
        position: Some(0.5),
        ..coapt::scene::Clip::default()
    };
    let report = Report::new(&closure_with(&[Repair::Clip(clip)]));
    let rows = rows(&report);
    let table = text(&report);
    let printed = |row: &&TableRow| table.lines().any(|line| line.trim_start().starts_with(&row.name));
    assert_eq!(rows.iter().filter(printed).count(), rows.len());
    let named = |name: &str| rows.iter().find(|row| row.name == name).unwrap();
    let circumference = named("circumference");
    let after = report.after.as_ref().unwrap();
    assert_eq!(
        circumference.values[0],
        Some(report.before.measures.annulus.circumference_mm)
    );
    assert_eq!(
        circumference.values[1],
        Some(after.measures.annulus.circumference_mm)
    );
    let sutures: Vec<_> = rows
        .iter()
        .filter(|row| row.title == "Sutures and clips")
        .collect();
    assert!(
        !sutures.is_empty()
            && sutures
                .iter()
                .all(|row| row.values[0].is_none() && row.values[1].is_some())
    );
}

#[test]
fn without_a_plan_there_is_no_after_and_no_subfolder() {
    let closure = Closure {
        after: None,
        repairs: Vec::new(),
        ..closure_of("saddle:30")
    };
    let report = Report::new(&closure);
    assert!(!report.json().unwrap().contains("\"after\""));
    let folder = folder("plain");
    write_results(&folder, &closure, &report).unwrap();
    for file in [
        "report.json",
        "open.vtp",
        "closed.vtp",
        "open_chords.vtp",
        "chords.vtp",
    ] {
        assert!(folder.join(file).is_file(), "{file}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn the_surfaces_hold_what_is_known_at_every_point() {
    let closure = closure_of("saddle:30");
    let folder = folder("arrays");
    write_results(&folder, &closure, &Report::new(&closure)).unwrap();
    let (surface, _) = read_mesh(&folder.join("after/closed.vtp")).unwrap();
    let model = &closure.before.model;
    assert_eq!(surface.triangles, model.faces);
    assert_eq!(surface.points.len(), model.leaflet_vertex_count);
    for (name, components) in [
        ("gap_mm", 1),
        ("contact", 1),
        ("strain", 1),
        ("displacement_mm", 3),
        ("annulus", 1),
    ] {
        let array = surface.point_array(name).unwrap();
        assert_eq!(
            (array.components, array.tuple_count()),
            (components, surface.points.len()),
            "{name}"
        );
    }
    let contact = &surface.point_array("contact").unwrap().values;
    assert!(contact.contains(&0.0) && contact.contains(&1.0));
    assert!(surface.cell_array("leaflet").unwrap().values.contains(&1.0));
    let (chords, _) = read_mesh(&folder.join("after/chords.vtp")).unwrap();
    assert_eq!(chords.lines.len(), model.chords.ends.len());
    let force = &chords.cell_array("force_n").unwrap().values;
    let after = Report::new(&closure).after.unwrap();
    let largest = force.iter().fold(0.0_f64, |a, &b| a.max(b));
    // The same numbers in the file and in the report, to the last bit.
    assert_eq!(largest, after.measures.chords.max_force_n);
    assert!(chords.cell_array("group").is_some());
    assert!(folder.join("after/ring.vtp").is_file() && folder.join("before/open.vtp").is_file());
    std::fs::remove_dir_all(&folder).unwrap();
}

fn folder(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("coapt-report-{name}-{}", std::process::id()))
}

/// Both ways in which margins and passage may not fit together have their words, and what fits has none.
#[test]
fn an_orifice_in_doubt_is_told() {
    let doubt = |area_mm2: f64, passage_mm2: f64| {
        super::orifice_doubt(&OrificeMeasures {
            area_mm2,
            passage_mm2: Some(passage_mm2),
            ..OrificeMeasures::default()
        })
    };
    assert_eq!(doubt(20.6, 6.0), None);
    let missed = doubt(5.8, 14.6).unwrap();
    assert!(missed.contains("14.6 mm² can pass between the surfaces, of which the margins show 5.8"));
    let exceeds = doubt(22.4, 0.0).unwrap();
    assert!(exceeds.contains("the margins bound 22.4 mm², and 0.0 can pass"));
}
